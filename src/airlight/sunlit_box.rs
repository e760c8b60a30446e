//! Fog in the sun that fills a box: of constant density, and lit from beyond its sides.
//!
//! The way that light has come from where it enters to the point s of a ray is the least of the
//! distances from three sides,
//!
//!     M(s) = min_i (a_i + b_i s),   a_i = (side_i − o_i)/sun_i,   b_i = −d_i/sun_i           (1)
//!
//! i over the axes, side_i the side towards the sun. Two of them are equal at no more than three s;
//! between these M is affine, and a part of the length l adds
//!
//!     ∫ exp(−σ_t (s + M(s))) ds = l e^(−σ_t m) φ(σ_t |Δ|),   φ(x) = (1 − e⁻ˣ)/x             (2)
//!
//! with Δ the difference of s + M(s) between its ends, and m the lesser of them. All terms are
//! positive: errors are those of the exponents. `tests/sunlit.rs` has them.

use super::sunlit::SunlitFog;
use crate::geometry::{Ray, Vector};
use crate::real::Real;
use crate::special::rel::phi;

/// Ways to the three sides (1).
struct Sides<R> {
    /// a_i, lengths.
    at: Vector<R>,
    /// b_i, 1.
    slope: Vector<R>,
}

impl<R: Real> Sides<R> {
    fn new(ray: &Ray<R>, sun: Vector<R>, [min, max]: [Vector<R>; 2]) -> Self {
        let zero = sun[0].lit(0.0);
        let (far, least) = if zero.digits() <= 24 {
            (1e15, 1e-12)
        } else {
            (1e120, 1e-100)
        };
        // Light along a side never comes from it.
        let along = |i: usize| sun[i].abs().lt(zero.lit(least));
        let divisor = |i: usize| R::select(along(i), zero.lit(1.0), sun[i]);
        let side = |i: usize| R::select(zero.lt(sun[i]), max[i], min[i]);
        let at = |i: usize| (side(i) - ray.origin[i]) / divisor(i);
        let slope = |i: usize| -ray.direction[i] / divisor(i);
        Self {
            at: std::array::from_fn(|i| R::select(along(i), zero.lit(far), at(i))),
            slope: std::array::from_fn(|i| R::select(along(i), zero, slope(i))),
        }
    }

    /// s + M(s), a length.
    fn way(&self, s: R) -> R {
        let [x, y, z]: Vector<R> = std::array::from_fn(|i| self.slope[i].mul_add(s, self.at[i]));
        s + x.min(y).min(z).max(s.lit(0.0))
    }

    /// Where two sides are equally far, within 0 to `t`, in ascending order; 0 where they never are.
    fn kinks(&self, t: R) -> Vector<R> {
        let zero = t.lit(0.0);
        let least = zero.lit(if zero.digits() <= 24 { 1e-12 } else { 1e-100 });
        let [x, y, z]: Vector<R> = std::array::from_fn(|i| {
            let j = (i + 1) % 3;
            let steeper = self.slope[i] - self.slope[j];
            let parallel = steeper.abs().lt(least);
            let s = (self.at[j] - self.at[i]) / R::select(parallel, zero.lit(1.0), steeper);
            R::select(parallel, zero, s).max(zero).min(t)
        });
        let (low, high) = (x.min(y), x.max(y));
        [low.min(z), low.max(high.min(z)), high.max(z)]
    }
}

impl<R: Real> SunlitFog<R> {
    /// [`SunlitFog::radiance`] of a constant fog that fills the box between two corners, `bounds`, and
    /// nothing else: irradiance is that of a surface outside.
    ///
    /// The segment, of the length 0 ≤ `t` < ∞, is in the box.
    pub fn radiance_in_box(
        &self,
        ray: &Ray<R>,
        t: R,
        sun: Vector<R>,
        phase: R,
        bounds: [Vector<R>; 2],
    ) -> impl Iterator<Item = R> {
        let sides = Sides::new(ray, sun, bounds);
        let [a, b, c] = sides.kinks(t);
        let ends = [t.lit(0.0), a, b, c, t];
        let ways = ends.map(|s| sides.way(s));
        let parts: [[R; 3]; 4] = std::array::from_fn(|i| {
            let (here, there) = (ways[i], ways[i + 1]);
            [ends[i + 1] - ends[i], here.min(there), (there - here).abs()]
        });
        self.sigma_s
            .iter()
            .zip(&self.sigma_t)
            .map(move |(sigma_s, sigma_t)| {
                let lit = |[length, least, more]: [R; 3]| {
                    length * (-*sigma_t * least).exp() * phi(*sigma_t * more)
                };
                let [a, b, c, d] = parts.map(lit);
                phase * *sigma_s * (a + b + c + d)
            })
    }
}
