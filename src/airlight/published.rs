//! Air-light as *An Analytical Approach to Single Scattering for Anisotropic Media and Light
//! Distributions* has it, for comparison: (12), (13), (18) and (19) as they are printed.
//!
//! Errata: κ_i in the prefactors is κ_t. Fig. 3 assigns where it should subtract. (9) and (15) cancel
//! on one side each; here they are divided. The first equality of (20) lacks e^(κ_t (x_a − x_h)). At
//! x_b = ∞ the limits of (17) are Ei(H/w + iH) → iπ and Ei(H/w) → 0. Only Ei, the paper's (21) to (31),
//! is that of the library: it is not to blame then.

use analytic_media::airlight::AirLight;
use analytic_media::airlight::closed_form::Expansion;
use analytic_media::airlight::frame::{Frame, Point};
use analytic_media::airlight::jet::Jet;
use analytic_media::airlight::phase::PhaseFunction;
use analytic_media::geometry::Ray;
use analytic_media::special::expint::{e1, ei};

/// Which reformulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    First,
    Second,
    Combined,
}

/// A row of the table: one channel.
pub struct Paper {
    pub air: AirLight<f64>,
    pub ray: Ray<f64>,
    pub from: f64,
    pub to: f64,
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

impl Paper {
    /// L_m by `N` terms.
    pub fn radiance<const N: usize>(&self, form: Form, expansion: Expansion) -> f64 {
        let frame = Frame::new(&self.ray, &self.air.light);
        let h = frame.height;
        let optical = self.air.sigma_t[0] * h;
        let u = |t: f64| (t + frame.start) / h;
        let (ua, ub) = (u(self.from), u(self.to));
        let first = |a: f64, b: f64| self.first::<N>(&frame, optical, expansion, a, b);
        let second = |a: f64, b: f64| self.second::<N>(&frame, optical, expansion, a, b);
        let integral = match form {
            Form::First => first(ua, ub),
            Form::Second => second(ua, ub),
            Form::Combined if ub <= 0.0 => first(ua, ub),
            Form::Combined if ua >= 0.0 => second(ua, ub),
            Form::Combined => first(ua, 0.0) + second(0.0, ub),
        };
        self.air.sigma_s[0] / h * (optical * ua).exp() * 2.0 * integral
    }

    fn first<const N: usize>(
        &self,
        frame: &Frame<f64>,
        h: f64,
        expansion: Expansion,
        ua: f64,
        ub: f64,
    ) -> f64 {
        // (9); e^(−Hv) has vanished long before its end.
        let v = |u: f64| {
            let v = if u < 0.0 {
                1.0 / (u.hypot(1.0) - u)
            } else {
                u + u.hypot(1.0)
            };
            v.min(700.0 / h)
        };
        let (va, vb) = (v(ua), v(ub));
        let point = if expansion == Expansion::Fixed {
            0.5
        } else {
            0.5 * (va + vb)
        };
        let c = self.series::<N>(frame, -1.0, point);
        (0..N)
            .map(|n| c[n] * first_moment(h, va, vb, n as i32))
            .sum()
    }

    fn second<const N: usize>(
        &self,
        frame: &Frame<f64>,
        h: f64,
        expansion: Expansion,
        ua: f64,
        ub: f64,
    ) -> f64 {
        // (15); e^(H/w) has vanished long before its end.
        let w = |u: f64| {
            let w = if u < 0.0 {
                u - u.hypot(1.0)
            } else {
                -1.0 / (u + u.hypot(1.0))
            };
            if w > -h / 700.0 { 0.0 } else { w }
        };
        let (wa, wb) = (w(ua), w(ub));
        let point = if expansion == Expansion::Fixed {
            0.5
        } else {
            -0.5 * (wa + wb)
        };
        // Of the powers of −w.
        let d = self.series::<N>(frame, 1.0, point);
        let sign = |n: usize| if n % 2 == 0 { 1.0 } else { -1.0 };
        (0..N)
            .map(|n| sign(n) * d[n] * second_moment(h, wa, wb, n as i32))
            .sum()
    }

    /// Taylor coefficients of phase function times intensity, for the powers of v or −w (42).
    fn series<const N: usize>(&self, frame: &Frame<f64>, sign: f64, point: f64) -> [f64; N] {
        let lift = Jet::<f64, N>::constant;
        let (w, sign) = (Jet::variable(point), lift(sign));
        let frame = frame.map(lift);
        let at = Point::new(sign, w / frame.height, frame.height);
        let value = self.air.light.intensity.map(lift).value(&frame.toward(&at))
            * self.air.phase.map(lift).value(at.deflection());
        value.about_zero(point)
    }
}
