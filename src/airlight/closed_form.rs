//! Air-light in closed form: the paper's combined formulation (Eq. 20).
//!
//! On each side of the foot the phase function times the intensity becomes a polynomial of w = hq by
//! Taylor expansion, and each power is integrated exactly ([`super::moments`]). For an isotropic phase
//! function and light the polynomial is a constant, and the result exact. Else the series decides: its
//! error per term is the half-length of the piece over the distance of the nearest pole, ±i for
//! Rayleigh and lobes, ±i (1 − g)/(1 + g) for Henyey–Greenstein.

use super::AirLight;
use super::frame::{Frame, Point};
use super::jet::Jet;
use super::light::Intensity;
use super::moments;
use super::phase::{Phase, PhaseFunction};
use super::piece::Piece;
use super::segment::pieces;
use crate::geometry::Ray;
use crate::real::{Mask, Real};

/// Where phase function and intensity are expanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expansion {
    /// At w = 1/2, whatever the piece.
    Fixed,
    /// In the middle of the piece.
    Midpoint,
}

/// [`AirLight::radiance`] by `N` terms of the series. The extinction must not be 0.
pub fn radiance<R: Real, const N: usize>(
    air: &AirLight<R>,
    expansion: Expansion,
    ray: &Ray<R>,
    t0: R,
    t1: R,
) -> Vec<R> {
    let frame = Frame::new(ray, &air.light);
    let mut sums = vec![t0.lit(0.0); air.sigma_t.len()];
    pieces(
        &frame,
        &air.light.intensity,
        t0,
        t1,
        |sign, ends, length, before| {
            let sign = t0.lit(sign);
            let nothing = (t0.lit(0.0), f64::from(u16::MAX));
            let piece = Piece::new(&frame, sign, ends, length, before, nothing);
            let series = series::<R, N>(air, &frame, &piece, expansion);
            for (sum, sigma) in sums.iter_mut().zip(&air.sigma_t) {
                *sum = *sum + integral(&frame, &piece, *sigma, &series);
            }
        },
    );
    let scatter = |(sum, sigma): (R, &R)| sum * *sigma;
    sums.into_iter().zip(&air.sigma_s).map(scatter).collect()
}

/// w-length of the shortest piece that [`isotropic`] takes: the difference of two functions of order 1
/// keeps 1e-12 then.
const SHORTEST: f64 = 1e-4;

/// [`AirLight::radiance`] of an isotropic light and phase function, exact to 1e-11, if that is known to
/// cost less than quadrature: in double precision, outside a recording, in a medium with extinction,
/// and for segments that are not short.
pub(crate) fn isotropic<R: Real>(air: &AirLight<R>, ray: &Ray<R>, t0: R, t1: R) -> Option<Vec<R>> {
    let simple = matches!(air.light.intensity, Intensity::Isotropic)
        && matches!(air.phase, Phase::Isotropic)
        && t0.digits() > 24;
    if !simple {
        return None;
    }
    let zero = t0.lit(0.0);
    let frame = Frame::new(ray, &air.light);
    let thinnest = air.sigma_t.iter().copied().reduce(R::min)?;
    let mut good = zero.lit(1e-12).lt(thinnest * frame.height);
    pieces(
        &frame,
        &air.light.intensity,
        t0,
        t1,
        |sign, ends, length, before| {
            let whole = (zero, f64::from(u16::MAX));
            let piece = Piece::new(&frame, zero.lit(sign), ends, length, before, whole);
            let long = zero.lit(SHORTEST).lt(frame.height * piece.range);
            good = good & (length.le(zero) | long);
        },
    );
    (good.uniform() == Some(true)).then(|| radiance::<R, 1>(air, Expansion::Fixed, ray, t0, t1))
}

/// Both ends of a piece in w = hq.
fn ends<R: Real>(frame: &Frame<R>, piece: &Piece<R>) -> (R, R) {
    let zero = piece.sign.lit(0.0);
    let other = (piece.start - piece.sign * piece.range).max(zero);
    let (a, b) = (piece.start.min(other), piece.start.max(other));
    (frame.height * a, frame.height * b)
}

/// Coefficients of the powers of w.
fn series<R: Real, const N: usize>(
    air: &AirLight<R>,
    frame: &Frame<R>,
    piece: &Piece<R>,
    expansion: Expansion,
) -> [R; N] {
    let (a, b) = ends(frame, piece);
    let half = a.lit(0.5);
    let point = match expansion {
        Expansion::Fixed => half,
        Expansion::Midpoint => half * (a + b),
    };
    let lift = Jet::constant;
    let (w, sign) = (Jet::variable(point), lift(piece.sign));
    let frame = frame.map(lift);
    let at = Point::new(sign, w / frame.height, frame.height);
    let value = air.light.intensity.map(lift).value(&frame.toward(&at))
        * air.phase.map(lift).value(at.deflection());
    value.about_zero(point)
}

/// ∫ e^(−κ_t (path)) polynomial 2/(1 + w²) dw/h over the piece.
fn integral<R: Real, const N: usize>(
    frame: &Frame<R>,
    piece: &Piece<R>,
    sigma_t: R,
    series: &[R; N],
) -> R {
    let (a, b) = ends(frame, piece);
    let optical = sigma_t * frame.height;
    let before = piece.sign.lt(piece.sign.lit(0.0));
    let sum = |moments: [R; N]| {
        let terms = series.iter().zip(moments);
        terms.fold(a.lit(0.0), |sum, (c, m)| c.mul_add(m, sum))
    };
    let sum = crate::real::either(
        before,
        || sum(moments::before(optical, a, b)),
        || sum(moments::beyond(optical, a, b)),
    );
    a.lit(2.0) * (-sigma_t * piece.path).exp() * sum / frame.height
}
