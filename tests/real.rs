//! One arithmetic, many executions: `f64`, `f32`, lanes, duals and recorded nodes agree,
//! operation by operation, at the ends of the range too.

mod common;

use analytic_media::real::dual::Dual;
use analytic_media::real::lanes::{F32Lanes, F64Lanes, Lanes};
use analytic_media::real::{Mask, Real};
use common::host::Host;
use common::random::Random;

/// Numbers of every magnitude, and the special ones.
fn numbers(single: bool) -> Vec<f64> {
    let (low, high) = if single {
        (-44.0, 38.0)
    } else {
        (-323.0, 308.0)
    };
    let mut random = Random::with_seed(3);
    let mut numbers: Vec<f64> = (0..4000)
        .map(|_| random.sign() * 10f64.powf(random.between(low, high)))
        .collect();
    numbers.extend((0..4000).map(|_| random.between(-120.0, 120.0)));
    numbers.extend((0..2000).map(|_| random.between(0.5, 1.5)));
    let special = [
        0.0,
        1.0,
        2.0,
        0.5,
        f64::INFINITY,
        f64::from(f32::MIN_POSITIVE),
    ];
    numbers.extend(special.iter().flat_map(|x| [*x, -x]));
    numbers.extend([-745.2, -708.5, -700.1, -699.9, 699.9, 700.1, 709.7, 709.9]);
    numbers.extend([-104.1, -87.4, -80.1, -79.9, 79.9, 80.1, 88.7, 88.8]);
    numbers.extend([f64::MIN_POSITIVE, 5e-324, 1e-310, 1e-40, 1e-45]);
    if single {
        numbers.iter().map(|x| f64::from(*x as f32)).collect()
    } else {
        numbers
    }
}

/// Results by the name of their operation.
type Named<R> = Vec<(&'static str, R)>;

/// Every operation of one argument; masks come out as 1 and 0.
fn unary<R: Real>(x: R) -> Named<R> {
    let truth = |mask| R::select(mask, x.lit(1.0), x.lit(0.0));
    let positive = x.lit(0.0).lt(x);
    vec![
        ("neg", -x),
        ("abs", x.abs()),
        ("sqrt", x.abs().sqrt()),
        ("exp", x.exp()),
        ("ln", x.abs().ln()),
        ("detach", x.detach()),
        ("bounded", truth(x.is_bounded())),
        ("not", truth(!positive)),
    ]
}

/// Every operation of two and three arguments.
fn binary<R: Real>(x: R, y: R) -> Named<R> {
    let truth = |mask| R::select(mask, x.lit(1.0), x.lit(0.0));
    vec![
        ("add", x + y),
        ("sub", x - y),
        ("mul", x * y),
        ("div", x / y),
        ("min", x.min(y)),
        ("max", x.max(y)),
        ("lt", truth(x.lt(y))),
        ("le", truth(x.le(y))),
        ("and", truth(x.lt(y) & y.lt(x.lit(1.0)))),
        ("or", truth(x.lt(y) | y.lt(x.lit(1.0)))),
        ("select", R::select(x.lt(y), x, y)),
    ]
}

/// Equal, both NaN, or within `ulps` units in the last place of a normal number, and within one
/// unit of a subnormal one.
fn agree(got: f64, expected: f64, ulps: f64, single: bool) -> bool {
    let (epsilon, least) = if single {
        (f64::from(f32::EPSILON), f64::from(f32::MIN_POSITIVE))
    } else {
        (f64::EPSILON, f64::MIN_POSITIVE)
    };
    got == expected
        || got.is_nan() && expected.is_nan()
        || (got - expected).abs() <= ulps * epsilon * expected.abs().max(least)
}

/// `got` and `expected` hold the same operations.
fn compare((got, expected): (Named<f64>, Named<f64>), ulps: f64, single: bool, input: &str) {
    for ((name, got), (_, expected)) in got.into_iter().zip(expected) {
        let ulps = if ["exp", "ln"].contains(&name) {
            ulps
        } else {
            0.0
        };
        assert!(
            agree(got, expected, ulps, single),
            "{name}({input}) = {got:e}, expected {expected:e}"
        );
    }
}

fn named<R>(results: Named<R>, lower: impl Fn(R) -> f64) -> Named<f64> {
    let lower = |(name, value)| (name, lower(value));
    results.into_iter().map(lower).collect()
}

fn first<L: Lanes>(lanes: L) -> L::Scalar
where
    L::Scalar: Default,
{
    let mut value = L::Scalar::default();
    lanes.scatter(|lane, x| {
        if lane == 0 {
            value = x;
        }
    });
    value
}

/// Calls `check` with x and y of every magnitude.
fn for_pairs(single: bool, mut check: impl FnMut(f64, f64)) {
    let numbers = numbers(single);
    for (i, x) in numbers.iter().enumerate() {
        check(*x, numbers[(i * 7919 + 13) % numbers.len()]);
        check(*x, *x);
    }
}

/// exp of `wide` and our ln are within 2 ulp of the scalar ones; exp near the ends within 4.
#[test]
fn f64_lanes_agree_with_f64() {
    for_pairs(false, |x, y| {
        let (a, b) = (F64Lanes::splat(x), F64Lanes::splat(y));
        let results = (named(unary(a), first), named(unary(x), |v| v));
        compare(results, 2.0, false, &format!("{x:e}"));
        let results = (named(binary(a, b), first), named(binary(x, y), |v| v));
        compare(results, 0.0, false, &format!("{x:e}, {y:e}"));
    });
}

#[test]
fn f32_lanes_agree_with_f32() {
    for_pairs(true, |x, y| {
        let (x, y) = (x as f32, y as f32);
        let (a, b) = (F32Lanes::splat(x), F32Lanes::splat(y));
        let lower = |v: F32Lanes| f64::from(first(v));
        let results = (named(unary(a), lower), named(unary(x), f64::from));
        compare(results, 2.0, true, &format!("{x:e}"));
        let results = (named(binary(a, b), lower), named(binary(x, y), f64::from));
        compare(results, 0.0, true, &format!("{x:e}, {y:e}"));
    });
}

/// Lanes do not influence each other: one lane at the end of the range, the others not.
#[test]
fn lanes_are_independent() {
    let inputs = [710.0, -746.0, 1.0, 1e-310];
    let lanes = F64Lanes::gather(|lane| inputs[lane]);
    lanes
        .exp()
        .scatter(|lane, got| assert!(agree(got, inputs[lane].exp(), 2.0, false)));
    lanes
        .abs()
        .ln()
        .scatter(|lane, got| assert!(agree(got, inputs[lane].abs().ln(), 2.0, false)));
}

#[test]
fn nodes_agree_with_scalars() {
    for_pairs(false, |x, y| {
        let host = Host::new(false);
        let value = |node: analytic_media::real::node::Node<'_>| host.value(node.slot());
        let (a, b) = (host.input(x), host.input(y));
        let results = (named(unary(a), value), named(unary(x), |v| v));
        compare(results, 0.0, false, &format!("{x:e}"));
        let results = (named(binary(a, b), value), named(binary(x, y), |v| v));
        compare(results, 0.0, false, &format!("{x:e}, {y:e}"));
    });
}

#[test]
fn duals_carry_the_value() {
    for_pairs(false, |x, y| {
        let (a, b) = (Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
        let results = (named(unary(a), |v| v.value), named(unary(x), |v| v));
        compare(results, 0.0, false, &format!("{x:e}"));
        let results = (named(binary(a, b), |v| v.value), named(binary(x, y), |v| v));
        compare(results, 0.0, false, &format!("{x:e}, {y:e}"));
    });
}

/// `mul_add` rounds once or twice, as the hardware has it: within the rounding of the product.
#[test]
fn mul_add_is_a_product_and_a_sum() {
    let mut random = Random::with_seed(4);
    for _ in 0..10_000 {
        let [x, a, b] = std::array::from_fn(|_| random.between(-10.0, 10.0));
        let expected = x * a + b;
        let host = Host::new(false);
        let node = host.input(x).mul_add(host.input(a), host.input(b));
        let lanes = F64Lanes::splat(x).mul_add(F64Lanes::splat(a), F64Lanes::splat(b));
        for got in [
            Real::mul_add(x, a, b),
            first(lanes),
            host.value(node.slot()),
        ] {
            assert!(
                (got - expected).abs() <= f64::EPSILON * ((x * a).abs() + b.abs()),
                "{x} {a} {b}"
            );
        }
    }
}

/// A recorded mask cannot know whether it is set.
#[test]
fn masks_know_whether_any_is_set() {
    assert!(Mask::any(true) && !Mask::any(false));
    let lanes = F64Lanes::gather(|lane| lane as f64);
    assert!(lanes.lt(lanes.lit(1.0)).any() && !lanes.lt(lanes.lit(0.0)).any());
    let host = Host::new(false);
    assert!(host.input(1.0).lt(host.input(0.0)).any());
}

#[test]
fn digits_and_roundoff_belong_to_the_format() {
    assert_eq!((1f32.digits(), 1f64.digits()), (24, 53));
    assert_eq!(F32Lanes::splat(1.0).digits(), 24);
    assert_eq!(Host::new(true).input(1.0).digits(), 24);
    assert_eq!(1f64.unit_roundoff(), f64::EPSILON / 2.0);
    assert_eq!(1f32.unit_roundoff(), f32::EPSILON / 2.0);
}
