//! Derivatives by every parameter and by the ray: dual numbers against central differences.
//!
//! They are the derivatives that a host's automatic differentiation finds in the recorded
//! formulas, because it sees the same operations.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::medium::Medium;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use analytic_media::sampling;

/// Inputs of a question: parameters, then origin, direction and the question's number.
const MAX: usize = 32;

type Number = Dual<f64, MAX>;

/// Checks the gradient of `question` at `inputs` against central differences.
fn check(
    name: &str,
    inputs: &[f64],
    dual: impl Fn(&[Number]) -> Number,
    plain: impl Fn(&[f64]) -> f64,
) {
    let variables: Vec<Number> = inputs
        .iter()
        .enumerate()
        .map(|(i, x)| Dual::variable(*x, i))
        .collect();
    let result = dual(&variables);
    let value = plain(inputs);
    assert!(
        (result.value - value).abs() <= 1e-14 * value.abs(),
        "{name}: {} and {value}",
        result.value
    );
    for i in 0..inputs.len() {
        let step = 1e-5 * inputs[i].abs().max(1.0);
        let shifted = |sign: f64| {
            let mut moved = inputs.to_vec();
            moved[i] += sign * step;
            plain(&moved)
        };
        let expected = (shifted(1.0) - shifted(-1.0)) / (2.0 * step);
        let got = result.gradient[i];
        assert!(
            (got - expected).abs() <= 1e-7 * (1.0 + expected.abs() + value.abs()),
            "{name}: derivative {i} is {got}, by differences {expected}, at {inputs:?}"
        );
    }
}

/// The same generic question for both kinds of number.
macro_rules! check {
    ($name:expr, $inputs:expr, $question:expr) => {{
        fn dual_of(f: impl Fn(&[Number]) -> Number) -> impl Fn(&[Number]) -> Number {
            f
        }
        fn plain_of(f: impl Fn(&[f64]) -> f64) -> impl Fn(&[f64]) -> f64 {
            f
        }
        check($name, $inputs, dual_of($question), plain_of($question));
    }};
}

fn ray<R: Real>(x: &[R]) -> Ray<R> {
    Ray {
        origin: [x[0], x[1], x[2]],
        direction: [x[3], x[4], x[5]],
    }
}

fn profiles() -> Vec<(Kind, Vec<f64>)> {
    vec![
        (Kind::Constant, vec![]),
        (Kind::Linear, vec![0.0, 0.6, 0.8, 0.3, 0.2, 1.5]),
        (Kind::Linear, vec![0.0, 0.0, 1.0, 0.3, -0.1, 1.5]),
        (Kind::Exponential, vec![0.0, 0.6, 0.8, 0.3, 2.0]),
        (Kind::Exponential, vec![0.0, 0.0, 1.0, -0.2, 30.0]),
    ]
}

/// Up, down, horizontal, and close to it. Directions need not be of unit length here: they are
/// inputs like the others.
const DIRECTIONS: [[f64; 3]; 5] = [
    [0.6, 0.0, 0.8],
    [0.6, 0.0, -0.8],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 1e-6],
    [0.0, 0.0, -1.0],
];

/// Calls `check` with every profile and inputs: parameters, ray, and `number`.
fn for_cases(number: f64, check: impl Fn(Kind, usize, &[f64])) {
    for (kind, values) in profiles() {
        for direction in DIRECTIONS {
            let ray = [&[0.4, -0.3, 0.7], &direction[..]].concat();
            check(kind, values.len(), &[&values[..], &ray, &[number]].concat());
        }
    }
}

#[test]
fn densities_have_derivatives() {
    for_cases(1.3, |kind, n, inputs| {
        check!("density", inputs, |x| {
            let profile = AnyProfile::from_values(kind, &x[..n]);
            profile.density(ray(&x[n..]).at(x[n + 6]))
        });
    });
}

/// `density_along` gives the derivative by t itself.
#[test]
fn the_slope_of_the_density_is_its_derivative() {
    for_cases(1.3, |kind, n, inputs| {
        let profile = AnyProfile::from_values(kind, &inputs[..n]);
        let (density, slope) = profile.density_along(&ray(&inputs[n..]), 1.3);
        let lifted: Vec<Number> = inputs.iter().map(|x| Dual::constant(*x)).collect();
        let profile = AnyProfile::from_values(kind, &lifted[..n]);
        let along = profile.density_along(&ray(&lifted[n..]), Dual::variable(1.3, 0));
        assert!((along.0.value - density).abs() <= 1e-15 * density);
        assert!((along.0.gradient[0] - slope).abs() <= 1e-14);
    });
}

#[test]
fn columns_have_derivatives() {
    for t in [0.01, 1.3, 4.0] {
        for_cases(t, |kind, n, inputs| {
            check!("column", inputs, |x| {
                let profile = AnyProfile::from_values(kind, &x[..n]);
                profile.column(&ray(&x[n..]), x[n + 6])
            });
        });
    }
}

#[test]
fn inverses_have_derivatives() {
    for column in [0.01, 0.6] {
        for_cases(column, |kind, n, inputs| {
            check!("inv_column", inputs, |x| {
                let profile = AnyProfile::from_values(kind, &x[..n]);
                profile.inv_column(&ray(&x[n..]), x[n + 6])
            });
        });
    }
}

/// The medium of the first inputs: σ and parameters of each layer.
fn two_layers<R: Real>(x: &[R]) -> Medium<R> {
    let linear = AnyProfile::from_values(Kind::Linear, &x[1..7]);
    let exponential = AnyProfile::from_values(Kind::Exponential, &x[8..13]);
    Medium::new(vec![linear, exponential], vec![x[0], x[7]])
}

const LAYERS: [f64; 13] = [
    0.4, 0.0, 0.0, 1.0, 0.3, -0.05, 1.2, // σ, then the ramp
    0.8, 0.0, 0.6, 0.8, -0.4, 3.0, // σ, then the layer
];

/// The iteration is not differentiated: its last step carries the implicit derivative.
#[test]
fn free_flight_through_a_sum_has_derivatives() {
    for direction in DIRECTIONS {
        for tau in [0.05, 0.9] {
            let inputs = [&LAYERS[..], &[0.4, -0.3, 0.7], &direction, &[tau]].concat();
            check!("free flight", &inputs, |x| {
                let t_max = x[0].lit(20.0);
                sampling::free_flight(&two_layers(x), 0, &ray(&x[13..]), t_max, x[19])
            });
        }
    }
}

#[test]
fn densities_of_flights_have_derivatives() {
    for direction in DIRECTIONS {
        let inputs = [&LAYERS[..], &[0.4, -0.3, 0.7], &direction, &[1.1]].concat();
        check!("pdf", &inputs, |x| {
            let (medium, ray) = (two_layers(x), ray(&x[13..]));
            let mut pdf = sampling::pdf(&medium, &ray, x[19]);
            pdf.next().expect("a channel")
        });
    }
}

/// A flight that never collides has no derivative, but no NaN either.
#[test]
fn infinite_answers_have_finite_derivatives() {
    let values = [0.0, 0.0, 1.0, 0.0, 2.0];
    let lifted: Vec<Number> = values
        .iter()
        .enumerate()
        .map(|(i, x)| Dual::variable(*x, i))
        .collect();
    let profile = AnyProfile::from_values(Kind::Exponential, &lifted);
    let up: Vec<Number> = [0.0, 0.0, 0.5, 0.0, 0.0, 1.0].map(Dual::constant).to_vec();
    let never = profile.inv_column(&ray(&up), Dual::constant(5.0));
    assert_eq!(never.value, f64::INFINITY);
    assert!(never.gradient.iter().all(|g| !g.is_nan()), "{never:?}");
    let whole = profile.column(&ray(&up), Dual::constant(f64::INFINITY));
    assert!(whole.gradient.iter().all(|g| g.is_finite()), "{whole:?}");
}
