//! How good the formulations of air-light are: the paper's as printed, our closed form, quadrature.
//!
//! `cargo test --test airlight_methods -- --nocapture` prints the tables of `docs/airlight.md`: the
//! paper's Figures 5 and 6 in numbers. Spots of one lobe are left out, since the paper expands across
//! their edge.

mod common;

use analytic_media::airlight::closed_form::{self, Expansion};
use analytic_media::airlight::quadrature;
use analytic_media::real::lanes::{F64Lanes, Lanes};
use common::host::Host;
use common::lamps::scene;
use common::paper::{Form, Paper};
use common::rows::{number, table};
use serde_json::Value;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

/// Relative errors of the rows of a group, sorted.
struct Group(Vec<f64>);

impl Group {
    fn worst(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }
    fn median(&self) -> f64 {
        self.0[self.0.len() / 2]
    }
}

fn family(row: &Value) -> String {
    let phase = match row["phase"]["type"].as_str() {
        Some("hg") if number(&row["phase"]["g"]).abs() <= 0.5 => "HG |g| <= 0.5",
        Some("hg") => "HG |g| >= 0.75",
        Some(other) => other,
        None => "none",
    };
    let light = match row["light"]["p"].as_u64() {
        None => "isotropic",
        Some(2 | 4) => "cos^2, cos^4",
        Some(_) => "cos^8, cos^16",
    };
    format!("{phase}, {light}")
}

fn thickness(row: &Value) -> String {
    let tag = row["regime"].as_str().expect("a row has a regime");
    let short = if tag.contains("tiny") {
        ", short segments"
    } else {
        ""
    };
    let head = tag.split('_').next().expect("a tag has parts");
    format!("{head}{short}")
}

/// Errors of `method` over the table, by `group`.
fn errors(
    group: fn(&Value) -> String,
    select: impl Fn(&Value) -> bool,
    method: impl Fn(&Value) -> f64,
) -> BTreeMap<String, Group> {
    let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for row in table("airlight")
        .iter()
        .filter(|row| row["light"]["type"] != "spot" && select(row))
    {
        let expected = number(&row["L"]);
        let error = (method(row) - expected).abs() / expected;
        let error = if error.is_nan() { f64::INFINITY } else { error };
        groups.entry(group(row)).or_default().push(error);
    }
    let sorted = |mut errors: Vec<f64>| {
        errors.sort_by(f64::total_cmp);
        Group(errors)
    };
    groups
        .into_iter()
        .map(|(name, errors)| (name, sorted(errors)))
        .collect()
}

fn print(title: &str, columns: &[(&str, BTreeMap<String, Group>)]) {
    println!("\n{title} (worst, median)");
    let heads: Vec<_> = columns.iter().map(|(name, _)| *name).collect();
    println!("| | rows | {} |", heads.join(" | "));
    for (name, first) in &columns[0].1 {
        let cells: Vec<String> = columns
            .iter()
            .map(|(_, groups)| {
                format!(
                    "{:.0e}, {:.0e}",
                    groups[name].worst(),
                    groups[name].median()
                )
            })
            .collect();
        println!("| {name} | {} | {} |", first.0.len(), cells.join(" | "));
    }
}

fn paper<const N: usize>(row: &Value, form: Form, expansion: Expansion) -> f64 {
    let (air, ray, from, to) = scene(row, |x| x);
    Paper { air, ray, from, to }.radiance::<N>(form, expansion)
}

fn ours<const N: usize>(row: &Value, expansion: Expansion) -> f64 {
    let (air, ray, t0, t1) = scene(row, |x| x);
    closed_form::radiance::<_, N>(&air, expansion, &ray, t0, t1)[0]
}

fn by_points(row: &Value, points: usize) -> f64 {
    let (air, ray, t0, t1) = scene(row, |x| x);
    quadrature::radiance_by(&air, &air.phase, &ray, t0, t1, points)[0]
}

#[test]
fn table_of_methods() {
    use Expansion::{Fixed, Midpoint};
    let all = |_: &Value| true;
    for (by, group) in [
        (
            "By phase function and light",
            family as fn(&Value) -> String,
        ),
        ("By thickness", thickness),
    ] {
        print(
            &format!("{by}: the paper as printed"),
            &[
                (
                    "first, 4",
                    errors(group, all, |r| paper::<4>(r, Form::First, Fixed)),
                ),
                (
                    "first, 6",
                    errors(group, all, |r| paper::<6>(r, Form::First, Fixed)),
                ),
                (
                    "second, 6",
                    errors(group, all, |r| paper::<6>(r, Form::Second, Fixed)),
                ),
                (
                    "combined, fixed, 6",
                    errors(group, all, |r| paper::<6>(r, Form::Combined, Fixed)),
                ),
                (
                    "combined, midpoint, 6",
                    errors(group, all, |r| paper::<6>(r, Form::Combined, Midpoint)),
                ),
            ],
        );
        print(
            &format!("{by}: stable moments, and quadrature"),
            &[
                ("fixed, 6", errors(group, all, |r| ours::<6>(r, Fixed))),
                (
                    "midpoint, 6",
                    errors(group, all, |r| ours::<6>(r, Midpoint)),
                ),
                (
                    "midpoint, 12",
                    errors(group, all, |r| ours::<12>(r, Midpoint)),
                ),
                (
                    "midpoint, 20",
                    errors(group, all, |r| ours::<20>(r, Midpoint)),
                ),
                ("8 points", errors(group, all, |r| by_points(r, 8))),
                ("16 points", errors(group, all, |r| by_points(r, 16))),
                ("24 points", errors(group, all, |r| by_points(r, 24))),
                ("48 points", errors(group, all, |r| by_points(r, 48))),
            ],
        );
    }
}

/// Operations of a recording, without literals and inputs, and exponentials and logarithms of them.
fn operations(recording: impl Fn(&Host)) -> (usize, usize) {
    let host = Host::new(false);
    recording(&host);
    let counts = host.counts();
    let all = counts
        .iter()
        .filter(|(name, _)| !["input", "literal"].contains(*name));
    let count = |name: &str| counts.get(name).copied().unwrap_or(0);
    (all.map(|(_, n)| n).sum(), count("exp") + count("log"))
}

/// Nanoseconds of a call, the least of several runs.
fn nanoseconds(mut call: impl FnMut()) -> f64 {
    let run = |call: &mut dyn FnMut()| {
        let start = Instant::now();
        for _ in 0..200 {
            call();
        }
        start.elapsed().as_nanos() as f64 / 200.0
    };
    (0..20)
        .map(|_| run(&mut call))
        .fold(f64::INFINITY, f64::min)
}

/// Prints what a ray costs. It asserts only that every method has been counted: times depend on the
/// machine.
#[test]
fn table_of_costs() {
    let rows = table("airlight");
    let find = |regime: &str| {
        rows.iter()
            .find(|row| row["regime"] == regime)
            .expect(regime)
    };
    println!("\n| method | operations | exp, log | ns f64, one channel |");
    let mut methods = 0;
    for (name, regime) in [
        ("isotropic", "mid_both_inf_isotropic_isotropic"),
        ("Rayleigh", "mid_both_inf_rayleigh_isotropic"),
        ("HG", "mid_both_inf_hg_isotropic"),
    ] {
        let row = find(regime);
        let (air, ray, t0, t1) = scene(row, |x| x);
        for points in [8, 16, 24, 32, 48] {
            let (all, exp) = operations(|host| {
                let (air, ray, t0, t1) = scene(row, |x| host.input(x));
                quadrature::radiance_by(&air, &air.phase, &ray, t0, t1, points);
            });
            let ns = nanoseconds(|| {
                black_box(quadrature::radiance_by(
                    black_box(&air),
                    &air.phase,
                    &ray,
                    t0,
                    t1,
                    points,
                ));
            });
            println!("| {name}, {points} points | {all} | {exp} | {ns:.0} |");
            methods += usize::from(all > 0);
        }
        let closed = |n: usize, all: usize, exp: usize, ns: f64| {
            println!("| {name}, closed form, {n} terms | {all} | {exp} | {ns:.0} |");
            usize::from(all > 0)
        };
        macro_rules! terms {
            ($n:literal) => {
                let (all, exp) = operations(|host| {
                    let (air, ray, t0, t1) = scene(row, |x| host.input(x));
                    closed_form::radiance::<_, $n>(&air, Expansion::Midpoint, &ray, t0, t1);
                });
                let ns = nanoseconds(|| {
                    let air = black_box(&air);
                    black_box(closed_form::radiance::<_, $n>(
                        air,
                        Expansion::Midpoint,
                        &ray,
                        t0,
                        t1,
                    ));
                });
                methods += closed($n, all, exp, ns);
            };
        }
        if name == "isotropic" {
            terms!(1);
        } else {
            terms!(4);
            terms!(6);
            terms!(12);
        }
    }
    // Lanes whose rays differ, so that they need several regimes of Ei.
    let row = find("mid_both_inf_isotropic_isotropic");
    let spread = |x: f64| F64Lanes::gather(|lane| x * (1.0 + 0.4 * lane as f64));
    let (air, ray, t0, t1) = scene(row, |x| {
        if x == 1.0 {
            F64Lanes::splat(x)
        } else {
            spread(x)
        }
    });
    let per_ray = |call: &mut dyn FnMut()| nanoseconds(call) / F64Lanes::COUNT as f64;
    let rule = per_ray(&mut || {
        black_box(quadrature::radiance(
            black_box(&air),
            &air.phase,
            &ray,
            t0,
            t1,
        ));
    });
    let closed = per_ray(&mut || {
        let air = black_box(&air);
        black_box(closed_form::radiance::<_, 1>(
            air,
            Expansion::Midpoint,
            &ray,
            t0,
            t1,
        ));
    });
    println!(
        "| isotropic, f64 lanes, per ray | 48 points {rule:.0} ns | closed form {closed:.0} ns |"
    );
    assert_eq!(methods, 3 * 5 + 1 + 3 + 3);
}

/// Prints the error against the cost: all rows but spots.
#[test]
fn table_of_error_against_cost() {
    let print = |name: &str, groups: BTreeMap<String, Group>| {
        let Group(all) = &groups["all"];
        let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
        let (half, most, worst) = (at(0.5), at(0.9), at(1.0));
        println!("| {name} | {half:.0e} | {most:.0e} | {worst:.0e} |");
        all.len()
    };
    println!("\n| method | half of the rows | nine in ten | all |");
    let one = |_: &Value| "all".to_string();
    let all = |_: &Value| true;
    let mut rows = 0;
    for points in [8, 16, 24, 32, 48] {
        let name = format!("quadrature, {points} points");
        rows = print(&name, errors(one, all, |r| by_points(r, points)));
    }
    let ours = [
        (
            "closed form, 4 terms",
            errors(one, all, |r| ours::<4>(r, Expansion::Midpoint)),
        ),
        (
            "closed form, 6 terms",
            errors(one, all, |r| ours::<6>(r, Expansion::Midpoint)),
        ),
        (
            "closed form, 12 terms",
            errors(one, all, |r| ours::<12>(r, Expansion::Midpoint)),
        ),
        (
            "as printed, 4 terms",
            errors(one, all, |r| {
                paper::<4>(r, Form::Combined, Expansion::Midpoint)
            }),
        ),
        (
            "as printed, 6 terms",
            errors(one, all, |r| {
                paper::<6>(r, Form::Combined, Expansion::Midpoint)
            }),
        ),
    ];
    for (name, groups) in ours {
        assert_eq!(print(name, groups), rows);
    }
    assert_eq!(rows, 298);
}

/// What the error estimate of `radiance_within` is worth, and how many points it takes.
#[test]
fn estimates_bound_the_error() {
    println!("\n| tolerance | mean points | worst error |");
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
        let (mut points, mut worst, mut n) = (0, 0.0f64, 0);
        for row in table("airlight") {
            let (air, ray, t0, t1) = scene(&row, |x| x);
            let estimate = quadrature::radiance_within(&air, &ray, t0, t1, tolerance);
            let expected = number(&row["L"]);
            if expected < 1e-290 {
                continue;
            }
            let error = (estimate.radiance[0] - expected).abs() / expected;
            assert!(
                error <= tolerance.max(1e-9),
                "{error:e} by {estimate:?}: {row}"
            );
            points += estimate.points;
            worst = worst.max(error);
            n += 1;
        }
        println!(
            "| {tolerance:.0e} | {:.1} | {worst:.0e} |",
            points as f64 / f64::from(n)
        );
    }
}
