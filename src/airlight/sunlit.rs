//! Fog in the sun: single scattering of directional light along a ray, in closed form.
//!
//!     L = σ_s Φ E ∫₀ᵗ ρ(s) exp(−σ_t (N(s) + M(s))) ds                              (1)
//!
//! ρ is the relative density of the fog, N(s) the column from the eye to s, and M(s) that from
//! there towards the sun. E is the irradiance of a surface perpendicular to the light, Φ the
//! phase function, which is the same along the ray. In layers of any kind light gains column as
//! the ray does, with the cosines μ of the ray and μ_☉ of the sun (s → N(s) maps (1) to an
//! integral of an exponential):
//!
//!     M(s) − M(0) = −(μ/μ_☉) N(s)                                                  (2)
//!     L = σ_s Φ E e^(−σ_t m) N φ(|κ| σ_t N),   κ = 1 − μ/μ_☉,  φ(x) = (1 − e⁻ˣ)/x   (3)
//!     m = M(0) where κ ≥ 0, else N + M(t)                                          (4)
//!
//! N and M without an argument are those of the whole segment. (4) is the end from which more
//! light comes, so (3) neither overflows nor cancels. φ is smooth at 0: rays towards the sun,
//! along which nothing is lost (κ = 0), and short ones are no special case, and horizontal
//! ones are none of N.
//!
//! | fog         | M(s)                                     | κ                                |
//! |-------------|------------------------------------------|----------------------------------|
//! | exponential | ρ(s) H/μ_☉; ∞ unless the sun is up       | 1 − μ/μ_☉                        |
//! | constant    | −s cos θ, θ the angle from ray to sun    | 1 − cos θ = (direction − sun)²/2 |
//!
//! Light comes through an exponential fog from beyond it, where its irradiance is E. A constant
//! fog has no end to come from: there E is the irradiance *at the eye*, and surfaces of equal
//! irradiance are perpendicular to the light. One that fills a box has: [`super::sunlit_box`].
//!
//! Relative error below 1e-15 (1 + σ_t m + |h|/H) in f64, 5e-7 (1 + σ_t m + |h|/H) in f32: what
//! rounding does to the exponents. `tests/sunlit.rs` asserts it.
//! Source: (1) for layers of constant and exponential density Hoffman and Preetham (2002),
//! *Rendering Outdoor Light Scattering in Real Time*, and Riley et al. (2004), *Efficient
//! Rendering of Atmospheric Phenomena*; (2) to (4) are derived here.

use crate::error::Error;
use crate::geometry::{Ray, Vector, dot};
use crate::medium::attenuate;
use crate::profile::exponential::Exponential;
use crate::profile::{AnyProfile, Kind, Profile};
use crate::real::Real;
use crate::special::rel::phi;

/// A fog that scatters light, in one or more channels.
#[derive(Clone, Debug)]
pub struct SunlitFog<R> {
    profile: AnyProfile<R>,
    /// σ_s per channel, 1/length, ≥ 0.
    pub(super) sigma_s: Vec<R>,
    /// σ_t per channel, 1/length, ≥ 0.
    pub(super) sigma_t: Vec<R>,
}

/// Columns of a segment and the light on it: all that the channels share.
struct Path<R> {
    /// N, length.
    column: R,
    /// |κ|, 1.
    rate: R,
    /// m (4), length.
    clearest: R,
}

/// Whether a profile of this kind has (3).
///
/// # Errors
/// If it is neither constant nor exponential.
pub fn check_kind(kind: Kind) -> Result<(), Error> {
    match kind {
        Kind::Constant | Kind::Exponential => Ok(()),
        _ => Err(Error::new(
            "profile",
            "must be constant or exponential",
            kind.name(),
        )),
    }
}

impl<R: Real> SunlitFog<R> {
    /// The fog with these coefficients at relative density 1, one of each per channel.
    ///
    /// # Panics
    /// If there is no channel, not the same number of both, or a profile that [`check_kind`]
    /// refuses.
    #[must_use]
    pub fn new(profile: AnyProfile<R>, sigma_s: Vec<R>, sigma_t: Vec<R>) -> Self {
        assert!(
            matches!(
                profile,
                AnyProfile::Constant(_) | AnyProfile::Exponential(_)
            ),
            "the profile is constant or exponential"
        );
        assert!(
            !sigma_t.is_empty() && sigma_s.len() == sigma_t.len(),
            "every channel has both coefficients"
        );
        Self {
            profile,
            sigma_s,
            sigma_t,
        }
    }

    /// L (3) per unit of irradiance in every channel, 1/sr.
    ///
    /// The eye is the ray's origin; `t` is a length ≥ 0 and may be infinite, and so may L.
    /// `sun` is the direction towards the sun, a unit vector; `phase` the value of the phase
    /// function at the angle between `ray` and `sun`, 1/sr.
    pub fn radiance(
        &self,
        ray: &Ray<R>,
        t: R,
        sun: Vector<R>,
        phase: R,
    ) -> impl Iterator<Item = R> {
        let path = match &self.profile {
            AnyProfile::Exponential(layers) => Path::in_layers(layers, ray, t, sun),
            _ => Path::in_constant(ray, t, sun),
        };
        self.sigma_s
            .iter()
            .zip(&self.sigma_t)
            .map(move |(sigma_s, sigma_t)| phase * attenuate(*sigma_s, path.lit(*sigma_t)))
    }
}

impl<R: Real> Path<R> {
    fn in_constant(ray: &Ray<R>, t: R, sun: Vector<R>) -> Self {
        let half = t.lit(0.5);
        // Unlike 1 − cos θ, it knows small angles. What rounding did to the lengths of the
        // directions lies along their mean, and is no part of κ.
        let chord: Vector<R> = std::array::from_fn(|i| ray.direction[i] - sun[i]);
        let mean: Vector<R> = std::array::from_fn(|i| (ray.direction[i] + sun[i]) * half);
        let along = dot(chord, mean);
        let rate = (dot(chord, chord) - along * along).max(t.lit(0.0)) * half;
        Self {
            column: t,
            rate,
            clearest: t.lit(0.0),
        }
    }

    fn in_layers(layers: &Exponential<R>, ray: &Ray<R>, t: R, sun: Vector<R>) -> Self {
        let (zero, one, infinity) = (t.lit(0.0), t.lit(1.0), t.lit(f64::INFINITY));
        let plane = &layers.plane;
        let cos_sun = plane.cos_zenith(sun);
        // Lower than that, κ could overflow; the fog then is as deep as below the horizon.
        let least = t.lit(if t.digits() <= 24 { 1e-18 } else { 1e-150 });
        let up = least.lt(cos_sun) & zero.lt(layers.falloff);
        let cos_sun = R::select(up, cos_sun, one);
        let slope = R::select(up, layers.falloff, one) * cos_sun;
        let light = |altitude: R| R::select(up, layers.at(altitude) / slope, infinity);

        let column = layers.column(ray, t);
        // The difference of directions first: it is exact where they nearly agree.
        let chord: Vector<R> = std::array::from_fn(|i| sun[i] - ray.direction[i]);
        let kappa = R::select(up, dot(plane.up, chord) / cos_sun, one);
        let steep = kappa.lt(zero);
        let (start, end) = plane.ends(ray, t);
        Self {
            column,
            rate: R::select(steep, -kappa, kappa),
            clearest: R::select(steep, column, zero) + light(R::select(steep, end, start)),
        }
    }

    /// ∫₀ᵗ ρ exp(−σ_t (N(s) + M(s))) ds, a length.
    fn lit(&self, sigma_t: R) -> R {
        let zero = sigma_t.lit(0.0);
        let bounded = self.clearest.is_bounded();
        let dark = !bounded & zero.lt(sigma_t);
        let depth = sigma_t * R::select(bounded, self.clearest, zero);
        let lit = (-depth).exp() * decayed(self.rate * sigma_t, self.column);
        R::select(dark, zero, lit)
    }
}

/// ∫₀ᴺ e^(−k n) dn = N φ(k N), for 0 ≤ k < ∞, 0 ≤ N ≤ ∞.
fn decayed<R: Real>(k: R, column: R) -> R {
    let (zero, one, infinity) = (k.lit(0.0), k.lit(1.0), k.lit(f64::INFINITY));
    // e^−100 is nothing beside 1.
    let thick = k.lit(100.0).lt(attenuate(k, column));
    let thin = !thick & column.is_bounded();
    let short = R::select(thin, column, zero);
    let near = short * phi(k * short);
    let far = one / R::select(thick, k, one);
    R::select(thick, far, R::select(thin, near, infinity))
}
