//! What holds for air-light whatever the light: sums, limits, symmetries, derivatives; and that its
//! parts are what the paper says.

mod common;

use analytic_media::airlight::closed_form::{self, Expansion};
use analytic_media::airlight::jet::Jet;
use analytic_media::airlight::light::{Intensity, Light};
use analytic_media::airlight::moments;
use analytic_media::airlight::phase::{Deflection, Phase, PhaseFunction};
use analytic_media::airlight::{AirLight, quadrature};
use analytic_media::geometry::{Ray, Vector};
use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use analytic_media::special::gauss_legendre::rule;
use common::lamps::scene;
use common::random::Random;
use common::rows::{number, table};

/// A light in a medium by numbers: position, axis, σ_s, σ_t, g, cutoff angle, beam width.
fn lamp<R: Real>(numbers: &[R; 11], exponent: u32) -> AirLight<R> {
    let n = *numbers;
    let intensity = match exponent {
        0 => Intensity::Isotropic,
        1 => Intensity::Cone {
            cutoff_angle: n[9],
            beam_width: n[10],
        },
        3 => Intensity::Spot { exponent },
        _ => Intensity::Lobes { exponent },
    };
    AirLight {
        light: Light {
            position: [n[0], n[1], n[2]],
            axis: [n[3], n[4], n[5]],
            intensity,
        },
        phase: Phase::HenyeyGreenstein { g: n[8] },
        sigma_s: vec![n[6]],
        sigma_t: vec![n[7]],
    }
}

fn unit(random: &mut Random) -> [f64; 3] {
    random.direction()
}

/// A random light next to the ray along x.
fn numbers(random: &mut Random) -> [f64; 11] {
    let [x, y, z] = unit(random);
    let cutoff = random.between(0.1, 1.4);
    [
        random.between(-3.0, 3.0),
        random.magnitude(1e-4, 5.0),
        random.between(-0.1, 0.1),
        x,
        y,
        z,
        random.between(0.1, 1.0),
        random.magnitude(1e-3, 20.0),
        random.between(-0.9, 0.9),
        cutoff,
        cutoff * random.between(0.0, 1.0),
    ]
}

const RAY: Ray<f64> = Ray {
    origin: [0.0; 3],
    direction: [1.0, 0.0, 0.0],
};

fn radiance(numbers: &[f64; 11], exponent: u32, t0: f64, t1: f64) -> f64 {
    lamp(numbers, exponent).radiance(&RAY, t0, t1)[0]
}

/// L(a, c) = L(a, b) + e^(−κ_t (b − a)) L(b, c), with b anywhere, the foot and the edges included.
#[test]
fn segments_add_up() {
    let mut random = Random::with_seed(1);
    for i in 0..4000 {
        let numbers = numbers(&mut random);
        let exponent = [0, 1, 2, 3, 8][i % 5];
        let a = random.between(-5.0, 5.0);
        let c = a + random.magnitude(1e-3, 10.0);
        let b = if i % 3 == 0 {
            numbers[0].max(a).min(c)
        } else {
            random.between(a, c)
        };
        let whole = radiance(&numbers, exponent, a, c);
        let seen = (-numbers[7] * (b - a)).exp();
        let parts = radiance(&numbers, exponent, a, b) + seen * radiance(&numbers, exponent, b, c);
        let error = (whole - parts).abs();
        assert!(
            error <= 1e-9 * whole + 1e-290,
            "{whole:e} {parts:e} {exponent} {numbers:?}"
        );
    }
}

/// Peaks that are sharper than those of the table: the whole against the sum of twelve parts, each of
/// which has its own points.
#[test]
fn sharp_peaks_are_resolved() {
    let mut random = Random::with_seed(7);
    let mut worst = 0.0f64;
    for i in 0..600 {
        let mut numbers = numbers(&mut random);
        numbers[8] = [0.99, -0.99][i % 2];
        let exponent = [0, 32][i / 2 % 2];
        let (a, length) = (random.between(-5.0, 5.0), 6.0);
        let whole = radiance(&numbers, exponent, a, a + length);
        let parts = (0..12).map(|k| {
            let way = length * f64::from(k) / 12.0;
            let part = radiance(&numbers, exponent, a + way, a + way + length / 12.0);
            (-numbers[7] * way).exp() * part
        });
        let parts: f64 = parts.sum();
        worst = worst.max((whole - parts).abs() / (parts + 1e-290));
    }
    println!("worst {worst:e}");
    assert!(worst <= 1e-7);
}

/// The light may lie on the ray, as long as the segment does not reach it.
#[test]
fn a_light_on_the_ray_is_a_limit() {
    for (t0, t1) in [(2.0, 3.0), (-4.0, 0.5), (1.5, f64::INFINITY)] {
        let at = |h: f64| {
            let numbers = [1.0, h, 0.0, 0.6, 0.8, 0.0, 1.0, 0.7, 0.4, 1.2, 0.8];
            radiance(&numbers, 0, t0, t1)
        };
        assert!(at(0.0) > 0.0);
        for h in [1e-9, 1e-12, 1e-200] {
            assert!((at(h) / at(0.0) - 1.0).abs() <= 1e-12, "{h:e}");
        }
        // Next to the light, h counts by its square.
        assert!((at(1e-4) / at(0.0) - 1.0).abs() <= 1e-6);
    }
}

/// A segment that begins a little before or beyond the foot.
#[test]
fn the_foot_is_no_seam() {
    let numbers = [1.0, 0.3, 0.0, 0.6, -0.8, 0.0, 1.0, 0.7, 0.8, 1.2, 0.8];
    for exponent in [0, 1, 2, 3] {
        let at = |t: f64| radiance(&numbers, exponent, t, 3.0);
        for step in [1e-12, 1e-9, 1e-6] {
            let change = (at(1.0 + step) - at(1.0 - step)).abs();
            assert!(
                change <= 20.0 * step * at(1.0) / 0.3,
                "{exponent} {step:e} {change:e}"
            );
        }
    }
}

/// Every channel is computed as if it were alone, if all have the same extinction.
#[test]
fn equal_channels_are_equal() {
    let mut random = Random::with_seed(2);
    for i in 0..200 {
        let one = lamp(&numbers(&mut random), [0, 1, 2, 3][i % 4]);
        let three = AirLight {
            sigma_s: vec![one.sigma_s[0]; 3],
            sigma_t: vec![one.sigma_t[0]; 3],
            ..one.clone()
        };
        let expected = one.radiance(&RAY, -1.0, 4.0)[0];
        assert_eq!(three.radiance(&RAY, -1.0, 4.0), vec![expected; 3]);
    }
}

/// Channels share their points, which must serve the thinnest and the thickest.
#[test]
fn channels_may_differ_tenfold() {
    let mut random = Random::with_seed(3);
    for i in 0..400 {
        let numbers = numbers(&mut random);
        let mut air = lamp(&numbers, [0, 2, 8][i % 3]);
        let sigma = numbers[7];
        air.sigma_t = vec![sigma, 3.0 * sigma, 10.0 * sigma];
        air.sigma_s = vec![1.0; 3];
        let together = air.radiance(&RAY, 0.0, f64::INFINITY);
        for (channel, got) in together.into_iter().enumerate() {
            let alone = AirLight {
                sigma_s: vec![1.0],
                sigma_t: vec![air.sigma_t[channel]],
                ..air.clone()
            };
            let alone = alone.radiance(&RAY, 0.0, f64::INFINITY)[0];
            let error = (got - alone).abs();
            assert!(
                error <= 1e-8 * alone + 1e-290,
                "{channel}: {error:e} {alone:e} {numbers:?}"
            );
        }
    }
}

/// The cone against many thin slices of an isotropic light, each with the intensity in its middle.
#[test]
fn cones_are_what_they_say() {
    let mut random = Random::with_seed(4);
    for _ in 0..10 {
        let mut numbers = numbers(&mut random);
        // The slices must be thin next to the edge.
        numbers[1] = numbers[1].max(0.3);
        numbers[10] = numbers[10].min(0.8 * numbers[9]);
        let (a, n) = (-4.0, 20_000);
        let step = 8.0 / f64::from(n);
        let slices = (0..n).map(|k| {
            let t = a + step * f64::from(k);
            let middle = t + 0.5 * step;
            let from_light = [middle - numbers[0], -numbers[1], -numbers[2]];
            let cos = (0..3).map(|i| from_light[i] * numbers[3 + i]).sum::<f64>();
            let cos = cos / from_light.iter().map(|x| x * x).sum::<f64>().sqrt();
            let width = (numbers[9] - numbers[10]).max(1e-300);
            let intensity = ((numbers[9] - cos.acos()) / width).clamp(0.0, 1.0);
            if intensity == 0.0 {
                return 0.0;
            }
            let seen = (-numbers[7] * (t - a)).exp();
            intensity * seen * radiance(&numbers, 0, t, t + step)
        });
        let expected: f64 = slices.sum();
        let got = radiance(&numbers, 1, a, a + 8.0);
        let scale = radiance(&numbers, 0, a, a + 8.0);
        assert!(
            (got - expected).abs() <= 1e-5 * scale,
            "{got:e} {expected:e} {numbers:?}"
        );
    }
}

/// Every derivative in forward mode, against differences.
#[test]
fn derivatives_are_those_of_differences() {
    let mut random = Random::with_seed(5);
    for i in 0..200 {
        let exponent = [0, 1, 2, 3][i % 4];
        let mut at = numbers(&mut random);
        at[1] = at[1].max(0.2);
        at[7] = at[7].min(3.0);
        let (t0, t1) = (-1.0, 4.0);
        let lifted: [Dual<f64, 11>; 11] = std::array::from_fn(|k| Dual::variable(at[k], k));
        let constant = |x: f64| Dual::constant(x);
        let ray = Ray {
            origin: RAY.origin.map(constant),
            direction: RAY.direction.map(constant),
        };
        let air = lamp(&lifted, exponent);
        let got = air.radiance(&ray, constant(t0), constant(t1))[0];
        for k in 0..11 {
            let mut shifted = [at; 2];
            shifted[0][k] += 1e-5;
            shifted[1][k] -= 1e-5;
            let [more, less] = shifted.map(|n| radiance(&n, exponent, t0, t1));
            let expected = (more - less) / 2e-5;
            let error = (got.gradient[k] - expected).abs();
            // Next to an edge, differences are of the first order.
            let size = expected.abs().max(10.0 * got.value.abs());
            assert!(
                error <= 2e-4 * size,
                "{k}: {} {expected} {exponent} {at:?}",
                got.gradient[k]
            );
        }
    }
}

/// No input makes a NaN or an infinity, in any precision.
#[test]
fn radiance_is_finite() {
    fn check<R: Real>(lift: impl Fn(f64) -> R, lower: impl Fn(R) -> f64) {
        let mut random = Random::with_seed(6);
        for i in 0..20_000 {
            let mut n = numbers(&mut random);
            match i % 7 {
                0 => n[1] = 0.0,
                1 => (n[0], n[1], n[2]) = (0.0, 0.0, 0.0),
                2 => n[7] = 0.0,
                3 => n[7] = 50.0 / n[1].max(1e-4),
                4 => (n[3], n[4], n[5]) = (1.0, 0.0, 0.0),
                _ => {}
            }
            let t0 = [0.0, n[0], -10.0][i % 3];
            let t1 = [t0, t0 + 1e-6, 5.0, f64::INFINITY, n[0]][i % 5];
            let air = lamp(&n.map(&lift), [0, 1, 2, 3, 16][i % 5]);
            let ray = Ray {
                origin: RAY.origin.map(&lift),
                direction: RAY.direction.map(&lift),
            };
            let got = lower(air.radiance(&ray, lift(t0), lift(t1))[0]);
            assert!(got.is_finite() && got >= 0.0, "{got} {t0} {t1} {i} {n:?}");
        }
    }
    check(|x| x, |x| x);
    check(|x| x as f32, f64::from);
}

/// Whoever implements the trait has a phase function: a mixture.
#[test]
fn phase_functions_can_be_added() {
    struct Mixture<R>(R, [Phase<R>; 2]);
    impl<R: Real> PhaseFunction<R> for Mixture<R> {
        fn value(&self, deflection: Deflection<R>) -> R {
            let Self(share, [a, b]) = self;
            let rest = share.lit(1.0) - *share;
            *share * a.value(deflection) + rest * b.value(deflection)
        }
        fn peaks(&self, like: R) -> [R; 2] {
            let [a, b] = self.1.map(|phase| phase.peaks(like));
            [a[0].min(b[0]), a[1].min(b[1])]
        }
    }
    let phases = [Phase::HenyeyGreenstein { g: 0.9 }, Phase::Rayleigh];
    let mut air = lamp(&[1.0, 0.5, 0.0, 1.0, 0.0, 0.0, 1.0, 0.4, 0.0, 1.0, 0.5], 0);
    let parts = phases.map(|phase| {
        air.phase = phase;
        air.radiance(&RAY, 0.0, 6.0)[0]
    });
    let got = quadrature::radiance(&air, &Mixture(0.3, phases), &RAY, 0.0, 6.0)[0];
    assert!((got / (0.3 * parts[0] + 0.7 * parts[1]) - 1.0).abs() <= 1e-11);
}

// ---- The closed form

/// For isotropic light and scattering the closed form is exact, whatever the medium.
#[test]
fn isotropic_closed_form_matches_the_table() {
    let mut rows = 0;
    for row in table("airlight") {
        if row["light"]["type"] != "isotropic" || row["phase"]["type"] != "isotropic" {
            continue;
        }
        let (air, ray, t0, t1) = scene(&row, |x| x);
        for expansion in [Expansion::Fixed, Expansion::Midpoint] {
            let got = closed_form::radiance::<_, 1>(&air, expansion, &ray, t0, t1)[0];
            let error = (got / number(&row["L"]) - 1.0).abs();
            assert!(error <= 1e-11, "{error:e}: {row}");
        }
        rows += 1;
    }
    assert_eq!(rows, 32);
}

/// Moments against quadrature of their integrals.
#[test]
fn moments_are_integrals() {
    const N: usize = 8;
    // Panels that halve towards a, where e^(−H/w) may set in.
    let quadrature = |a: f64, b: f64, f: &dyn Fn(f64) -> f64| -> f64 {
        let panel = |p: i32| {
            let width = (b - a) * 0.5f64.powi(p + 1);
            let start = a + width;
            let part = |(x, w): &(f64, f64)| width * w * f(start + width * x);
            rule(32).iter().map(part).sum::<f64>()
        };
        (0..60).map(panel).sum()
    };
    for optical in [1e-4, 0.01, 0.7, 5.0, 17.0, 25.0, 50.0] {
        for (a, b) in [(0.0, 1.0), (0.25, 1.0), (0.1, 0.5), (0.0, 0.3)] {
            let before: [f64; N] = moments::before(optical, a, b);
            let beyond: [f64; N] = moments::beyond(optical, a, b);
            for n in 0..N {
                let power = |w: f64| w.powi(n as i32) / (1.0 + w * w);
                let first = quadrature(a, b, &|w| (-optical * (w - a)).exp() * power(w));
                let second = quadrature(a, b, &|w| (optical / b - optical / w).exp() * power(w));
                let error = |got: f64, expected: f64| (got - expected).abs() / expected.max(1e-3);
                assert!(
                    error(before[n], first) <= 1e-10,
                    "before {n} {optical} {a} {b}"
                );
                let e = error(beyond[n], second);
                assert!(e <= 1e-10, "beyond {n} {optical} {a} {b} {e:e}");
            }
        }
    }
}

/// f⁽ⁿ⁾(x)/n! of the series in Appendix B.
fn taylor<const N: usize>(derivatives: [f64; N]) -> [f64; N] {
    let mut factorial = 1.0;
    std::array::from_fn(|n| {
        factorial *= (n as f64).max(1.0);
        derivatives[n] / factorial
    })
}

fn agree<const N: usize>(got: Jet<f64, N>, expected: [f64; N]) {
    for n in 0..N {
        let error = (got.0[n] - expected[n]).abs();
        assert!(
            error <= 1e-12 * (1.0 + expected[n].abs()),
            "{n}: {got:?} {expected:?}"
        );
    }
}

/// (40): the Rayleigh phase function, times 4π.
#[test]
fn rayleigh_has_the_series_of_the_paper() {
    for x in [-1.0, -0.5, 0.0, 0.3, 0.5, 0.9, 1.0f64] {
        let y = x * x + 1.0;
        let x2 = x * x;
        let series = [
            0.75 * 2.0 / y.powi(2) * (x2 * x2 + 1.0),
            0.75 * 4.0 / y.powi(3) * 2.0 * (x2 - 1.0) * x,
            0.75 * 8.0 / y.powi(4) * (-3.0 * x2 * x2 + 8.0 * x2 - 1.0),
            0.75 * 16.0 / y.powi(5) * 6.0 * x * (x2 * x2 - 5.0 * x2 + 2.0),
            0.75 * 32.0 / y.powi(6) * 3.0 * (-5.0 * x.powi(6) + 40.0 * x2 * x2 - 33.0 * x2 + 2.0),
            0.75 * 64.0 / y.powi(7)
                * 15.0
                * (3.0 * x.powi(7) - 35.0 * x.powi(5) + 49.0 * x.powi(3) - 9.0 * x),
        ];
        let v = Jet::<f64, 6>::variable(x);
        let one = v.lit(1.0);
        let cos = (one - v * v) / (v * v + one);
        let got = Phase::Rayleigh.value(Deflection {
            cos,
            from_forward: one - cos,
            from_backward: one + cos,
        });
        agree(got * v.lit(4.0 * std::f64::consts::PI), taylor(series));
    }
}

/// (41) as far as its first derivative, for the lobes of a light.
#[test]
fn lobes_have_the_series_of_the_paper() {
    let (a, b) = (0.6, 1.1f64);
    for p in [2u32, 4, 8, 16] {
        for x in [-0.5, 0.0, 0.3, 0.5, 1.0f64] {
            let y = x * x + 1.0;
            let base = a * (x * x - 1.0) + b * x;
            let power = |k: u32| base.powi(k as i32);
            let series = [
                power(p) / y.powi(p as i32),
                power(p - 1) / y.powi(p as i32 + 1)
                    * f64::from(p)
                    * (4.0 * a * x - b * (x * x - 1.0)),
            ];
            let v = Jet::<f64, 2>::variable(x);
            let one = v.lit(1.0);
            let toward = analytic_media::airlight::light::Toward {
                cos: (v.lit(a) * (v * v - one) + v.lit(b) * v) / (v * v + one),
                across: [v.lit(0.0); 3] as Vector<Jet<f64, 2>>,
            };
            agree(
                Intensity::Lobes { exponent: p }.value(&toward),
                taylor(series),
            );
        }
    }
}

/// Taylor arithmetic against series known by heart: e^x, √(1 + x), ln(1 + x) and 1/(1 − x) near 0.
#[test]
fn jets_are_series() {
    let x = Jet::<f64, 6>::variable(0.0);
    let one = x.lit(1.0);
    agree(x.exp(), taylor([1.0; 6]));
    agree(one / (one - x), [1.0; 6]);
    agree((one + x).ln(), [0.0, 1.0, -0.5, 1.0 / 3.0, -0.25, 0.2]);
    agree(
        (one + x).sqrt(),
        [1.0, 0.5, -0.125, 0.0625, -5.0 / 128.0, 7.0 / 256.0],
    );
    // (x − 1/2)² about 0.
    let shifted = Jet::<f64, 3>([0.0, 0.0, 1.0]).about_zero(0.5);
    assert_eq!(shifted, [0.25, -1.0, 1.0]);
}
