//! The Chapman function and its relatives against the reference tables, in every arithmetic.
//!
//! All rows of chapman.json, erfcx.json and bessel_k1.json, to 1e-12 in double and 2e-6 in single
//! precision; logarithms to that times 1 + their size. Rows whose arguments single precision does not
//! hold are compared with double precision of the rounded arguments. Worst errors per regime:
//! `--nocapture`.

mod common;

use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use analytic_media::special::approximations::{
    chapman_horizontal_huestis, chapman_huestis, chapman_kocifaj, chapman_schueler, erfcx_golubev,
    erfcx_ren_mackenzie,
};
use analytic_media::special::bessel::k1_scaled;
use analytic_media::special::chapman::{
    chapman, horizontal, log_chapman, log_rescaled, lower, rescaled, upper,
};
use analytic_media::special::erfcx::erfcx;
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::random::Random;
use common::rows::{number, table};
use serde_json::Value;

fn tag(row: &Value) -> String {
    row["regime"].as_str().expect("a row has a regime").into()
}

fn tolerance<L, O>(a: &Arithmetic<L, O>) -> f64 {
    if a.single { 2e-6 } else { 1e-12 }
}

/// Tests one function against a column of a table. `exact` is the function in double precision.
struct Check<'a> {
    key: &'a str,
    inputs: &'a [&'a str],
    logarithm: bool,
    exact: fn(&[f64]) -> f64,
}

impl Check<'_> {
    fn run<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(
        &self,
        a: &Arithmetic<L, O>,
        rows: &[Value],
        function: impl Fn(&[R]) -> R,
    ) {
        let mut errors = Errors::new();
        for row in rows {
            let numbers: Vec<f64> = self.inputs.iter().map(|key| number(&row[*key])).collect();
            let lifted: Vec<R> = numbers.iter().map(|x| (a.lift)(*x)).collect();
            let got = (a.lower)(function(&lifted));
            let exact = if a.single && row["f32"] == false {
                let rounded: Vec<f64> = numbers.iter().map(|x| a.round(*x)).collect();
                (self.exact)(&rounded)
            } else {
                number(&row[self.key])
            };
            let expected = a.round(exact);
            let size = if self.logarithm {
                1.0 + expected.abs()
            } else {
                expected.max(a.least())
            };
            // Near the largest number, an error may overflow.
            let huge = !expected.is_finite() || !got.is_finite();
            let error = if got == expected || (huge && exact > 0.99 * a.largest()) {
                0.0
            } else {
                (got - expected).abs() / size
            };
            assert!(
                error <= tolerance(a),
                "{}: {} {got:e}, expected {expected:e}: {row}",
                a.name,
                self.key
            );
            let regime = errors.entry(tag(row)).or_default();
            regime.push((error, tolerance(a)));
        }
        a.print(&format!("error of {}", self.key), &errors);
    }
}

fn chapman_rows<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let rows = table("chapman");
    let plain = Check {
        key: "C",
        inputs: &["z", "cos_theta"],
        logarithm: false,
        exact: |x| chapman(x[0], x[1]),
    };
    plain.run(a, &rows, |x| chapman(x[0], x[1]));
    let logarithm = Check {
        key: "log_C",
        logarithm: true,
        exact: |x| log_chapman(x[0], x[1]),
        ..plain
    };
    logarithm.run(a, &rows, |x| log_chapman(x[0], x[1]));
    let scaled = Check {
        key: "Cr",
        inputs: &["z", "Z", "cos_theta"],
        logarithm: false,
        exact: |x| rescaled(x[0], x[1], x[2]),
    };
    scaled.run(a, &rows, |x| rescaled(x[0], x[1], x[2]));
    let scaled_logarithm = Check {
        key: "log_Cr",
        logarithm: true,
        exact: |x| log_rescaled(x[0], x[1], x[2]),
        ..scaled
    };
    scaled_logarithm.run(a, &rows, |x| log_rescaled(x[0], x[1], x[2]));

    let (down, up): (Vec<Value>, Vec<Value>) = rows
        .into_iter()
        .partition(|row| number(&row["cos_theta"]) < 0.0);
    plain.run(a, &up, |x| upper(x[0], x[1]));
    plain.run(a, &down, |x| lower(x[0], x[1]));
    let level: Vec<Value> = up
        .into_iter()
        .filter(|row| number(&row["cos_theta"]) == 0.0)
        .collect();
    assert!(level.len() >= 5);
    plain.run(a, &level, |x| horizontal(x[0]));
    plain.run(a, &level, |x| lower(x[0], x[1]));
}

#[test]
fn chapman_matches_the_table() {
    in_every_arithmetic!(chapman_rows);
}

fn erfcx_rows<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let check = Check {
        key: "erfcx",
        inputs: &["x"],
        logarithm: false,
        exact: |x| erfcx(x[0]),
    };
    check.run(a, &table("erfcx"), |x| erfcx(x[0]));
}

#[test]
fn erfcx_matches_the_table() {
    in_every_arithmetic!(erfcx_rows);
}

fn k1_rows<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let check = Check {
        key: "zexpzK1",
        inputs: &["z"],
        logarithm: false,
        exact: |x| k1_scaled(x[0]),
    };
    check.run(a, &table("bessel_k1"), |x| k1_scaled(x[0]));
}

#[test]
fn k1_matches_the_table() {
    in_every_arithmetic!(k1_rows);
}

/// erfcx(−x) + erfcx(x) = 2 exp(x²), up to where it overflows.
fn reflection<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut random = Random::with_seed(11);
    for _ in 0..2000 {
        let x = a.round(random.between(0.0, if a.single { 9.3 } else { 26.5 }));
        let got = (a.lower)(erfcx((a.lift)(-x))) + (a.lower)(erfcx((a.lift)(x)));
        // The square as two numbers, so that the expectation is exact too.
        let (square, rest) = (x * x, x.mul_add(x, -(x * x)));
        let expected = 2.0 * square.exp() * (1.0 + rest);
        let error = (got / expected - 1.0).abs();
        assert!(error <= tolerance(a), "{}: {x} {error:e}", a.name);
    }
    for x in [-30.0, -1e30] {
        assert_eq!((a.lower)(erfcx((a.lift)(x))), f64::INFINITY);
    }
}

#[test]
fn erfcx_reflects() {
    in_every_arithmetic!(reflection);
}

/// Arguments of every magnitude: never NaN, never negative, and monotone downwards.
fn promises<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut random = Random::with_seed(12);
    let edges = [0.0, a.least(), 1.0, 1e30, a.largest()];
    let magnitudes = (0..500).map(|_| random.magnitude(1e-30, 1e30));
    let zs: Vec<f64> = edges.into_iter().chain(magnitudes).collect();
    let mut random = Random::with_seed(13);
    for z in zs {
        let mut cosines = vec![-1.0, -a.least(), 0.0, a.least(), 1.0];
        cosines.extend((0..5).map(|_| a.round(random.between(-1.0, 1.0))));
        cosines.sort_by(f64::total_cmp);
        let values: Vec<f64> = cosines
            .iter()
            .map(|mu| (a.lower)(chapman((a.lift)(z), (a.lift)(*mu))))
            .collect();
        for pair in values.windows(2) {
            let fall = pair[0] * (1.0 + tolerance(a));
            assert!(pair[1] <= fall, "{}: z {z:e} {pair:?}", a.name);
        }
        // 1 at the zenith, and 2 e^z − 1 at the nadir.
        let zenith = values.last().expect("values");
        assert!((zenith - 1.0).abs() <= tolerance(a), "z {z:e} {zenith:e}");
        let log = (a.lower)(log_chapman((a.lift)(z), (a.lift)(-1.0)));
        let expected = a.round(z) + (2.0 - (-a.round(z)).exp()).ln();
        let error = (log - expected).abs() / (1.0 + expected);
        assert!(error <= tolerance(a), "{}: z {z:e} {error:e}", a.name);
    }
}

#[test]
fn chapman_is_monotone_for_every_argument() {
    in_every_arithmetic!(promises);
}

/// Both sides of a value's change, against the derivative.
#[test]
fn derivatives_of_chapman_are_differences() {
    let mut random = Random::with_seed(14);
    for _ in 0..2000 {
        let z = random.magnitude(1.0, 1e5);
        let mu = random.between(-0.99, 0.99);
        let (x, y) = (Dual::<f64, 2>::variable(z, 0), Dual::variable(mu, 1));
        let got = log_chapman(x, y);
        let difference = |f: &dyn Fn(f64) -> f64, h: f64| (f(h) - f(-h)) / (2.0 * h);
        let by_z = difference(&|h| log_chapman(z + h, mu), 1e-5 * z);
        // C changes with the angle over the square root of the scale height.
        let by_mu = difference(&|h| log_chapman(z, mu + h), 1e-4 / z.sqrt());
        for (got, expected, scale) in [
            (got.gradient[0], by_z, 1.0 / z),
            (got.gradient[1], by_mu, 1.0),
        ] {
            let error = (got - expected).abs();
            assert!(
                error <= 1e-6 * (expected.abs() + scale),
                "z {z} mu {mu}: {got} {expected}"
            );
        }
    }
}

/// The errors that the documentation states for single precision, against double precision.
#[test]
fn single_precision_is_as_documented() {
    let mut random = Random::with_seed(15);
    let mut worst = [0.0f64; 3];
    for _ in 0..100_000 {
        let z = random.magnitude(1e-2, 1e6) as f32;
        let mu = random.between(-1.0, 1.0) as f32;
        let x = random.magnitude(1e-5, 1e6) as f32;
        let (zd, mud) = (f64::from(z), f64::from(mu));
        let pairs = [
            (chapman(z, mu), chapman(zd, mud)),
            (k1_scaled(z), k1_scaled(zd)),
            (erfcx(x), erfcx(f64::from(x))),
        ];
        for (worst, (got, expected)) in worst.iter_mut().zip(pairs) {
            if expected < f64::from(f32::MAX) {
                *worst = worst.max((f64::from(got) / expected - 1.0).abs());
            }
        }
    }
    println!(
        "C {:.1e}, K1 {:.1e}, erfcx {:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(
        worst[0] <= 1e-6 && worst[1] <= 6e-7 && worst[2] <= 5e-7,
        "{worst:?}"
    );
}

/// The greatest relative error over 91 angles from the zenith to the horizon.
fn worst(z: f64, approximation: fn(f64, f64) -> f64) -> f64 {
    let cosine = |k: i32| f64::from(90 - k).to_radians().sin().max(0.0);
    let error = |mu| (approximation(z, mu) / chapman(z, mu) - 1.0).abs();
    (0..=90).map(cosine).map(error).fold(0.0, f64::max)
}

/// Asserts that an error is what the documentation says, to its two digits.
fn assert_documented(name: &str, error: f64, documented: f64) {
    println!("{name}: {error:.2e}");
    assert!(
        error <= 1.05 * documented && documented <= 1.1 * error,
        "{name}: {error:e}, documented {documented:e}"
    );
}

/// The tables in `src/special/approximations.rs`.
#[test]
fn approximations_have_the_errors_of_their_documentation() {
    type Row = (&'static str, fn(f64, f64) -> f64, [f64; 5]);
    const SIZES: [f64; 5] = [1.0, 10.0, 100.0, 795.0, 6600.0];
    let rows: [Row; 3] = [
        (
            "Huestis",
            chapman_huestis,
            [8.1e-2, 2.5e-3, 3.2e-5, 1.1e-6, 6.5e-7],
        ),
        (
            "Schüler",
            chapman_schueler,
            [3.6e-2, 6.0e-2, 1.2e-1, 1.4e-1, 1.5e-1],
        ),
        (
            "Kocifaj",
            chapman_kocifaj,
            [1.6e-1, 1.4e-2, 4.0e-3, 3.4e-3, 3.3e-3],
        ),
    ];
    for (name, approximation, documented) in rows {
        for (z, documented) in SIZES.into_iter().zip(documented) {
            let name = format!("{name}, z = {z}");
            assert_documented(&name, worst(z, approximation), documented);
        }
    }
    for (z, documented) in SIZES
        .into_iter()
        .zip([3.6e-2, 8.7e-5, 1.0e-7, 2.0e-10, 3.6e-13])
    {
        let error = (chapman_horizontal_huestis(z) / k1_scaled(z) - 1.0).abs();
        // k1_scaled has an error of its own.
        assert_documented("Huestis, 90°", error, documented);
    }

    let points = (0..20_000).map(|k| 1e-4 * 10f64.powf(f64::from(k) * 5e-4));
    let greatest = |f: &dyn Fn(f64) -> f64| points.clone().map(f).fold(0.0, f64::max);
    let golubev = greatest(&|x| (erfcx_golubev(x) / erfcx(x) - 1.0).abs());
    assert_documented("Golubev", golubev, 1.5e-6);
    let single = |x: f64| f64::from(erfcx_golubev(x as f32)) / erfcx(f64::from(x as f32)) - 1.0;
    assert_documented("Golubev, f32", greatest(&|x| single(x).abs()), 1.8e-6);
    let ren = greatest(&|x| (erfcx_ren_mackenzie(x) / erfcx(x) - 1.0).abs());
    assert_documented("Ren and MacKenzie", ren, 3.4e-3);
}
