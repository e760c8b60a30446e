//! Cheap stand-ins for the Chapman function and for erfcx, by the names of their authors: what the
//! article compares, and what renderers use. Errors were measured against the accurate functions
//! beside this file; `tests/functions.rs` asserts them.
//!
//! | function | source | greatest relative error |
//! |---|---|---|
//! | [`erfcx_golubev`] | article, `Exp2Erfc`, after Ooura | 1.5e-6, in f32 1.8e-6 |
//! | [`erfcx_ren_mackenzie`] | draft, Eq. 44; Ren and MacKenzie (2007) | 3.4e-3 |
//!
//! and for 0° ≤ θ ≤ 90°
//!
//! | function | source | z = 1 | 10 | 100 | 795 | 6600 |
//! |---|---|---|---|---|---|---|
//! | [`chapman_huestis`] | article, Eq. 46; Huestis (2001), two terms | 8.1e-2 | 2.5e-3 | 3.2e-5 | 1.1e-6 | 6.5e-7 |
//! | [`chapman_horizontal_huestis`] | article, Eq. 47; three terms, 90° | 3.6e-2 | 8.7e-5 | 1.0e-7 | 2.0e-10 | 3.6e-13 |
//! | [`chapman_schueler`] | article, Eq. 49; Schüler (2012) | 3.6e-2 | 6.0e-2 | 1.2e-1 | 1.4e-1 | 1.5e-1 |
//! | [`chapman_kocifaj`] | draft, Eq. 45; Kocifaj (1996) | 1.6e-1 | 1.4e-2 | 4.0e-3 | 3.4e-3 | 3.3e-3 |
//!
//! They are given for the upper hemisphere. [`chapman_huestis`] takes the lower one too, by the
//! article's Eq. 48, with (47) at the perigee: rays that pass near the centre diverge.

use crate::real::{Real, either, polynomial};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

/// exp(x²) erfc(x) for x ≥ 0: the article's fit for single precision, a polynomial in t − 1/2 with
/// t = a/(x + a). One division.
pub fn erfcx_golubev<R: Real>(x: R) -> R {
    const RANGE: f64 = 3.978_860_8;
    const FIT: [f64; 10] = [
        0.275_374_621_152_878,
        0.490_166_693_925_858,
        0.774_399_876_594_543,
        1.079_175_233_840_942,
        1.312_000_870_704_651,
        1.371_236_562_728_882,
        1.203_098_773_956_299,
        0.805_188_119_411_469,
        0.288_184_314_966_202,
        -0.010_297_533_124_685,
    ];
    let t = x.lit(RANGE) / (x + x.lit(RANGE));
    polynomial(t - x.lit(0.5), &FIT) * t
}

/// exp(x²) erfc(x) for x ≥ 0, right at 0 and ∞ (draft, Eq. 44). One division and one square root.
pub fn erfcx_ren_mackenzie<R: Real>(x: R) -> R {
    let a = x.lit(2.911);
    let scaled = x * x.lit(PI.sqrt());
    a / (a - x.lit(1.0)).mul_add(scaled, scaled.mul_add(scaled, a * a).sqrt())
}

/// C(z, θ), z > 0, by the first two terms of an expansion for large z (46), with the article's
/// erfcx; below the horizontal by (48) and (47). Two square roots and four divisions upwards.
pub fn chapman_huestis<R: Real>(z: R, cos_zenith: R) -> R {
    let (zero, one) = (z.lit(0.0), z.lit(1.0));
    let sine = (one - cos_zenith * cos_zenith).max(zero).sqrt();
    let near = huestis_upper(z, cos_zenith.abs(), sine);
    let down = cos_zenith.lt(zero);
    let through = || {
        let perigee = z * sine;
        let tangent = chapman_horizontal_huestis(R::select(down, perigee, one));
        (tangent + tangent) * (z - perigee).exp() - near
    };
    either(down, through, || near)
}

/// (46)
fn huestis_upper<R: Real>(z: R, cosine: R, sine: R) -> R {
    let lit = |x: f64| z.lit(x);
    let (root, below) = (z.sqrt(), lit(1.0) + sine);
    let inverse = lit(1.0) / below;
    let steep = below.sqrt();
    let first = cosine * inverse * (lit(1.0) - lit(0.5) * inverse);
    let leading = root * (sine - lit(0.5) + inverse);
    let correction = (below + below - lit(1.0)) * inverse / (lit(4.0) * root);
    let tail = erfcx_golubev(root * cosine / steep);
    first + lit(PI.sqrt()) / steep * tail * (leading + correction)
}

/// C(z, 90°) by the first three terms of its series for large z (47); −∞ at z = 0.
pub fn chapman_horizontal_huestis<R: Real>(z: R) -> R {
    let inverse = z.lit(1.0) / z;
    (z * z.lit(FRAC_PI_2)).sqrt() * polynomial(inverse, &[1.0, 3.0 / 8.0, -15.0 / 128.0])
}

/// C(z, θ), z > 0 and cos θ ≥ 0, by a rational function of the cosine that is right at 0° and 90°
/// (49), with (47) for the value there.
pub fn chapman_schueler<R: Real>(z: R, cos_zenith: R) -> R {
    let (one, horizontal) = (z.lit(1.0), chapman_horizontal_huestis(z));
    horizontal / (horizontal - one).mul_add(cos_zenith, one)
}

/// C(z, θ), z > 0 and cos θ ≥ 0: the draft's rational form, Kocifaj's expression for small altitudes
/// (draft, Eq. 40) with [`erfcx_ren_mackenzie`] (draft, Eq. 45, where `a z` should read `z cos θ`).
pub fn chapman_kocifaj<R: Real>(z: R, cos_zenith: R) -> R {
    let half = z.lit(0.5);
    let root = z.sqrt();
    let tail = erfcx_ren_mackenzie(root * cos_zenith * z.lit(FRAC_1_SQRT_2));
    let square = cos_zenith * cos_zenith;
    let factor =
        half * z.lit(FRAC_PI_2.sqrt()) * (z.lit(1.0) / root + root * (z.lit(2.0) - square));
    cos_zenith.mul_add(half, factor * tail)
}
