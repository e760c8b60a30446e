//! What every profile promises, from one list of profiles.
//!
//! Tolerances are multiples of the unit roundoff times what rounded coordinates do to a
//! column: see [`Case::uncertainty`].

mod common;

use analytic_media::geometry::Ray;
use analytic_media::profile::exponential::Exponential;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use analytic_media::real::lanes::{F32Lanes, F64Lanes, Lanes};
use common::random::Random;
use glam::DVec3;

/// Profiles whose lengths are around 1; the list that every property below runs through.
fn profiles() -> Vec<(Kind, Vec<f64>)> {
    let linear = |gradient, density| vec![0.0, 0.0, 1.0, 0.25, gradient, density];
    let exponential = |scale_height| vec![0.0, 0.0, 1.0, 0.25, scale_height];
    let tilted = [0.6, 0.0, 0.8];
    let planet = |radius: f64, scale_height| vec![0.0, 0.0, 0.25 - radius, radius, scale_height];
    let ellipsoid = [1.2, 0.0, 1.6, 0.0, 0.5, 0.0, -1.6, 0.0, 1.2];
    vec![
        (Kind::Constant, vec![]),
        (Kind::Linear, linear(0.5, 1.0)),
        (Kind::Linear, linear(-0.5, 1.0)),
        (Kind::Linear, linear(1e-9, 1.0)),
        (Kind::Linear, linear(0.0, 0.5)),
        (Kind::Linear, [&tilted[..], &[0.0, -2.0, 0.5]].concat()),
        (Kind::Exponential, exponential(1.0)),
        (Kind::Exponential, exponential(0.2)),
        (Kind::Exponential, exponential(1e9)),
        (Kind::Exponential, [&tilted[..], &[0.0, 3.0]].concat()),
        (Kind::Spherical, planet(10.0, 1.0)),
        (Kind::Spherical, planet(1e4, 3.0)),
        (Kind::Spherical, planet(0.5, 2.0)),
        (Kind::Tent, [planet(10.0, 2.0), vec![1.5]].concat()),
        (Kind::Tent, [planet(1e4, 1.0), vec![8.0]].concat()),
        (Kind::Tent, [planet(0.5, -0.25), vec![3.0]].concat()),
        (Kind::Gaussian, vec![0.5, 0.25, 1.0, 1.0]),
        (Kind::Gaussian, vec![0.0, -2.0, 0.0, 5.0]),
        (Kind::Gaussian, vec![1.0, -1.0, 0.0, 1e9]),
        (
            Kind::AnisotropicGaussian,
            [&[0.5, -1.0, 0.0], &ellipsoid[..]].concat(),
        ),
        (Kind::RadialGaussian, planet(10.0, 1.0)),
        (Kind::RadialGaussian, planet(1e4, 3.0)),
    ]
}

const COSINES: [f64; 9] = [1.0, 0.3, 1e-3, 1e-9, 0.0, -1e-9, -1e-3, -0.3, -1.0];
const ALTITUDES: [f64; 6] = [0.0, 0.25, 3.0, -3.0, 20.0, -8.0];
const LENGTHS: [f64; 8] = [1e-12, 1e-6, 1e-3, 0.1, 1.0, 7.0, 50.0, 1e4];

/// A profile, seen along a ray, in the arithmetic `R`.
struct Case<R> {
    kind: Kind,
    values: Vec<f64>,
    profile: AnyProfile<R>,
    ray: Ray<R>,
    altitude: f64,
}

/// Scalars that tests can compare.
trait Scalar: Real + PartialOrd + Into<f64> {
    fn of(x: f64) -> Self;
}

impl Scalar for f64 {
    fn of(x: f64) -> Self {
        x
    }
}

impl Scalar for f32 {
    fn of(x: f64) -> Self {
        x as f32
    }
}

impl<R: Scalar> Case<R> {
    fn new(kind: Kind, values: &[f64], altitude: f64, cosine: f64) -> Self {
        let lifted: Vec<R> = values.iter().map(|v| R::of(*v)).collect();
        let direction = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
        let ray = Ray {
            origin: [0.5, -2.0, altitude].map(R::of),
            direction: direction.map(R::of),
        };
        Self {
            kind,
            values: values.to_vec(),
            profile: AnyProfile::from_values(kind, &lifted),
            ray,
            altitude,
        }
    }

    fn column(&self, t: R) -> f64 {
        self.profile.column(&self.ray, t).into()
    }

    fn roundoff(&self) -> f64 {
        self.ray.origin[0].unit_roundoff().into()
    }

    /// Columns below this are lost in subnormal numbers.
    fn least(&self) -> f64 {
        if self.roundoff() > 1e-10 {
            1e-30
        } else {
            1e-290
        }
    }

    /// |∇ ln ρ| at most, where there is anything, within `extent` of the origin.
    fn steepness(&self, extent: f64) -> f64 {
        let v = &self.values;
        let gaussian = |sigma: f64| extent.min(38.0 * sigma) / (sigma * sigma);
        match self.kind {
            Kind::Constant | Kind::Linear | Kind::Tent => 0.0,
            Kind::Exponential | Kind::Spherical => 1.0 / v[4],
            Kind::Gaussian => gaussian(v[3]),
            Kind::AnisotropicGaussian => gaussian(0.5),
            Kind::RadialGaussian => (extent + v[3]) / (v[3] * v[4]),
        }
    }

    /// What a rounding of every coordinate on a segment of length `t` can do to its `column`.
    fn uncertainty(&self, t: f64, column: f64) -> f64 {
        let extent = 4.0 + self.altitude.abs() + t;
        let relative = match self.kind {
            Kind::Constant => return self.roundoff() * column,
            Kind::Linear => {
                let [.., gradient, density] = self.values[..] else {
                    unreachable!("a linear profile has a gradient and a density")
                };
                return self.roundoff() * t * (density.abs() + gradient.abs() * extent);
            }
            Kind::Tent => {
                let [.., radius, height, width] = self.values[..] else {
                    unreachable!("a tent has a radius, a height and a width")
                };
                // The path through the layer is at most a chord.
                let path = t.min(4.0 * ((radius + height.abs()) * width).sqrt() + 4.0 * width);
                return self.roundoff() * path * (1.0 + (extent + height.abs()) / width);
            }
            _ => 1.0 + extent * self.steepness(extent),
        };
        self.roundoff() * column * relative + self.least() * t
    }

    fn describe(&self) -> String {
        format!("{:?} {:?} along {:?}", self.kind, self.values, self.ray)
    }
}

/// Calls `check` for every profile and ray.
fn for_rays<R: Scalar>(mut check: impl FnMut(&Case<R>)) {
    for (kind, values) in profiles() {
        for altitude in ALTITUDES {
            for cosine in COSINES {
                check(&Case::new(kind, &values, altitude, cosine));
            }
        }
    }
}

/// Runs a property in both scalar arithmetics.
macro_rules! properties {
    ($($(#[$doc:meta])* $name:ident => $property:ident;)*) => { $(
        $(#[$doc])*
        #[test]
        fn $name() {
            for_rays::<f64>($property);
            for_rays::<f32>($property);
        }
    )* };
}

properties! {
    /// t ↦ N(t) ↦ t, and N ↦ t(N) ↦ N.
    inv_column_undoes_column => check_inverse;
    /// The density is not negative.
    column_does_not_decrease => check_monotone;
    /// ∫₀ᵃ + ∫ₐᵇ = ∫₀ᵇ.
    columns_add_up => check_additive;
    /// A segment has one column, whichever end one looks from.
    columns_are_reversible => check_reversible;
    /// N(∞) is the limit of N(t).
    infinite_segments_are_limits => check_limit;
    /// Densities on the segment and in the box around it lie between the bounds.
    bounds_hold => check_bounds;
    /// N′ = ρ, to the order of the difference.
    density_is_the_slope_of_the_column => check_slope;
}

fn check_inverse<R: Scalar>(case: &Case<R>) {
    for length in LENGTHS {
        let t = R::of(length);
        let column = case.profile.column(&case.ray, t);
        let n: f64 = column.into();
        let slack = 16.0 * case.uncertainty(length, n);
        if n < case.least() || !n.is_finite() || slack > 0.1 * n {
            continue; // nothing, or nothing that this format can tell apart
        }
        let back: f64 = case.profile.inv_column(&case.ray, column).into();
        // Near the end of a finite total column, all distances have the same column.
        let density: f64 = case.profile.density_along(&case.ray, t).0.into();
        let close =
            (back - length).abs() * density <= slack + 4.0 * case.roundoff() * length * density;
        let saturated = density * length <= slack * 8.0;
        assert!(
            close || saturated && back >= length * 0.5,
            "inverse of {n:e} is {back:e}, not {length:e}: {}",
            case.describe()
        );
        if back.is_finite() {
            let again = case.column(R::of(back));
            assert!(
                (again - n).abs() <= 2.0 * slack,
                "column({back:e}) is {again:e}, not {n:e}: {}",
                case.describe()
            );
        }
    }
}

/// No decrease by more than rounding, the error of the quadrature where there is one, and what
/// the rounded exponent at the end that moves amounts to, where the ray leads to denser parts.
fn check_monotone<R: Scalar>(case: &Case<R>) {
    let single = case.roundoff() > 1e-10;
    let quadrature = match case.kind {
        Kind::Constant | Kind::Linear | Kind::Exponential => 0.0,
        _ => 3.0 * if single { 1.3e-7 } else { 2e-14 },
    };
    let mut last = 0.0;
    let slack = |t: f64, column: f64| {
        let exponent = (t < 1e6 && quadrature > 0.0).then(|| case.uncertainty(t, column));
        column * (4.0 * case.roundoff() + quadrature) + exponent.unwrap_or(0.0)
    };
    for i in -120..60 {
        let t = 10f64.powf(f64::from(i) / 10.0);
        let column = case.column(R::of(t));
        assert!(
            column == last || column >= last - slack(t, last),
            "column({t:e}) = {column:e} < {last:e}: {}",
            case.describe()
        );
        last = column;
    }
    let endless = case.column(R::of(f64::INFINITY));
    assert!(
        endless == last || endless >= last - slack(1e30, last),
        "{endless:e} < {last:e} in the limit: {}",
        case.describe()
    );
}

fn check_additive<R: Scalar>(case: &Case<R>) {
    for (a, b) in [(0.5, 0.25), (2.0, 6.0), (1e-3, 1.0), (10.0, 30.0)] {
        let middle = Ray {
            origin: case.ray.at(R::of(a)),
            direction: case.ray.direction,
        };
        let whole = case.column(R::of(a + b));
        let rest: f64 = case.profile.column(&middle, R::of(b)).into();
        let sum = case.column(R::of(a)) + rest;
        assert!(
            !whole.is_finite() || (sum - whole).abs() <= 16.0 * case.uncertainty(a + b, whole),
            "{a} and {b}: {sum:e}, not {whole:e}: {}",
            case.describe()
        );
    }
}

fn check_reversible<R: Scalar>(case: &Case<R>) {
    for length in [1e-3, 0.1, 1.0, 7.0, 50.0] {
        let t = R::of(length);
        let back = Ray {
            origin: case.ray.at(t),
            direction: case.ray.direction.map(|x| -x),
        };
        let (there, back) = (case.column(t), case.profile.column(&back, t).into());
        assert!(
            there == back || (there - back).abs() <= 16.0 * case.uncertainty(length, there),
            "{length}: {there:e} there, {back:e} back: {}",
            case.describe()
        );
    }
}

fn check_limit<R: Scalar>(case: &Case<R>) {
    let infinite = case.column(R::of(f64::INFINITY));
    let column = case.column(R::of(1e25));
    if infinite.is_finite() {
        let slack = 4.0 * case.roundoff() * infinite;
        assert!(
            (column - infinite).abs() <= slack,
            "{column:e}, in the limit {infinite:e}: {}",
            case.describe()
        );
    } else {
        assert!(
            column >= 1e4 * case.column(R::of(1e20)),
            "{column:e} does not grow: {}",
            case.describe()
        );
    }
}

fn check_bounds<R: Scalar>(case: &Case<R>) {
    for length in [1e-6, 0.1, 1.0, 50.0] {
        let t = R::of(length);
        let (inf, sup) = case.profile.bounds(&case.ray, t);
        let far = case.ray.at(t);
        let corner =
            |pick: fn(R, R) -> R| std::array::from_fn(|i| pick(case.ray.origin[i], far[i]));
        let (box_inf, box_sup) = case.profile.bounds_in_box(corner(R::min), corner(R::max));
        for i in 0..=64 {
            let point = case.ray.at(t * R::of(f64::from(i) / 64.0));
            let density = case.profile.density(point);
            assert!(
                inf <= density && density <= sup && box_inf <= density && density <= box_sup,
                "{density:?} is not in [{inf:?}, {sup:?}] or [{box_inf:?}, {box_sup:?}]: {}",
                case.describe()
            );
        }
    }
}

fn check_slope<R: Scalar>(case: &Case<R>) {
    let step = case.roundoff().cbrt();
    for t in [0.5, 2.0, 5.0] {
        let (low, high) = (R::of(t - step), R::of(t + step));
        let width: f64 = (high - low).into();
        let rise = case.column(high) - case.column(low);
        let density: f64 = case.profile.density(case.ray.at(R::of(t))).into();
        let along: f64 = case.profile.density_along(&case.ray, R::of(t)).0.into();
        let column = case.column(high);
        if !column.is_finite() {
            continue;
        }
        let rounding = 16.0 * case.uncertainty(t, column) / width;
        // ρ″/ρ is about the square of the steepness; ramps have kinks.
        let kink = if matches!(case.kind, Kind::Linear | Kind::Tent) {
            2.0 * width
        } else {
            0.0
        };
        let steepness = case.steepness(8.0 + case.altitude.abs());
        let order = (1.0 + steepness * steepness) * width * width * density + kink;
        for got in [density, along] {
            assert!(
                (got - rise / width).abs() <= rounding + order,
                "t = {t}: density {got:e}, slope {:e}: {}",
                rise / width,
                case.describe()
            );
        }
    }
}

/// Falloff 0, gradient 0 and a huge scale height are the uniform medium.
#[test]
fn limits_are_uniform_bit_for_bit() {
    let up = DVec3::new(0.36, 0.48, 0.8);
    let none = Exponential::with_falloff(0.0, 0.7, up).expect("a falloff of 0 is valid");
    let ramp = [0.36, 0.48, 0.8, 0.7, 0.0, 1.0];
    let mut random = Random::with_seed(5);
    for _ in 0..2000 {
        let ray = random.ray(100.0);
        let t = random.magnitude(1e-10, 1e10);
        let point = ray.at(t);
        let (lo, hi) = (ray.origin, ray.origin.map(|x| x + 1.0));
        let linear = AnyProfile::new(Kind::Linear, &ramp).expect("a gradient of 0 is valid");
        let constant = AnyProfile::<f64>::new(Kind::Constant, &[]).expect("valid");
        for p in [AnyProfile::Exponential(none), linear] {
            assert_eq!(p.density(point), constant.density(point));
            assert_eq!(p.column(&ray, t), constant.column(&ray, t), "{p:?} {ray:?}");
            assert_eq!(p.column(&ray, f64::INFINITY), f64::INFINITY);
            assert_eq!(
                p.inv_column(&ray, t),
                constant.inv_column(&ray, t),
                "{p:?} {ray:?} {t:e}"
            );
            let (inf, sup) = p.bounds(&ray, t);
            assert!(inf <= 1.0 && sup >= 1.0 && sup - inf < 1e-14);
            let (inf, sup) = p.bounds_in_box(lo, hi);
            assert!(inf <= 1.0 && sup >= 1.0 && sup - inf < 1e-14);
        }
        // A scale height that the format cannot tell from infinity.
        let huge = [0.36, 0.48, 0.8, 0.7, 1e40];
        let huge = AnyProfile::new(Kind::Exponential, &huge).expect("valid");
        assert_eq!(huge.density(point), 1.0);
        assert_eq!(huge.column(&ray, t), t);
        assert_eq!(huge.inv_column(&ray, t), t);
    }
}

/// Rays that are nearly horizontal meet the horizontal one from both sides.
#[test]
fn columns_are_continuous_through_the_horizon() {
    for (kind, values) in profiles() {
        for altitude in ALTITUDES {
            let at = |cosine| Case::<f64>::new(kind, &values, altitude, cosine);
            let (level, t) = (at(0.0), 3.0);
            let expected = level.column(t);
            for exponent in 2..17 {
                let mu = 10f64.powi(-exponent);
                for cosine in [mu, -mu] {
                    let got = at(cosine).column(t);
                    // |∂N/∂μ| ≤ max |ρ′| t²/2, and |ρ′| ≤ 5 ρ here; tilted layers turn with the ray.
                    let slope = 0.6 * 9.0 * (5.0 * expected + 2.0 * t);
                    let slack = 16.0 * level.uncertainty(t, expected);
                    assert!(
                        (got - expected).abs() <= slope * mu + slack,
                        "μ = {cosine:e}: {got:e}, level {expected:e}: {}",
                        level.describe()
                    );
                }
            }
        }
    }
}

/// Values of a random profile of any kind, with every magnitude that the format of `f32` holds.
fn wild_profile(random: &mut Random) -> (Kind, Vec<f64>, f64) {
    let kind = random.pick(Kind::ALL);
    let up = random.pick(&[[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-1.0, 0.0, 0.0]]);
    let height = random.magnitude(1e-3, 1e9);
    let base = random.sign() * random.magnitude(1e-3, 1e6);
    let values = match kind {
        Kind::Constant => vec![],
        Kind::Linear => {
            let density = random.sign() * random.magnitude(1e-6, 1e3);
            let gradient = random.sign() * density.abs() / height;
            [&up[..], &[base, random.pick(&[gradient, 0.0]), density]].concat()
        }
        Kind::Exponential => [&up[..], &[base, height]].concat(),
        Kind::Spherical | Kind::RadialGaussian => {
            let radius = random.magnitude(1e-3, 1e9);
            [&up.map(|x| -x * radius)[..], &[radius, height]].concat()
        }
        Kind::Tent => {
            let radius = random.magnitude(1e-3, 1e9);
            let width = random.magnitude(1e-3, 1e9);
            [&up.map(|x| -x * radius)[..], &[radius, base, width]].concat()
        }
        Kind::Gaussian => vec![base, 0.0, -base, height],
        Kind::AnisotropicGaussian => [&[0.0, base, 0.0][..], &random.axes(1e-3, 1e9)[..]].concat(),
    };
    (kind, values, height)
}

/// All answers to a wild question, none of which may be NaN or negative.
fn wild_answers<R: Real>(
    profile: &AnyProfile<R>,
    ray: &Ray<R>,
    t: R,
    column: R,
) -> [(&'static str, R); 8] {
    let infinity = t.lit(f64::INFINITY);
    let lo = std::array::from_fn(|i| ray.origin[i].min(ray.direction[i]));
    let hi = std::array::from_fn(|i| ray.origin[i].max(ray.direction[i]));
    [
        ("density", profile.density(ray.origin)),
        ("column", profile.column(ray, t)),
        ("column to infinity", profile.column(ray, infinity)),
        ("inv_column", profile.inv_column(ray, column)),
        ("inf", profile.bounds(ray, t).0),
        ("sup", profile.bounds(ray, t).1),
        ("inf in box", profile.bounds_in_box(lo, hi).0),
        ("sup in box", profile.bounds_in_box(lo, hi).1),
    ]
}

#[test]
fn answers_are_never_nan_or_negative() {
    let mut random = Random::with_seed(6);
    let cases = if cfg!(debug_assertions) {
        10_000
    } else {
        100_000
    };
    for _ in 0..cases {
        let (kind, values, height) = wild_profile(&mut random);
        let far = random.sign() * random.magnitude(1e-6, 1e6) * height;
        let origin = [random.between(-1e3, 1e3), 0.0, far];
        let direction = random.ray(1.0).direction;
        let t = random.pick(&[0.0, f64::INFINITY, 1.0]) * random.magnitude(1e-30, 1e30);
        let t = if t.is_nan() { 0.0 } else { t };
        let column = random.pick(&[0.0, f64::INFINITY, 1.0]) * random.magnitude(1e-30, 1e30);

        let single = |x: f64| F32Lanes::splat(x as f32);
        let double = F64Lanes::splat;
        let p32 =
            AnyProfile::from_values(kind, &values.iter().map(|v| single(*v)).collect::<Vec<_>>());
        let p64 =
            AnyProfile::from_values(kind, &values.iter().map(|v| double(*v)).collect::<Vec<_>>());
        let s64 = AnyProfile::from_values(kind, &values);
        let s32: Vec<f32> = values.iter().map(|v| *v as f32).collect();
        let s32 = AnyProfile::from_values(kind, &s32);
        let r64 = Ray { origin, direction };
        let ray32 = Ray {
            origin: origin.map(|x| x as f32),
            direction: direction.map(|x| x as f32),
        };
        let lanes32 = Ray {
            origin: origin.map(single),
            direction: direction.map(single),
        };
        let lanes64 = Ray {
            origin: origin.map(double),
            direction: direction.map(double),
        };

        let context = || format!("{kind:?} {values:?} {r64:?} t {t:e} column {column:e}");
        let check = |name: &str, form: &str, value: f64| {
            assert!(value >= 0.0, "{name} in {form} is {value}: {}", context());
        };
        for (name, value) in wild_answers(&s64, &r64, t, column) {
            check(name, "f64", value);
        }
        for (name, value) in wild_answers(&s32, &ray32, t as f32, column as f32) {
            check(name, "f32", f64::from(value));
        }
        for (name, value) in wild_answers(&p32, &lanes32, single(t), single(column)) {
            value.scatter(|_, v| check(name, "f32 lanes", f64::from(v)));
        }
        for (name, value) in wild_answers(&p64, &lanes64, double(t), double(column)) {
            value.scatter(|_, v| check(name, "f64 lanes", v));
        }
    }
}

/// From so high up that the density vanishes in the format, a descending ray still knows where
/// it meets the layer: t = (H/|μ|) (ln(|μ| N/H) + h₀/H).
#[test]
fn descents_from_above_the_format_find_the_layer() {
    let values = [0.0, 0.0, 1.0, 0.0, 2.0];
    let profile = AnyProfile::new(Kind::Exponential, &values).expect("valid");
    for altitude in [1e3, 1e4, 1e6] {
        let ray = Ray::<f64>::new(DVec3::new(0.0, 0.0, altitude), DVec3::NEG_Z);
        let t = profile.inv_column(&ray, 1.0);
        let expected = 2.0 * (0.5f64.ln() + altitude / 2.0);
        assert!((t - expected).abs() <= 4e-16 * altitude, "{t} {expected}");
        let depth = profile.column(&ray, t);
        assert!((depth - 1.0).abs() <= 4e-16 * altitude, "{depth}");
    }
}

#[test]
fn bad_parameters_are_named() {
    let up = [0.0, 0.0, 1.0];
    let exponential = |base: f64, height: f64| {
        let values = [&up[..], &[base, height]].concat();
        AnyProfile::new(Kind::Exponential, &values).map_err(|e| e.to_string())
    };
    for (height, got) in [
        (0.0, "0.0"),
        (-3.0, "-3.0"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
    ] {
        let error = exponential(0.0, height).expect_err("not a scale height");
        assert_eq!(
            error,
            format!("scale_height must be finite and > 0, got {got}")
        );
    }
    let error = exponential(f64::NAN, 1.0).expect_err("not a height");
    assert_eq!(error, "base_height must be finite, got NaN");
    let error = AnyProfile::new(Kind::Linear, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
    let error = error.expect_err("not an axis").to_string();
    assert_eq!(error, "up must be a unit vector, got [0.0, 0.0, 0.0]");
    let error = AnyProfile::new(Kind::Constant, &[1.0])
        .expect_err("no parameter")
        .to_string();
    assert!(
        error.starts_with("parameters must have as many values"),
        "{error}"
    );
}
