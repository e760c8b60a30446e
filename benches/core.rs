//! Batched queries of the C ABI against their floor: a loop over the vector exponentials and
//! logarithms that the formula must evaluate, and nothing else.
//!
//!     RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench
//!
//! Criterion prints the time of each loop; the last lines are nanoseconds per ray and the
//! ratio to the floor. A second table has columns with their derivatives, for all profiles: over
//! the column alone, and over the same floor, since they need no other exponentials.

use analytic_media::airlight::closed_form::{self, Expansion};
use analytic_media::airlight::light::{Intensity, Light};
use analytic_media::airlight::phase::Phase;
use analytic_media::airlight::sunlit::SunlitFog;
use analytic_media::airlight::{AirLight, quadrature};
use analytic_media::ffi::*;
use analytic_media::geometry::Ray;
use analytic_media::profile::{AnyProfile, Kind};
use analytic_media::real::Real;
use analytic_media::real::lanes::{F32Lanes, F64Lanes, Lanes};
use criterion::Criterion;
use std::hint::black_box;
use std::time::Instant;

/// Rays per batch: their data stay in the caches.
const N: usize = 4096;

const PROFILES: [(&str, [f64; 6]); 3] = [
    ("constant", [0.0; 6]),
    ("linear", [0.0, 0.0, 1.0, 0.0, -0.05, 1.0]),
    ("exponential", [0.0, 0.0, 1.0, 0.0, 8.0, 0.0]),
];

fn profile(index: usize) -> AmProfile {
    let mut values = [0.0; AM_PROFILE_VALUES];
    values[..6].copy_from_slice(&PROFILES[index].1);
    let kind = index as u32;
    AmProfile { kind, values }
}

/// Kinds with parameters around 10, and the exponentials of a column in single and in double
/// precision. Half of the rays turn at a perigee.
const ALL: [(u32, &[f64], [usize; 2]); 8] = [
    (0, &[], [0, 0]),
    (1, &[0.0, 0.0, 1.0, 0.0, -0.05, 1.0], [0, 0]),
    (2, &[0.0, 0.0, 1.0, 0.0, 8.0], [2, 2]),
    (3, &[0.0, 0.0, -6371.0, 6371.0, 8.0], [21, 49]),
    (4, &[0.0, 0.0, -6371.0, 6371.0, 10.0, 8.0], [0, 0]),
    (5, &[20.0, 1.0, 10.0, 8.0], [21, 49]),
    (
        6,
        &[
            20.0, 1.0, 10.0, 8.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 10.0,
        ],
        [21, 49],
    ),
    (7, &[0.0, 0.0, -6371.0, 6371.0, 8.0], [21, 49]),
];

/// Median over many batches, nanoseconds per ray.
fn nanoseconds(mut batch: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..400)
        .map(|_| {
            let start = Instant::now();
            batch();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2] / N as f64 * 1e9
}

/// A line of the table: what was asked, its time and its floor's.
type Row = (String, f64, f64);

macro_rules! precision {
    ($bench:ident, $gradients:ident, $float:ident, $Lanes:ident, $Array:ident, $exps:literal,
     $density:ident, $column:ident, $inv_column:ident, $gradient:ident) => {
        /// Prints columns, alone and with their derivatives.
        fn $gradients() {
            let mut random = fastrand::Rng::with_seed(1);
            let origins: Vec<$float> = (0..3 * N).map(|i| (i % 17) as $float).collect();
            let directions: Vec<[$float; 3]> = (0..N)
                .map(|_| {
                    let mu = random.f64() * 2.0 - 1.0;
                    [(1.0 - mu * mu).sqrt() as $float, 0.0, mu as $float]
                })
                .collect();
            let lengths: Vec<$float> = (0..N).map(|i| 1.0 + (i % 23) as $float).collect();
            let array = |data: *const $float, stride| $Array { data, stride };
            let (o, d) = (
                array(origins.as_ptr(), 3),
                array(directions.as_ptr().cast(), 3),
            );
            let t = array(lengths.as_ptr(), 1);
            let mut out: Vec<$float> = vec![0.0; N * 20];
            for (kind, values, exps) in ALL {
                let mut profile = AmProfile {
                    kind,
                    values: [0.0; AM_PROFILE_VALUES],
                };
                profile.values[..values.len()].copy_from_slice(values);
                let pointer = out.as_mut_ptr();
                // SAFETY: every array has N items, and a row has at most 20 numbers.
                let column = nanoseconds(|| unsafe {
                    assert_eq!($column(&profile, N, o, d, t, pointer), AmStatus::Ok);
                    black_box(pointer);
                });
                // SAFETY: as above.
                let both = nanoseconds(|| unsafe {
                    assert_eq!($gradient(&profile, N, o, d, t, pointer), AmStatus::Ok);
                    black_box(pointer);
                });
                let floor = nanoseconds(|| {
                    for first in (0..N).step_by($Lanes::COUNT) {
                        let x = $Lanes::gather(|lane| lengths[first + lane]);
                        let mut sum = x;
                        for k in 0..exps[$exps] {
                            sum = sum + (-(x * x.lit(0.01 * (k + 1) as f64))).exp();
                        }
                        sum.scatter(|lane, value| out[first + lane] = value);
                    }
                    black_box(&out);
                });
                println!(
                    "{:<4} kind {kind:<20} {column:>8.1} {both:>8.1} {:>6.2} {floor:>8.1} {:>6.2}",
                    stringify!($float),
                    both / column,
                    both / floor
                );
            }
        }

        fn $bench(criterion: &mut Criterion, rows: &mut Vec<Row>) {
            let name = stringify!($float);
            let origins: Vec<[$float; 3]> = (0..N)
                .map(|i| [i as $float * 0.01, 1.0, 5.0 + (i % 17) as $float])
                .collect();
            let directions: Vec<[$float; 3]> = (0..N)
                .map(|i| {
                    let mu = (i as $float / N as $float) * 1.8 - 0.9;
                    [(1.0 - mu * mu).sqrt(), 0.0, mu]
                })
                .collect();
            let lengths: Vec<$float> = (0..N).map(|i| 0.1 + (i % 23) as $float).collect();
            let mut out: Vec<$float> = vec![0.0; N];

            // The floors: `exps` exponentials and `logs` logarithms per ray.
            let floor = |exps: usize, logs: usize, out: &mut [$float]| {
                for first in (0..N).step_by($Lanes::COUNT) {
                    let mut x = $Lanes::gather(|lane| lengths[first + lane]);
                    for _ in 0..exps {
                        x = (-x).exp();
                    }
                    for _ in 0..logs {
                        x = x.ln();
                    }
                    x.scatter(|lane, value| out[first + lane] = value);
                }
            };

            for index in 0..PROFILES.len() {
                let profile = profile(index);
                let points = |data: &[[$float; 3]]| $Array {
                    data: data.as_ptr().cast(),
                    stride: 3,
                };
                let numbers = $Array {
                    data: lengths.as_ptr(),
                    stride: 1,
                };
                let (o, d) = (points(&origins), points(&directions));
                let costs = if PROFILES[index].0 == "exponential" {
                    [(1, 0), (2, 0), (1, 2)]
                } else {
                    [(0, 0); 3]
                };
                for (question, (exps, logs)) in
                    ["density", "column", "inv_column"].into_iter().zip(costs)
                {
                    let out_pointer = out.as_mut_ptr();
                    let mut ask = || {
                        // SAFETY: every array has N items.
                        let status = unsafe {
                            match question {
                                "density" => $density(&profile, N, o, out_pointer),
                                "column" => $column(&profile, N, o, d, numbers, out_pointer),
                                _ => $inv_column(&profile, N, o, d, numbers, out_pointer),
                            }
                        };
                        assert_eq!(status, AmStatus::Ok);
                        black_box(out_pointer);
                    };
                    let name = format!("{name} {} {question}", PROFILES[index].0);
                    criterion.bench_function(&name, |b| b.iter(&mut ask));
                    let time = nanoseconds(&mut ask);
                    let least = nanoseconds(|| {
                        floor(exps, logs, &mut out);
                        black_box(&out);
                    });
                    rows.push((name, time, least));
                }
            }
        }
    };
}

precision!(
    bench_f32,
    gradients_f32,
    f32,
    F32Lanes,
    AmArrayF32,
    0,
    am_profile_density_batch_f32,
    am_profile_column_batch_f32,
    am_profile_inv_column_batch_f32,
    am_profile_column_value_and_gradient_batch_f32
);
precision!(
    bench_f64,
    gradients_f64,
    f64,
    F64Lanes,
    AmArrayF64,
    1,
    am_profile_density_batch_f64,
    am_profile_column_batch_f64,
    am_profile_inv_column_batch_f64,
    am_profile_column_value_and_gradient_batch_f64
);

/// Single scattering in one channel: rays past a lamp, by quadrature of isotropic light that
/// Henyey–Greenstein's phase function scatters, and in closed form for an isotropic one; rays
/// through exponential fog in the sun.
macro_rules! scattering {
    ($bench:ident, $float:ident, $Lanes:ident) => {
        fn $bench(criterion: &mut Criterion, rows: &mut Vec<Row>) {
            let number = |x: f64| $Lanes::splat(x as $float);
            let point = |x: [f64; 3]| x.map(number);
            let lamp = |phase| AirLight {
                light: Light {
                    position: point([0.0, 3.0, 5.0]),
                    axis: point([0.0, 0.0, -1.0]),
                    intensity: Intensity::Isotropic,
                },
                phase,
                sigma_s: vec![number(0.1)],
                sigma_t: vec![number(0.12)],
            };
            let peaked = lamp(Phase::HenyeyGreenstein { g: number(0.7) });
            let even = lamp(Phase::Isotropic);
            let layers = [0.0, 0.0, 1.0, 0.0, 8.0].map(number);
            let layers = AnyProfile::from_values(Kind::Exponential, &layers);
            let fog = SunlitFog::new(layers, vec![number(0.1)], vec![number(0.12)]);
            let sun = point([0.6, 0.0, 0.8]);

            let rays: Vec<(Ray<$Lanes>, $Lanes)> = (0..N / $Lanes::COUNT)
                .map(|first| {
                    let at = |lane: usize| (first * $Lanes::COUNT + lane) as $float / N as $float;
                    let mu = $Lanes::gather(|lane| 1.8 * at(lane) - 0.9);
                    let ray = Ray {
                        origin: point([-4.0, 0.0, 1.0]),
                        direction: [(number(1.0) - mu * mu).sqrt(), number(0.0), mu],
                    };
                    (ray, $Lanes::gather(|lane| 5.0 + 10.0 * at(lane)))
                })
                .collect();
            let (start, phase) = (number(0.0), number(0.08));

            // Exponentials of the floor: two for each point on both sides of the foot; about one for each end
            // and function of the closed form.
            let mut row = |question: &str, exps: usize, ask: &dyn Fn(&Ray<$Lanes>, $Lanes)| {
                let name = format!("{} {question}", stringify!($float));
                let mut all = || rays.iter().for_each(|(ray, t)| ask(ray, *t));
                criterion.bench_function(&name, |b| b.iter(&mut all));
                let time = nanoseconds(&mut all);
                let least = nanoseconds(|| {
                    for (_, t) in &rays {
                        black_box((0..exps).fold(*t, |x, _| (-x).exp()));
                    }
                });
                rows.push((name, time, least));
            };
            for points in [8, 16, 24] {
                row(
                    &format!("airlight, {points} points"),
                    4 * points,
                    &|ray, t| {
                        let phase = &peaked.phase;
                        black_box(quadrature::radiance_by(
                            &peaked, phase, ray, start, t, points,
                        ));
                    },
                );
            }
            row("airlight, closed form", 12, &|ray, t| {
                let middle = Expansion::Midpoint;
                black_box(closed_form::radiance::<_, 1>(&even, middle, ray, start, t));
            });
            row("sunlit fog", 3, &|ray, t| {
                black_box(fog.radiance(ray, t, sun, phase).next());
            });
        }
    };
}

scattering!(bench_scattering_f32, f32, F32Lanes);
scattering!(bench_scattering_f64, f64, F64Lanes);

fn main() {
    let mut criterion = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(100))
        .measurement_time(std::time::Duration::from_millis(400))
        .configure_from_args();
    let mut rows = Vec::new();
    bench_f32(&mut criterion, &mut rows);
    bench_f64(&mut criterion, &mut rows);
    bench_scattering_f32(&mut criterion, &mut rows);
    bench_scattering_f64(&mut criterion, &mut rows);
    println!(
        "\n{:<32} {:>8} {:>8} {:>6}",
        "ns per ray", "query", "floor", "ratio"
    );
    for (name, time, floor) in rows {
        println!("{name:<32} {time:>8.2} {floor:>8.2} {:>6.2}", time / floor);
    }
    println!(
        "\n{:<30} {:>8} {:>8} {:>6} {:>8} {:>6}",
        "ns per ray", "column", "gradient", "ratio", "floor", "ratio"
    );
    gradients_f32();
    gradients_f64();
}
