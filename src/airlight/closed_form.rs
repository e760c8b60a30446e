//! Air-light in closed form: the paper's combined formulation (Eq. 20).
//!
//! On each side of the foot the phase function times the intensity becomes a polynomial of w = hq by
//! Taylor expansion, and each power is integrated exactly ([`super::moments`]). For an isotropic phase
//! function and light the polynomial is a constant, and the result exact. Else the series decides: its
//! error per term is the half-length of the piece over the distance of the nearest pole, ±i for
//! Rayleigh and lobes, ±i (1 − g)/(1 + g) for Henyey–Greenstein.

use super::AirLight;
use super::estimate::{Estimate, relative};
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
    radiance_of::<R, N>(air, expansion, ray, t0, t1, N)
}

/// The same by the first `terms` of `N` terms.
pub fn radiance_of<R: Real, const N: usize>(
    air: &AirLight<R>,
    expansion: Expansion,
    ray: &Ray<R>,
    t0: R,
    t1: R,
    terms: usize,
) -> Vec<R> {
    let frame = Frame::new(ray, &air.light);
    let pieces = whole_pieces(air, &frame, t0, t1);
    by_pieces::<R, N>(air, expansion, &frame, &pieces, terms)
}

fn by_pieces<R: Real, const N: usize>(
    air: &AirLight<R>,
    expansion: Expansion,
    frame: &Frame<R>,
    pieces: &[Piece<R>],
    terms: usize,
) -> Vec<R> {
    let mut sums = vec![frame.height.lit(0.0); air.sigma_t.len()];
    for piece in pieces {
        let point = expansion.point(frame, piece);
        let jet: Jet<R, N> = jet(air, frame, piece.sign, point);
        let series = jet.first(terms).about_zero(point);
        for (sum, sigma) in sums.iter_mut().zip(&air.sigma_t) {
            *sum = *sum + Integrals::new(frame, piece, *sigma).of(&series);
        }
    }
    air.scattered(sums)
}

/// [`radiance`], and an estimate of its relative error: four times what the last two terms
/// contribute, and what rounding leaves of all terms.
pub fn estimate<R: Real, const N: usize>(
    air: &AirLight<R>,
    ray: &Ray<R>,
    t0: R,
    t1: R,
) -> Estimate<R> {
    let frame = Frame::new(ray, &air.light);
    let zero = t0.lit(0.0);
    let mut sums = vec![[zero; 2]; air.sigma_t.len()];
    for piece in whole_pieces(air, &frame, t0, t1) {
        let point = Expansion::Midpoint.point(&frame, &piece);
        let jet: Jet<R, N> = jet(air, &frame, piece.sign, point);
        let (all, but_two) = (jet.about_zero(point), jet.first(N - 2).about_zero(point));
        for ([sum, error], sigma) in sums.iter_mut().zip(&air.sigma_t) {
            let integrals = Integrals::new(&frame, &piece, *sigma);
            let value = integrals.of(&all);
            let last = (value - integrals.of(&but_two)).abs();
            let rounding = zero.lit(EXACT) * integrals.of(&all.map(R::abs)).abs();
            *sum = *sum + value;
            *error = *error + zero.lit(SAFETY) * last + rounding;
        }
    }
    let error = sums.iter().map(|[s, e]| relative(*e, *s)).collect();
    Estimate {
        radiance: air.scattered(sums.into_iter().map(|[sum, _]| sum).collect()),
        error,
        points: 0,
    }
}

/// What the series leaves over its last two terms: their ratio is below 0.9 then.
const SAFETY: f64 = 4.0;

/// Relative error where there is no series to end.
pub(crate) const EXACT: f64 = 1e-11;

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
    let thick = zero.lit(1e-12).lt(thinnest * frame.height);
    let pieces = whole_pieces(air, &frame, t0, t1);
    let good = pieces.iter().fold(thick, |good, piece| {
        let length = frame.height * piece.range;
        good & (length.le(zero) | zero.lit(SHORTEST).lt(length))
    });
    let sum = || by_pieces::<R, 1>(air, Expansion::Fixed, &frame, &pieces, 1);
    (good.uniform() == Some(true)).then(sum)
}

/// The pieces of a segment, none of them cut short.
fn whole_pieces<R: Real>(air: &AirLight<R>, frame: &Frame<R>, t0: R, t1: R) -> Vec<Piece<R>> {
    let whole = (t0.lit(0.0), f64::from(u16::MAX));
    let mut found = Vec::new();
    let intensity = &air.light.intensity;
    pieces(frame, intensity, t0, t1, |sign, ends, length, before| {
        let sign = t0.lit(sign);
        found.push(Piece::new(frame, sign, ends, length, before, whole));
    });
    found
}

/// Both ends of a piece in w = hq.
fn ends<R: Real>(frame: &Frame<R>, piece: &Piece<R>) -> (R, R) {
    let zero = piece.sign.lit(0.0);
    let other = (piece.start - piece.sign * piece.range).max(zero);
    let (a, b) = (piece.start.min(other), piece.start.max(other));
    (frame.height * a, frame.height * b)
}

impl Expansion {
    fn point<R: Real>(self, frame: &Frame<R>, piece: &Piece<R>) -> R {
        let (a, b) = ends(frame, piece);
        let half = a.lit(0.5);
        match self {
            Expansion::Fixed => half,
            Expansion::Midpoint => half * (a + b),
        }
    }
}

/// Phase function times intensity as a series of w about `point`.
pub(crate) fn jet<R: Real, const N: usize>(
    air: &AirLight<R>,
    frame: &Frame<R>,
    sign: R,
    point: R,
) -> Jet<R, N> {
    let lift = Jet::constant;
    let frame = frame.map(lift);
    let q = Jet::variable(point) / frame.height;
    let at = Point::new(lift(sign), q, frame.height);
    air.light.intensity.map(lift).value(&frame.toward(&at))
        * air.phase.map(lift).value(at.deflection())
}

/// ∫ e^(−κ_t (path)) wⁿ 2/(1 + w²) dw/h over a piece.
struct Integrals<R, const N: usize> {
    moments: [R; N],
    scale: R,
}

impl<R: Real, const N: usize> Integrals<R, N> {
    fn new(frame: &Frame<R>, piece: &Piece<R>, sigma_t: R) -> Self {
        let (a, b) = ends(frame, piece);
        let optical = sigma_t * frame.height;
        let before = piece.sign.lt(piece.sign.lit(0.0));
        let moments = match before.uniform() {
            Some(true) => moments::before(optical, a, b),
            Some(false) => moments::beyond(optical, a, b),
            None => {
                let sides: [[R; N]; 2] = [
                    moments::before(optical, a, b),
                    moments::beyond(optical, a, b),
                ];
                std::array::from_fn(|n| R::select(before, sides[0][n], sides[1][n]))
            }
        };
        let scale = a.lit(2.0) * (-sigma_t * piece.path).exp() / frame.height;
        Self { moments, scale }
    }

    /// Of the polynomial with these coefficients.
    fn of(&self, coefficients: &[R; N]) -> R {
        let terms = coefficients.iter().zip(self.moments);
        let zero = self.scale.lit(0.0);
        self.scale * terms.fold(zero, |sum, (c, m)| c.mul_add(m, sum))
    }
}
