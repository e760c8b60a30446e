//! What columns promise at the scale of planets, in kilometres and in metres, with the origin of
//! coordinates on the surface: from the ground, from the air, from space, from inside the planet
//! and from its centre, in both precisions.
//!
//! `tests/profiles.rs` has the same for lengths around 1 and for numbers of any magnitude.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::geometry::planet::Sphere;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use common::random::{Random, ray};
use std::collections::BTreeMap;

/// A profile, the length over which it changes, and the unit: 1 for kilometres.
struct World {
    kind: Kind,
    values: Vec<f64>,
    scale: f64,
    radius: f64,
    unit: f64,
}

fn worlds() -> Vec<World> {
    let mut worlds = vec![];
    for (radius, height) in [(6371.0, 8.0), (6371.0, 1.2), (3389.5, 11.1), (2575.0, 40.0)] {
        for unit in [1.0, 1000.0] {
            let planet = |shape: &[f64]| {
                let shape = shape.iter().map(|x| x * unit);
                let center = [0.0, 0.0, -radius * unit, radius * unit];
                center.into_iter().chain(shape).collect()
            };
            let mut add = |kind, values, scale: f64| {
                worlds.push(World {
                    kind,
                    values,
                    scale: scale * unit,
                    radius: radius * unit,
                    unit,
                });
            };
            add(Kind::Spherical, planet(&[height]), height);
            add(Kind::RadialGaussian, planet(&[height]), height);
            let (peak, width) = (3.0 * height, 2.0 * height);
            add(Kind::Tent, planet(&[peak, width]), width);
            let flat = |shape: &[f64]| {
                let shape = shape.iter().map(|x| x * unit);
                [0.0, 0.0, 1.0, 0.0].into_iter().chain(shape).collect()
            };
            add(Kind::Exponential, flat(&[height]), height);
            let mut ramp: Vec<f64> = flat(&[]);
            ramp.extend([-1.0 / (height * unit), 1.0]);
            add(Kind::Linear, ramp, height);
            add(Kind::Constant, vec![], f64::INFINITY);
            let cloud: Vec<f64> = [0.0, 3.0, 2.0, height].map(|x| x * unit).to_vec();
            add(Kind::Gaussian, cloud, height);
            let axes = [3.0, 0.0, 4.0, 0.0, 2.0, 0.0, -1.6, 0.0, 1.2];
            let cloud = [&[0.0, 3.0, 2.0], &axes[..]].concat();
            let cloud: Vec<f64> = cloud.iter().map(|x| x * unit).collect();
            add(Kind::AnisotropicGaussian, cloud, 2.0);
        }
    }
    worlds
}

/// A ray from anywhere; single precision holds its origin.
fn any_ray(random: &mut Random, world: &World) -> Ray<f64> {
    let (unit, radius) = (world.unit, world.radius);
    let direction = random.ray(1.0).direction;
    let near = random.magnitude(1e-3, 30.0) * unit;
    let origin = match random.index(7) {
        0 => [0.0; 3],
        1 => [0.0, 0.0, near],
        2 => [near, -near, 10.0 * unit],
        3 => [0.0, 0.0, radius * random.magnitude(1e-3, 1e3)],
        4 => [0.0, 0.0, -near],
        5 => [0.0, 0.0, -radius],
        _ => random.direction().map(|x| x * radius * random.unit()),
    };
    let exact = |x: f64| f64::from(x as f32);
    Ray {
        origin: origin.map(exact),
        direction,
    }
}

/// A case in the arithmetic `R`.
struct Case<'w, R> {
    world: &'w World,
    profile: AnyProfile<R>,
    ray: Ray<R>,
    /// Profile and ray in double precision.
    exact: (AnyProfile<f64>, Ray<f64>),
    origin: f64,
    roundoff: f64,
}

impl<R: Real + Into<f64>> Case<'_, R> {
    fn column(&self, t: f64, lift: impl Fn(f64) -> R) -> f64 {
        self.profile.column(&self.ray, lift(t)).into()
    }

    /// What rounded coordinates at the distance `t` amount to, relative to a column; the
    /// exponent of a Gaussian is a square.
    fn condition(&self, t: f64) -> f64 {
        let extent = self.origin + t.min(3.0 * (self.origin + self.world.radius));
        let relative = extent / self.world.scale;
        match self.world.kind {
            Kind::Gaussian | Kind::AnisotropicGaussian => 1.0 + relative * relative.min(38.0),
            Kind::RadialGaussian => 1.0 + relative * (1.0 + extent / self.world.radius),
            _ => 1.0 + relative,
        }
    }

    /// What altitudes rounded by an ulp of theirs amount to, relative to a column: |ln ρ| at both
    /// ends, or in a tent altitude over width over density.
    fn altitudes(&self, t: f64) -> f64 {
        let (profile, ray) = &self.exact;
        if let AnyProfile::Tent(tent) = profile {
            let altitude = tent.sphere.altitude(ray.origin).abs() + tent.height + tent.width;
            let (_, sup) = profile.bounds(ray, t);
            return altitude / tent.width / sup;
        }
        let exponent = |t: f64| {
            let point = ray.at(t.min(1e30));
            let of = |sphere: &Sphere<f64>| (sphere.altitude(point) / sphere.radius).abs();
            match profile {
                AnyProfile::Spherical(p) => of(&p.sphere) * p.sphere.radius * p.falloff,
                AnyProfile::RadialGaussian(p) => {
                    let h = of(&p.sphere);
                    h * (1.0 + 0.5 * h) * p.sphere.radius * p.falloff
                }
                _ => -profile.density(point).max(f64::MIN_POSITIVE).ln(),
            }
        };
        exponent(0.0).abs() + exponent(t).abs()
    }

    /// The largest number of the format.
    fn largest(&self) -> f64 {
        if self.single() {
            f64::from(f32::MAX)
        } else {
            f64::MAX
        }
    }

    fn least_normal(&self) -> f64 {
        if self.single() {
            f64::from(f32::MIN_POSITIVE)
        } else {
            f64::MIN_POSITIVE
        }
    }

    fn single(&self) -> bool {
        self.roundoff > 1e-10
    }

    /// Columns below this are lost in subnormal numbers.
    fn least(&self) -> f64 {
        if self.single() { 1e-30 } else { 1e-290 }
    }

    fn describe(&self, t: f64) -> String {
        let World { kind, values, .. } = self.world;
        format!("{kind:?} {values:?} t {t:e} along {:?}", self.ray)
    }
}

/// The largest error of every kind of profile, for `--nocapture`.
#[derive(Default)]
struct Worst(BTreeMap<&'static str, f64>);

impl Worst {
    fn see<R>(&mut self, case: &Case<'_, R>, error: f64) {
        let worst = self.0.entry(case.world.kind.name()).or_default();
        *worst = worst.max(error);
    }

    fn print(&self, what: &str) {
        for (kind, error) in &self.0 {
            println!("{kind}: {what} at most {error:.2e}");
        }
    }
}

fn for_cases<R: Real + Into<f64>>(
    seed: u64,
    lift: impl Fn(f64) -> R,
    mut check: impl FnMut(&Case<'_, R>, &mut Random),
) {
    let mut random = Random::with_seed(seed);
    for world in worlds() {
        for _ in 0..if cfg!(debug_assertions) { 100 } else { 1000 } {
            let double = any_ray(&mut random, &world);
            let values: Vec<R> = world.values.iter().map(|x| lift(*x)).collect();
            let case = Case {
                world: &world,
                profile: AnyProfile::from_values(world.kind, &values),
                ray: ray(&double, &lift),
                exact: (AnyProfile::from_values(world.kind, &world.values), double),
                origin: double.origin.iter().map(|x| x.abs()).sum(),
                roundoff: lift(1.0).unit_roundoff().into(),
            };
            check(&case, &mut random);
        }
    }
}

macro_rules! in_both_precisions {
    ($($(#[$doc:meta])* $name:ident => $check:ident;)*) => { $(
        $(#[$doc])*
        #[test]
        fn $name() {
            $check(|x: f64| x);
            $check(|x: f64| x as f32);
        }
    )* };
}

in_both_precisions! {
    /// Never NaN, never negative; nothing for t = 0.
    columns_are_numbers => check_numbers;
    /// No decrease with t beyond rounding.
    columns_do_not_decrease => check_monotone;
    /// ∫₀ᵃ + ∫ₐᵇ = ∫₀ᵇ.
    columns_add_up => check_additive;
    /// column(inv_column(c)) = c, and what is beyond the whole column is infinitely far.
    inverses_undo_columns => check_inverse;
    /// The density at the points of a segment is within its bounds.
    bounds_hold => check_bounds;
}

fn distance(random: &mut Random, world: &World) -> f64 {
    let t = world.scale.min(world.radius) * random.magnitude(1e-9, 1e5);
    f64::from(t as f32)
}

fn check_numbers<R: Real + Into<f64>>(lift: impl Fn(f64) -> R + Copy) {
    for_cases(1, lift, |case, random| {
        assert_eq!(case.column(0.0, lift), 0.0, "{}", case.describe(0.0));
        for t in [distance(random, case.world), 1e30, f64::INFINITY] {
            let column = case.column(t, lift);
            assert!(column >= 0.0, "{column:e}: {}", case.describe(t));
            let back: f64 = case.profile.inv_column(&case.ray, lift(t)).into();
            assert!(back >= 0.0, "{back:e}: {}", case.describe(t));
        }
        let none: f64 = case.profile.inv_column(&case.ray, lift(0.0)).into();
        assert_eq!(none, 0.0, "{}", case.describe(0.0));
    });
}

/// At most 5 ulp of decrease, and what rounded altitudes amount to around a planet; for
/// distances that are neighbours, too.
fn check_monotone<R: Real + Into<f64>>(lift: impl Fn(f64) -> R + Copy) {
    let mut worst = Worst::default();
    for_cases(2, lift, |case, random| {
        let t = distance(random, case.world);
        let neighbours = [0.0, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0].map(|n| n * 2.0 * case.roundoff);
        let far = [1e-5, 1e-4, 0.01, 0.5, 9.0, 999.0, f64::INFINITY];
        let mut last = 0.0;
        for t in neighbours.into_iter().chain(far).map(|x| t + t * x) {
            let column = case.column(t, lift);
            let altitudes = match case.world.kind {
                Kind::Spherical | Kind::RadialGaussian | Kind::Tent => 2.0 * case.altitudes(t),
                _ => 0.0,
            };
            let ulp = 2.0 * case.roundoff * last;
            let decrease = if column < last && last > case.least() {
                (last - column) / ulp
            } else {
                0.0
            };
            worst.see(case, decrease / (5.0 + altitudes));
            assert!(
                decrease <= 5.0 + altitudes,
                "{column:e} < {last:e} by {decrease} ulp: {}",
                case.describe(t)
            );
            last = column;
        }
    });
    worst.print("share of the allowed decrease");
}

fn check_additive<R: Real + Into<f64>>(lift: impl Fn(f64) -> R + Copy) {
    for_cases(3, lift, |case, random| {
        let (a, b) = (distance(random, case.world), distance(random, case.world));
        if a > 1e3 * case.world.radius {
            return; // coordinates know nothing of the planet there
        }
        let middle = Ray {
            origin: case.ray.at(lift(a)),
            direction: case.ray.direction,
        };
        let sum: f64 = lift(a + b).into();
        let rest: f64 = case.profile.column(&middle, lift(sum - a)).into();
        let (first, whole) = (case.column(a, lift), case.column(sum, lift));
        let rounded = first + rest;
        if !whole.is_finite() || whole < case.least() {
            return;
        }
        let quadrature = if case.single() { 6e-7 } else { 2e-14 };
        let relative = quadrature + 16.0 * case.roundoff * case.condition(a + b);
        // The middle is rounded, by less than the ray is long.
        let shift = 4.0 * case.roundoff * (case.origin + a + b);
        let sup: f64 = case.profile.bounds(&case.ray, lift(sum)).1.into();
        let slack = relative * whole + shift * sup.min(1e30);
        let edge = if matches!(case.world.kind, Kind::Tent | Kind::Linear) {
            case.roundoff * case.condition(a + b) * (a + b).min(case.world.radius) * 16.0
        } else {
            0.0
        };
        assert!(
            (rounded - whole).abs() <= slack + edge,
            "{first:e} + {rest:e} is not {whole:e}, slack {slack:e}: {}",
            case.describe(sum)
        );
    });
}

/// Within 4 roundings of t there is a distance with that column, to 1e-6 or 1e-12 of it and what
/// rounded altitudes amount to.
fn check_inverse<R: Real + Into<f64>>(lift: impl Fn(f64) -> R + Copy) {
    let mut worst = Worst::default();
    for_cases(4, lift, |case, random| {
        let total = case.column(f64::INFINITY, lift);
        let limit = if total.is_finite() {
            total
        } else {
            case.world.scale.min(1e3)
        };
        let column: f64 = lift(limit * random.unit()).into();
        if column < case.least() {
            return;
        }
        if total.is_finite() {
            let more = case.profile.inv_column(&case.ray, lift(total * 1.0001));
            assert!(more.into().is_infinite(), "{}", case.describe(0.0));
        }
        let start: f64 = case.profile.density(case.ray.origin).into();
        if start > 1.0 / case.least() {
            return; // distances that the format cannot hold
        }
        let (profile, ray) = (&case.profile, &case.ray);
        for t in [
            profile.inv_column(ray, lift(column)),
            profile.inv_reached_column(ray, lift(column)),
        ] {
            let t: f64 = t.into();
            let sup: f64 = profile.bounds(ray, lift(t)).1.into();
            if sup > 0.0 && sup < case.least_normal() {
                return; // densities without digits
            }
            // Where it is infinite, no distance that the format holds gathers as much.
            let t = t.min(case.largest());
            let nearby = |sign: f64| (t * (1.0 + sign * 4.0 * case.roundoff)).min(case.largest());
            let (less, more) = (
                case.column(nearby(-1.0), lift),
                case.column(nearby(1.0), lift),
            );
            let more = if t < case.largest() {
                more
            } else {
                f64::INFINITY
            };
            let error = (less - column).max(column - more).max(0.0) / column;
            let target = if case.single() { 1e-6 } else { 1e-12 };
            let allowed = target + 4.0 * case.roundoff * case.altitudes(t);
            worst.see(case, error);
            assert!(
                error <= allowed,
                "{column:e} of {total:e} is not between {less:e} and {more:e}: {}",
                case.describe(t)
            );
        }
    });
    worst.print("relative residual beyond the rounding of t");
}

fn check_bounds<R: Real + Into<f64>>(lift: impl Fn(f64) -> R + Copy) {
    for_cases(5, lift, |case, random| {
        let t = distance(random, case.world);
        let bounds = case.profile.bounds(&case.ray, lift(t));
        let (inf, sup): (f64, f64) = (bounds.0.into(), bounds.1.into());
        for i in 0..=16 {
            let point = case.ray.at(lift(t * f64::from(i) / 16.0));
            let density: f64 = case.profile.density(point).into();
            assert!(
                inf <= density && density <= sup,
                "{density:e} in [{inf:e}, {sup:e}]: {}",
                case.describe(t)
            );
        }
    });
}
