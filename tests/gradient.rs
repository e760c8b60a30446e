//! Derivatives by every parameter and by the ray, against three others: those of dual numbers in the
//! formula of the column, the integral of those of the density, and differences.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::medium::Medium;
use analytic_media::profile::gradient::Gradient;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use analytic_media::real::lanes::{F32Lanes, F64Lanes, Lanes};
use analytic_media::sampling;
use analytic_media::special::gauss_legendre;
use common::random::{Components, Random, medium};
use common::rows;

/// Parameters, origin, direction and the last argument.
const MAX: usize = 19;

type Number = Dual<f64, MAX>;

/// A question to a profile: its kind, its parameters, a ray and a distance.
#[derive(Clone, Debug)]
struct Case {
    kind: Kind,
    values: Vec<f64>,
    ray: Ray<f64>,
    t: f64,
}

impl Case {
    fn profile<R: Real>(&self, lift: impl Fn(f64) -> R) -> AnyProfile<R> {
        let values: Vec<R> = self.values.iter().map(|v| lift(*v)).collect();
        AnyProfile::from_values(self.kind, &values)
    }

    /// The same with inputs that single precision holds.
    fn rounded(&self) -> Self {
        let round = |x: f64| f64::from(x as f32);
        Self {
            kind: self.kind,
            values: self.values.iter().map(|x| round(*x)).collect(),
            ray: Ray {
                origin: self.ray.origin.map(round),
                direction: self.ray.direction.map(round),
            },
            t: round(self.t),
        }
    }

    /// All inputs in the order of a gradient.
    fn inputs(&self) -> Vec<f64> {
        [
            &self.values[..],
            &self.ray.origin,
            &self.ray.direction,
            &[self.t],
        ]
        .concat()
    }

    /// The column that is asked of inputs as of `inputs`: ∫ρ(o + s d) ds whatever the length of d.
    fn column(&self, x: &[Number]) -> Number {
        let (profile, ray, t) = self.unpack(x);
        let speed = analytic_media::geometry::norm(ray.direction);
        let unit = Ray {
            direction: ray.direction.map(|e| e / speed),
            ..ray
        };
        // An infinite distance stays what it is.
        let length = Number::select(t.is_bounded(), t * speed, t);
        profile.column(&unit, length) / speed
    }

    fn unpack<R: Real>(&self, x: &[R]) -> (AnyProfile<R>, Ray<R>, R) {
        let n = self.values.len();
        let vector = |i: usize| [x[i], x[i + 1], x[i + 2]];
        let ray = Ray {
            origin: vector(n),
            direction: vector(n + 3),
        };
        (AnyProfile::from_values(self.kind, &x[..n]), ray, x[n + 6])
    }

    fn variables(&self) -> Vec<Number> {
        let inputs = self.inputs().into_iter().enumerate();
        inputs.map(|(i, x)| Dual::variable(x, i)).collect()
    }

    /// The indices that each vector or number of the inputs has.
    fn groups(&self) -> Vec<std::ops::Range<usize>> {
        let sizes = self
            .kind
            .parameters()
            .iter()
            .map(|p| p.size)
            .chain([3, 3, 1]);
        let mut first = 0;
        sizes
            .map(|size| {
                first += size;
                first - size..first
            })
            .collect()
    }

    /// The distances between which the density is smooth, both ends included.
    fn smooth_parts(&self) -> Vec<f64> {
        let (o, d, v) = (self.ray.origin, self.ray.direction, &self.values);
        let dot = |a: [f64; 3], b: &[f64]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        let mut parts = match self.kind {
            Kind::Linear => {
                let start = v[5] + v[4] * (dot(o, &v[..3]) - v[3]);
                vec![-start / (v[4] * dot(d, &v[..3]))]
            }
            Kind::Tent => {
                let q: [f64; 3] = std::array::from_fn(|i| o[i] - v[i]);
                let (square, along) = (dot(d, &d), dot(q, &d));
                let roots = [-1.0, 0.0, 1.0].map(|edge| {
                    let radius = (v[3] + v[4] + edge * v[5]).max(0.0);
                    let rest = dot(q, &q) - radius * radius;
                    let root = (along * along - square * rest).max(0.0).sqrt();
                    [(-along - root) / square, (-along + root) / square]
                });
                roots.concat()
            }
            _ => vec![],
        };
        parts.retain(|s| 0.0 < *s && *s < self.t);
        parts.extend([0.0, self.t]);
        parts.sort_by(f64::total_cmp);
        parts
    }

    /// The derivatives of (2) by adaptive quadrature of those of the density, and the integrals of
    /// their absolute values: what rounding errors are relative to. No segment is infinite.
    fn integral(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.values.len();
        let integrand = |s: f64| {
            let mut lifted = self.variables();
            lifted[n + 6] = Dual::constant(s);
            let (profile, ray, s) = self.unpack(&lifted);
            let density = profile.density(ray.at(s));
            density.gradient[..n + 6].to_vec()
        };
        let groups = self.groups();
        let (mut sum, mut size) = (vec![0.0; n + 6], vec![0.0; n + 6]);
        for ends in self.smooth_parts().windows(2) {
            let groups = &groups[..groups.len() - 1];
            let part = adaptive(&integrand, (ends[0], ends[1]), groups);
            for i in 0..n + 6 {
                sum[i] += part.0[i];
                size[i] += part.1[i];
            }
        }
        let profile = self.profile(|x| x);
        sum.push(profile.density(self.ray.at(self.t)));
        size.push(profile.bounds(&self.ray, self.t).1);
        (sum, size)
    }
}

/// Integrals of a vector and of its absolute values, to about 1e-13 of the latter.
fn adaptive(
    f: &impl Fn(f64) -> Vec<f64>,
    (a, b): (f64, f64),
    groups: &[std::ops::Range<usize>],
) -> (Vec<f64>, Vec<f64>) {
    let n = groups.last().map_or(0, |group| group.end);
    fn panel(f: &impl Fn(f64) -> Vec<f64>, a: f64, b: f64, n: usize) -> [Vec<f64>; 2] {
        let (mut sum, mut size) = (vec![0.0; n], vec![0.0; n]);
        for (x, w) in gauss_legendre::rule(16) {
            for (i, y) in f(a + (b - a) * x).into_iter().enumerate() {
                sum[i] += w * (b - a) * y;
                size[i] += w * (b - a) * y.abs();
            }
        }
        [sum, size]
    }
    let (mut sum, mut size) = (vec![0.0; n], vec![0.0; n]);
    let [_, total] = panel(f, a, b, n);
    let mut work = vec![(a, b, panel(f, a, b, n), 0)];
    let mut panels = 0;
    while let Some((a, b, [whole, _], depth)) = work.pop() {
        let m = 0.5 * (a + b);
        let (left, right) = (panel(f, a, m, n), panel(f, m, b, n));
        // Components that should be 0 are noise of the others in their vector.
        let fine = groups.iter().all(|group| {
            let error = |i: usize| (whole[i] - left[0][i] - right[0][i]).abs();
            let scale = |i: usize| total[i] + left[1][i] + right[1][i];
            let largest = |x: &dyn Fn(usize) -> f64| group.clone().map(x).fold(0.0, f64::max);
            largest(&error) <= 1e-12 * largest(&scale)
        });
        panels += 1;
        assert!(panels < 20_000, "the quadrature converges");
        if fine && depth > 1 {
            for i in 0..n {
                sum[i] += left[0][i] + right[0][i];
                size[i] += left[1][i] + right[1][i];
            }
        } else {
            work.push((a, m, left, depth + 1));
            work.push((m, b, right, depth + 1));
        }
    }
    (sum, size)
}

/// The largest difference of two gradients, relative to the largest size in the same vector.
fn distance(case: &Case, got: &[f64], expected: &[f64], size: &[f64]) -> f64 {
    let mut worst: f64 = 0.0;
    for group in case.groups() {
        let scale = group.clone().map(|i| size[i].abs()).fold(1e-280, f64::max);
        for i in group {
            worst = worst.max((got[i] - expected[i]).abs() / scale);
        }
    }
    worst
}

fn row<R: Real>(gradient: &Gradient<R>) -> Vec<R> {
    gradient.row().collect()
}

/// Profiles and rays of all regimes, lengths around 1 or those of a planet in kilometres.
/// Whether single precision holds all of these.
fn moderate(size: &[f64]) -> bool {
    size.iter().all(|x| *x == 0.0 || (1e-25..1e25).contains(x))
}

fn random_case(random: &mut Random, kind: Kind) -> Case {
    let up = if random.unit() < 0.5 {
        [0.0, 0.0, 1.0]
    } else {
        random.direction()
    };
    let planet = matches!(kind, Kind::Spherical | Kind::Tent | Kind::RadialGaussian);
    let scale = random.magnitude(0.2, 20.0);
    let center: [f64; 3] = std::array::from_fn(|_| random.between(-3.0, 3.0));
    let radius = random.magnitude(2.0, 6e3);
    let values = match kind {
        Kind::Constant => vec![],
        Kind::Linear => {
            let gradient = random.sign() * random.magnitude(1e-3, 1.0);
            [
                up.to_vec(),
                vec![center[0], gradient, random.between(-1.0, 2.0)],
            ]
            .concat()
        }
        Kind::Exponential => [&up[..], &[center[0], scale]].concat(),
        Kind::Spherical | Kind::RadialGaussian => {
            [&up.map(|x| -x * radius)[..], &[radius, scale]].concat()
        }
        Kind::Tent => [&up.map(|x| -x * radius)[..], &[radius, center[0], scale]].concat(),
        Kind::Gaussian => [&center[..], &[scale]].concat(),
        Kind::AnisotropicGaussian => [&center[..], &random.axes(0.3, 10.0)].concat(),
    };
    let mut ray = random.ray(3.0);
    if planet && random.unit() < 0.3 {
        // From outside, past the planet or through it.
        let away = random.direction();
        let far = radius.min(50.0) * random.between(1.0, 3.0);
        let towards = random.direction();
        ray.origin = std::array::from_fn(|i| away[i] * far);
        let aim: [f64; 3] =
            std::array::from_fn(|i| towards[i] * random.between(0.0, 2.0) - ray.origin[i]);
        let length = aim.iter().map(|x| x * x).sum::<f64>().sqrt();
        ray.direction = aim.map(|x| x / length);
    }
    let t = random.magnitude(1e-3, 1e2);
    Case {
        kind,
        values,
        ray,
        t,
    }
}

fn gradient(case: &Case) -> (f64, Vec<f64>) {
    let profile = case.profile(|x| x);
    let (value, gradient) = profile.column_value_and_gradient(&case.ray, case.t);
    (value, row(&gradient))
}

/// The errors of `got` over `count` random cases of each kind, against the integrals of the
/// derivatives of densities or against dual numbers, are at most `bound`; they are printed.
fn check(
    what: &str,
    (count, bound): (usize, f64),
    expected: Expected,
    single: bool,
    got: impl Fn(&Case) -> Vec<f64>,
) {
    let mut random = Random::with_seed(61);
    for kind in Kind::ALL.iter().copied() {
        let mut errors = Vec::new();
        for _ in 0..count {
            let case = random_case(&mut random, kind);
            let case = if single { case.rounded() } else { case };
            let (integral, mut size) = case.integral();
            if single && !moderate(&size) {
                continue;
            }
            let expected = match expected {
                Expected::Integral => integral,
                Expected::Dual => {
                    // Through d/|d| they cancel in short segments.
                    let dual = case.column(&case.variables());
                    let n = case.values.len();
                    size[n + 3..n + 6].iter_mut().for_each(|x| *x += dual.value);
                    dual.gradient[..size.len()].to_vec()
                }
            };
            let got = got(&case);
            let error = distance(&case, &got, &expected, &size);
            assert!(
                error <= bound,
                "{what}: {error:.1e}\n{case:?}\ngot {got:?}\nexpected {expected:?}\nsize {size:?}"
            );
            errors.push(error);
        }
        errors.sort_by(f64::total_cmp);
        let n = errors.len();
        assert!(n >= count / 2, "{kind:?}");
        println!(
            "{what}, {}: {n} cases, median {:.1e}, worst {:.1e}",
            kind.name(),
            errors[n / 2],
            errors[n - 1]
        );
    }
}

/// What a gradient is compared with.
#[derive(Clone, Copy)]
enum Expected {
    /// The integral of the derivatives of the density.
    Integral,
    /// The derivatives of dual numbers in the formula of the column.
    Dual,
}

fn in_f64(case: &Case) -> Vec<f64> {
    let (value, gradient) = gradient(case);
    let column = case.profile(|x| x).column(&case.ray, case.t);
    assert!(
        (value - column).abs() <= 2e-13 * column.abs(),
        "{value} is not {column}: {case:?}"
    );
    gradient
}

#[test]
fn columns_have_the_derivatives_of_their_integrals() {
    check(
        "of the integral",
        (400, 1e-10),
        Expected::Integral,
        false,
        in_f64,
    );
}

#[test]
fn columns_have_the_derivatives_of_dual_numbers() {
    check(
        "of dual numbers",
        (400, 1e-10),
        Expected::Dual,
        false,
        in_f64,
    );
}

/// The same in single precision, where inputs are rounded first.
#[test]
fn columns_have_derivatives_in_single_precision() {
    let in_f32 = |case: &Case| {
        let ray = Ray {
            origin: case.ray.origin.map(|x| x as f32),
            direction: case.ray.direction.map(|x| x as f32),
        };
        let profile = case.profile(|x| x as f32);
        let (_, gradient) = profile.column_value_and_gradient(&ray, case.t as f32);
        gradient.row().map(f64::from).collect()
    };
    check("in f32", (400, 1e-3), Expected::Integral, true, in_f32);
}

/// Central differences of a function of the inputs, and how far off they may be.
fn differences(inputs: &[f64], f: impl Fn(&[f64]) -> f64) -> Vec<(f64, f64)> {
    (0..inputs.len())
        .map(|i| {
            let at = |step: f64| {
                let shifted = |sign: f64| {
                    let mut moved = inputs.to_vec();
                    moved[i] += sign * step;
                    f(&moved)
                };
                (shifted(1.0) - shifted(-1.0)) / (2.0 * step)
            };
            let step = 1e-4 * inputs[i].abs().clamp(1e-2, 1.0);
            let (coarse, fine) = (at(step), at(0.5 * step));
            // Richardson's; what the two differ by bounds the error.
            (
                (4.0 * fine - coarse) / 3.0,
                (fine - coarse).abs() + 1e-9 * f(inputs).abs() / step * 1e-3,
            )
        })
        .collect()
}

#[test]
fn inverses_have_the_derivatives_of_differences() {
    let mut random = Random::with_seed(62);
    for kind in Kind::ALL.iter().copied() {
        let (mut worst, mut compared) = (0.0f64, 0);
        for _ in 0..100 {
            let mut case = random_case(&mut random, kind);
            let profile = case.profile(|x| x);
            let total = profile.column(&case.ray, case.t);
            if !total.is_finite() || total < 1e-9 {
                continue;
            }
            // From now on `t` is the column to gather.
            case.t = total * random.between(0.1, 0.9);
            let (t, gradient) = profile.inv_column_value_and_gradient(&case.ray, case.t);
            assert_eq!(t, profile.inv_column(&case.ray, case.t));
            let n = case.values.len();
            let expected = differences(&case.inputs(), |x| {
                let (profile, ray, column) = case.unpack(x);
                let speed = analytic_media::geometry::norm(ray.direction);
                let unit = Ray {
                    direction: ray.direction.map(|e| e / speed),
                    ..ray
                };
                profile.inv_column(&unit, column * speed) / speed
            });
            for (i, (got, (expected, error))) in
                row(&gradient).into_iter().zip(expected).enumerate()
            {
                let off = (got - expected).abs() / (expected.abs() + t);
                if error / (expected.abs() + t) < 1e-6 {
                    assert!(off <= 1e-5, "{i}: {got} is not {expected}: {case:?}");
                    worst = worst.max(off);
                    compared += 1;
                }
            }
            assert_eq!(row(&gradient).len(), n + 7);
        }
        println!(
            "inverse, {}: {compared} compared, worst {worst:.1e}",
            kind.name()
        );
        assert!(compared > 300, "{kind:?}");
    }
}

/// Every kind and number format at the ends of the ranges: no NaN, and 0 for what is infinite.
#[test]
fn ends_of_ranges_have_derivatives() {
    fn check<R: Real>(lift: impl Fn(f64) -> R + Copy, lower: impl Fn(R) -> f64, name: &str) {
        let mut random = Random::with_seed(63);
        for kind in Kind::ALL.iter().copied() {
            for round in 0..200 {
                let mut case = random_case(&mut random, kind);
                case.t = random.pick(&[0.0, 1e-30, 1.0, 1e4, 1e30, f64::INFINITY]);
                let edge = [0.0, 0.0, 0.0];
                match round % 5 {
                    // From the centre, the origin, along an axis, or from its own perigee.
                    0 if case.values.len() > 3 => {
                        case.ray.origin = [case.values[0], case.values[1], case.values[2]];
                    }
                    1 => case.ray.origin = edge,
                    2 => case.ray.direction = [1.0, 0.0, 0.0],
                    3 => case.ray.direction = [0.0, 0.0, -1.0],
                    _ => {}
                }
                let ray = common::random::ray(&case.ray, lift);
                let profile = case.profile(lift);
                let (value, gradient) = profile.column_value_and_gradient(&ray, lift(case.t));
                let value = lower(value);
                for x in row(&gradient).into_iter().map(&lower) {
                    assert!(!x.is_nan(), "{name}: {gradient:?} {case:?}");
                    assert!(
                        value.is_finite() || x == 0.0,
                        "{name}: {gradient:?} {case:?}"
                    );
                }
                let (t, gradient) = profile.inv_column_value_and_gradient(&ray, lift(case.t));
                let t = lower(t);
                for x in row(&gradient).into_iter().map(&lower) {
                    assert!(!x.is_nan(), "{name}: {gradient:?} {case:?}");
                    assert!(t.is_finite() || x == 0.0, "{name}: {gradient:?} {case:?}");
                }
            }
        }
    }
    check(|x| x, |x: f64| x, "f64");
    check(|x| x as f32, |x: f32| f64::from(x), "f32");
    check(F64Lanes::splat, common::arithmetic::last, "f64 lanes");
    check(
        |x| F32Lanes::splat(x as f32),
        |x: F32Lanes| f64::from(common::arithmetic::last(x)),
        "f32 lanes",
    );
}

/// Lanes agree with scalars, so that all tests of scalars are theirs.
#[test]
fn lanes_have_the_derivatives_of_scalars() {
    let in_lanes = |case: &Case| {
        let ray = common::random::ray(&case.ray, F64Lanes::splat);
        let profile = case.profile(F64Lanes::splat);
        let (_, gradient) = profile.column_value_and_gradient(&ray, F64Lanes::splat(case.t));
        gradient.row().map(common::arithmetic::last).collect()
    };
    check("in lanes", (50, 1e-10), Expected::Integral, false, in_lanes);
}

/// Columns are homogeneous in all lengths: Σ ℓ ∂N/∂ℓ = N, by Euler, with N from the table. No two
/// rows differ in one input alone, so that differences of neighbours would need others.
#[test]
fn columns_of_the_table_are_homogeneous() {
    let (mut worst, mut rows_seen) = (0.0f64, 0);
    for entry in rows::table("columns") {
        let (kind, values) = rows::profile(&entry["profile"]);
        let t = rows::number(&entry["t"]);
        let expected = rows::number(&entry["column"]);
        if !expected.is_finite() || expected > 1e300 {
            continue;
        }
        let ray = Ray {
            origin: rows::point(&entry["origin"]),
            direction: rows::point(&entry["dir"]),
        };
        let case = Case {
            kind,
            values,
            ray,
            t,
        };
        let (_, gradient) = gradient(&case);
        let lengths = kind.parameters().iter().flat_map(|p| {
            let power = match p.name {
                "up" | "density" => 0.0,
                "gradient" => -1.0,
                _ => 1.0,
            };
            vec![power; p.size]
        });
        let powers: Vec<f64> = lengths.chain([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0]).collect();
        let terms: Vec<f64> = (0..powers.len())
            .filter(|i| powers[*i] != 0.0 && gradient[*i] != 0.0)
            .map(|i| powers[i] * case.inputs()[i] * gradient[i])
            .collect();
        let sum: f64 = terms.iter().sum();
        let size: f64 = terms.iter().map(|x| x.abs()).sum();
        let error = (sum - expected).abs() / size.max(f64::MIN_POSITIVE);
        let sens = entry["sens"].as_f64().unwrap_or(1.0).max(1.0);
        assert!(
            error <= 1e-12 * sens,
            "{error:.1e}, {sum} is not {expected}: {entry}"
        );
        worst = worst.max(error);
        rows_seen += 1;
    }
    println!("{rows_seen} rows of the table, worst {worst:.1e} of the terms");
    assert!(rows_seen > 350);
}

fn components(row: &serde_json::Value) -> Components {
    let components = row["components"].as_array().expect("components");
    let component = |c: &serde_json::Value| {
        let (kind, values) = rows::profile(&c["profile"]);
        (kind, values, rows::number(&c["mu"]))
    };
    components.iter().map(component).collect()
}

/// ∂t/∂τ = 1/σ_t(t), which the table has.
#[test]
fn flights_of_the_table_have_their_slopes() {
    let (mut worst, mut rows_seen) = (0.0f64, 0);
    for entry in rows::table("inverse") {
        let t = rows::number(&entry["t"]);
        let medium = medium(&components(&entry), |x| x);
        let ray = Ray {
            origin: rows::point(&entry["origin"]),
            direction: rows::point(&entry["dir"]),
        };
        let (t_max, tau) = (rows::number(&entry["t_max"]), rows::number(&entry["tau"]));
        let (_, gradient) = sampling::free_flight_value_and_gradient(&medium, 0, &ray, t_max, tau);
        if !t.is_finite() {
            assert!(gradient.row().all(|x| x == 0.0), "{entry}");
            continue;
        }
        let Some(sigma) = entry["mu_at_t_f64"].as_f64().filter(|x| *x > 1e-200) else {
            continue;
        };
        // What the distance is off by moves the density.
        let off = (gradient.last * sigma - 1.0).abs();
        let cond = entry["cond"].as_f64().unwrap_or(1.0).max(1.0);
        assert!(off <= 1e-9 * cond, "{off:.1e}: {entry}");
        worst = worst.max(off);
        rows_seen += 1;
    }
    println!("{rows_seen} flights of the table, worst {worst:.1e}");
    assert!(rows_seen > 200);
}

/// The inputs of a medium in the order of its gradient, and the medium of such inputs.
fn unpack_medium<R: Real>(components: &Components, x: &[R]) -> (Medium<R>, Ray<R>, R) {
    let (mut profiles, mut sigma_t, mut first) = (Vec::new(), Vec::new(), 0);
    for (kind, values, _) in components {
        sigma_t.push(x[first]);
        profiles.push(AnyProfile::from_values(
            *kind,
            &x[first + 1..][..values.len()],
        ));
        first += 1 + values.len();
    }
    let vector = |i: usize| [x[first + i], x[first + i + 1], x[first + i + 2]];
    let speed = analytic_media::geometry::norm(vector(3));
    let ray = Ray {
        origin: vector(0),
        direction: vector(3).map(|e| e / speed),
    };
    (Medium::new(profiles, sigma_t), ray, speed)
}

/// Optical depths and free flights through sums, against differences of themselves.
#[test]
fn media_have_the_derivatives_of_differences() {
    let mut random = Random::with_seed(64);
    let (mut worst, mut worst_flight, mut compared) = (0.0f64, 0.0f64, 0);
    for _ in 0..150 {
        let components = random.components();
        let ray = random.ray(3.0);
        let t = random.magnitude(0.1, 10.0);
        let plain = medium(&components, |x| x);
        let (depth, gradient) = plain
            .optical_depth_value_and_gradient(&ray, t)
            .next()
            .expect("a channel");
        if !(1e-6..1e6).contains(&depth) {
            continue;
        }
        let inputs = |last: f64| -> Vec<f64> {
            let own = components
                .iter()
                .flat_map(|(_, values, sigma)| [&[*sigma], &values[..]].concat());
            own.chain(ray.origin)
                .chain(ray.direction)
                .chain([last])
                .collect()
        };
        let expected = differences(&inputs(t), |x| {
            let (medium, ray, speed) = unpack_medium(&components, x);
            let depth = medium.optical_depth(&ray, x[x.len() - 1] * speed).next();
            depth.expect("a channel") / speed
        });
        for (got, (expected, error)) in gradient.row().zip(expected) {
            if error < 1e-6 * (expected.abs() + depth) {
                let off = (got - expected).abs() / (expected.abs() + depth);
                assert!(
                    off <= 1e-5,
                    "{got} is not {expected}: {components:?} {ray:?} {t}"
                );
                worst = worst.max(off);
            }
        }

        let tau = 0.5 * depth;
        let (flight, gradient) =
            sampling::free_flight_value_and_gradient(&plain, 0, &ray, f64::INFINITY, tau);
        assert!(flight <= t);
        let expected = differences(&inputs(tau), |x| {
            let (medium, ray, speed) = unpack_medium(&components, x);
            let tau = x[x.len() - 1] * speed;
            sampling::free_flight(&medium, 0, &ray, f64::INFINITY, tau) / speed
        });
        for (got, (expected, error)) in gradient.row().zip(expected) {
            if error < 1e-6 * (expected.abs() + flight) {
                let off = (got - expected).abs() / (expected.abs() + flight);
                assert!(
                    off <= 1e-5,
                    "{got} is not {expected}: {components:?} {ray:?} {tau}"
                );
                worst_flight = worst_flight.max(off);
                compared += 1;
            }
        }
    }
    println!("optical depths {worst:.1e}, flights {worst_flight:.1e}, {compared} compared");
    assert!(compared > 800);
}
