//! Air-light as *An Analytical Approach to Single Scattering for Anisotropic Media and Light
//! Distributions* has it, for comparison: (12), (13), (18) and (19) as they are printed. They lose all
//! digits in thick media, near the light and for short segments; nothing else uses them.
//!
//! Errata: κ_i in the prefactors is κ_t. Fig. 3 assigns where it should subtract. (9) and (15) cancel
//! on one side each; here they are divided. The first equality of (20) lacks e^(κ_t (x_a − x_h)). At
//! x_b = ∞ the limits of (17) are Ei(H/w + iH) → iπ and Ei(H/w) → 0. Only Ei, the paper's (21) to (31),
//! is that of this library: it is not to blame then. Lights are cut at their edges, and nothing is
//! expanded across them, which the paper does.

use super::AirLight;
use super::closed_form::{Expansion, jet};
use super::frame::Frame;
use super::light::Lit;
use crate::geometry::Ray;
use crate::special::expint::{e1, ei};

/// Which reformulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// By v alone (8 to 13), as in the work that the paper extends.
    First,
    /// By w alone (14 to 19).
    Second,
    /// By v before the foot of the light and w beyond it (20).
    Combined,
}

fn factorial(n: i32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// Indices of (13) and (19): from (n − 2 − j) mod 2 to n − 2 − j in steps of 2.
fn indices(j: i32, n: i32) -> impl Iterator<Item = i32> {
    let last = n - 2 - j;
    (last.rem_euclid(2)..=last).step_by(2)
}

/// (13)
fn c(a: f64, j: i32, n: i32) -> f64 {
    let term = |i: i32| {
        (-1f64).powi((n - i - j) / 2) * factorial(i + j) / factorial(j) * (-1.0 / a).powi(i + 1)
    };
    indices(j, n).map(term).sum()
}

/// (19)
fn d(a: f64, j: i32, n: i32) -> f64 {
    let term =
        |i: i32| (-1f64).powi((n - i - j) / 2) * factorial(j) / factorial(i + j + 1) * a.powi(i);
    indices(j, n).map(term).sum()
}

/// (11): i₀ and i₁.
fn i01(a: f64, v: f64) -> [f64; 2] {
    let [re, im] = ei(a * v, a);
    let (sin, cos) = a.sin_cos();
    [sin * re - cos * im, cos * re + sin * im]
}

/// ∫ e^(−Hv)/(v² + 1) vⁿ dv, the bracket of (12).
fn first_moment(h: f64, va: f64, vb: f64, n: i32) -> f64 {
    let (from, to) = (i01(-h, va), i01(-h, vb));
    let parity = (n % 2) as usize;
    let mut sum = (-1f64).powi(n / 2) * (to[parity] - from[parity]);
    for j in 0..=n - 2 {
        let end = |v: f64| (-h * v).exp() * v.powi(j);
        sum += (end(vb) - end(va)) * c(-h, j, n);
    }
    sum
}

/// ∫ e^(H/w)/(w² + 1) wⁿ dw, the bracket of (18); w = 0 is the limit from below.
fn second_moment(h: f64, wa: f64, wb: f64, n: i32) -> f64 {
    let (sin, cos) = h.sin_cos();
    let real = |w: f64| if w == 0.0 { 0.0 } else { -e1(-h / w) };
    let j01 = |w: f64| {
        let [re, im] = if w == 0.0 {
            [0.0, std::f64::consts::PI]
        } else {
            ei(h / w, h)
        };
        [-sin * re + cos * im, cos * re + sin * im - real(w)]
    };
    let parity = (n % 2) as usize;
    let mut sum = (-1f64).powi(n / 2) * (j01(wb)[parity] - j01(wa)[parity]);
    if n >= 2 {
        sum += (real(wb) - real(wa)) * h * d(h, 0, n);
    }
    for j in 0..=n - 2 {
        let end = |w: f64| {
            if w == 0.0 {
                0.0
            } else {
                (h / w).exp() * w.powi(j + 1)
            }
        };
        sum -= (end(wb) - end(wa)) * d(h, j, n);
    }
    sum
}

/// [`AirLight::radiance`] by the first `terms` ≤ `N` terms of the series.
pub fn radiance<const N: usize>(
    air: &AirLight<f64>,
    form: Form,
    expansion: Expansion,
    ray: &Ray<f64>,
    [t0, t1]: [f64; 2],
    terms: usize,
) -> Vec<f64> {
    let frame = Frame::new(ray, &air.light);
    let from = t0 + frame.start;
    let to = (t1.min(frame.far()) + frame.start).max(from);
    let Lit { first, last, kinks } = air.light.intensity.lit(&frame, from, to);
    let (begin, end) = kinks.unwrap_or((last, last));
    let parts = [[first, begin], [begin, end], [end, last]];
    let h = frame.height;
    let radiance = |(sigma_s, sigma_t): (&f64, &f64)| {
        let series = Series::<N> {
            air,
            frame: &frame,
            optical: sigma_t * h,
            expansion,
            terms,
        };
        let lit = parts.iter().filter(|[a, b]| a < b);
        let integral: f64 = lit.map(|[a, b]| series.integral(form, a / h, b / h)).sum();
        sigma_s / h * (sigma_t * from).exp() * 2.0 * integral
    };
    air.sigma_s.iter().zip(&air.sigma_t).map(radiance).collect()
}

/// What both reformulations expand.
struct Series<'a, const N: usize> {
    air: &'a AirLight<f64>,
    frame: &'a Frame<f64>,
    /// H
    optical: f64,
    expansion: Expansion,
    terms: usize,
}

impl<const N: usize> Series<'_, N> {
    /// The integral of (12), (18) or (20) between two u.
    fn integral(&self, form: Form, a: f64, b: f64) -> f64 {
        match form {
            Form::First => self.first(a, b),
            Form::Second => self.second(a, b),
            Form::Combined if b <= 0.0 => self.first(a, b),
            Form::Combined if a >= 0.0 => self.second(a, b),
            Form::Combined => self.first(a, 0.0) + self.second(0.0, b),
        }
    }

    fn first(&self, a: f64, b: f64) -> f64 {
        // (9); e^(−Hv) has vanished long before its end.
        let v = |u: f64| {
            let v = if u < 0.0 {
                1.0 / (u.hypot(1.0) - u)
            } else {
                u + u.hypot(1.0)
            };
            v.min(700.0 / self.optical)
        };
        let (a, b) = (v(a), v(b));
        let c = self.coefficients(-1.0, a, b);
        let term = |(n, c): (usize, &f64)| c * first_moment(self.optical, a, b, n as i32);
        c.iter().enumerate().take(self.terms).map(term).sum()
    }

    fn second(&self, a: f64, b: f64) -> f64 {
        // (15); e^(H/w) has vanished long before its end.
        let w = |u: f64| {
            let w = if u < 0.0 {
                u - u.hypot(1.0)
            } else {
                -1.0 / (u + u.hypot(1.0))
            };
            if w > -self.optical / 700.0 { 0.0 } else { w }
        };
        let (a, b) = (w(a), w(b));
        // Of the powers of −w.
        let d = self.coefficients(1.0, -a, -b);
        let sign = |n: usize| if n % 2 == 0 { 1.0 } else { -1.0 };
        let term =
            |(n, d): (usize, &f64)| sign(n) * d * second_moment(self.optical, a, b, n as i32);
        d.iter().enumerate().take(self.terms).map(term).sum()
    }

    /// Taylor coefficients of phase function times intensity, for the powers of v or −w (42).
    fn coefficients(&self, sign: f64, a: f64, b: f64) -> [f64; N] {
        let point = match self.expansion {
            Expansion::Fixed => 0.5,
            Expansion::Midpoint => 0.5 * (a + b),
        };
        let jet = jet(self.air, self.frame, sign, point);
        jet.first(self.terms).about_zero(point)
    }
}
