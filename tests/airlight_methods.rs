//! How good the formulations of air-light are: the paper's as printed, our closed form, quadrature.
//!
//! `cargo test --test airlight_methods -- --nocapture` prints the tables of `docs/airlight.md`: the
//! paper's Figures 5 and 6 in numbers, and what error estimates are worth.
//!
//! Cases are the rows of airlight.json, and its one-lobed spots once more as cones, whose reference is
//! quadrature with 64 points between their edges. Nothing is expanded across an edge.

mod common;

use analytic_media::airlight::AirLight;
use analytic_media::airlight::closed_form::{self, Expansion};
use analytic_media::airlight::light::Intensity;
use analytic_media::airlight::published::{self, Form};
use analytic_media::airlight::quadrature;
use analytic_media::geometry::Ray;
use analytic_media::real::lanes::{F64Lanes, Lanes};
use common::host::Host;
use common::lamps::scene;
use common::rows::{number, table};
use serde_json::Value;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::sync::OnceLock;
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

/// A light in a medium, a segment of a ray, and the radiance.
struct Case {
    family: String,
    thickness: String,
    air: AirLight<f64>,
    ray: Ray<f64>,
    t0: f64,
    t1: f64,
    expected: f64,
}

impl Case {
    /// Whether a number in double precision can say how bright it is.
    fn is_lit(&self) -> bool {
        self.expected > 1e-290
    }
}

fn phase(row: &Value) -> &str {
    match row["phase"]["type"].as_str().expect("a phase has a type") {
        "hg" if number(&row["phase"]["g"]).abs() <= 0.5 => "HG |g| <= 0.5",
        "hg" => "HG |g| >= 0.75",
        other => other,
    }
}

fn family(row: &Value) -> String {
    let light = match (row["light"]["type"].as_str(), row["light"]["p"].as_u64()) {
        (Some("spot"), _) => "spot",
        (_, None) => "isotropic",
        (_, Some(2 | 4)) => "cos^2, cos^4",
        _ => "cos^8, cos^16",
    };
    format!("{}, {light}", phase(row))
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

fn case(row: &Value) -> Case {
    let (air, ray, t0, t1) = scene(row, |x| x);
    Case {
        family: family(row),
        thickness: thickness(row),
        air,
        ray,
        t0,
        t1,
        expected: number(&row["L"]),
    }
}

/// A spot as a cone; none where it leaves the segment dark.
fn cone(row: &Value) -> Option<Case> {
    let mut cone = case(row);
    cone.family = format!("{}, cone", phase(row));
    cone.air.light.intensity = Intensity::Cone {
        cutoff_angle: 1.2,
        beam_width: 0.7,
    };
    cone.expected = by_points(&cone, 64);
    Some(cone).filter(Case::is_lit)
}

/// All that are not dark, made once.
fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| {
        let rows = table("airlight");
        let spots = rows.iter().filter(|row| row["light"]["type"] == "spot");
        let own = rows.iter().map(case).filter(Case::is_lit);
        own.chain(spots.filter_map(cone)).collect()
    })
}

/// Relative error of a radiance.
fn error(case: &Case, radiance: f64) -> f64 {
    let error = (radiance - case.expected).abs() / case.expected;
    if error.is_nan() { f64::INFINITY } else { error }
}

/// Errors of `method` over all cases, by `group`.
fn errors(
    group: impl Fn(&Case) -> String,
    method: impl Fn(&Case) -> f64,
) -> BTreeMap<String, Group> {
    let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for case in cases() {
        let error = error(case, method(case));
        groups.entry(group(case)).or_default().push(error);
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

fn paper<const N: usize>(case: &Case, form: Form, expansion: Expansion) -> f64 {
    let segment = [case.t0, case.t1];
    published::radiance::<N>(&case.air, form, expansion, &case.ray, segment, N)[0]
}

fn ours<const N: usize>(case: &Case, expansion: Expansion) -> f64 {
    closed_form::radiance::<_, N>(&case.air, expansion, &case.ray, case.t0, case.t1)[0]
}

fn by_points(case: &Case, points: usize) -> f64 {
    let Case { air, ray, .. } = case;
    quadrature::radiance_by(air, &air.phase, ray, case.t0, case.t1, points)[0]
}

#[test]
fn table_of_methods() {
    use Expansion::{Fixed, Midpoint};
    type Key = fn(&Case) -> String;
    let family: Key = |case| case.family.clone();
    let thickness: Key = |case| case.thickness.clone();
    for (by, group) in [
        ("By phase function and light", family),
        ("By thickness", thickness),
    ] {
        print(
            &format!("{by}: the paper as printed"),
            &[
                (
                    "first, 4",
                    errors(group, |r| paper::<4>(r, Form::First, Fixed)),
                ),
                (
                    "first, 6",
                    errors(group, |r| paper::<6>(r, Form::First, Fixed)),
                ),
                (
                    "second, 6",
                    errors(group, |r| paper::<6>(r, Form::Second, Fixed)),
                ),
                (
                    "combined, fixed, 6",
                    errors(group, |r| paper::<6>(r, Form::Combined, Fixed)),
                ),
                (
                    "combined, midpoint, 6",
                    errors(group, |r| paper::<6>(r, Form::Combined, Midpoint)),
                ),
            ],
        );
        print(
            &format!("{by}: stable moments, and quadrature"),
            &[
                ("fixed, 6", errors(group, |r| ours::<6>(r, Fixed))),
                ("midpoint, 6", errors(group, |r| ours::<6>(r, Midpoint))),
                ("midpoint, 12", errors(group, |r| ours::<12>(r, Midpoint))),
                ("midpoint, 20", errors(group, |r| ours::<20>(r, Midpoint))),
                ("8 points", errors(group, |r| by_points(r, 8))),
                ("16 points", errors(group, |r| by_points(r, 16))),
                ("24 points", errors(group, |r| by_points(r, 24))),
                ("48 points", errors(group, |r| by_points(r, 48))),
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
fn nanoseconds(call: impl FnMut()) -> f64 {
    nanoseconds_of(200, call)
}

/// The same with so many calls in a run.
fn nanoseconds_of(calls: usize, mut call: impl FnMut()) -> f64 {
    let run = |call: &mut dyn FnMut()| {
        let start = Instant::now();
        for _ in 0..calls {
            call();
        }
        start.elapsed().as_nanos() as f64 / calls as f64
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
            terms!(20);
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
    assert_eq!(methods, 3 * 5 + 1 + 4 + 4);
}

/// Prints the error against the cost, of all cases.
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
    let one = |_: &Case| "all".to_string();
    let mut rows = 0;
    for points in [8, 16, 24, 32, 48] {
        let name = format!("quadrature, {points} points");
        rows = print(&name, errors(one, |r| by_points(r, points)));
    }
    let ours = [
        (
            "closed form, 4 terms",
            errors(one, |r| ours::<4>(r, Expansion::Midpoint)),
        ),
        (
            "closed form, 6 terms",
            errors(one, |r| ours::<6>(r, Expansion::Midpoint)),
        ),
        (
            "closed form, 12 terms",
            errors(one, |r| ours::<12>(r, Expansion::Midpoint)),
        ),
        (
            "closed form, 20 terms",
            errors(one, |r| ours::<20>(r, Expansion::Midpoint)),
        ),
        (
            "as printed, 4 terms",
            errors(one, |r| paper::<4>(r, Form::Combined, Expansion::Midpoint)),
        ),
        (
            "as printed, 6 terms",
            errors(one, |r| paper::<6>(r, Form::Combined, Expansion::Midpoint)),
        ),
    ];
    for (name, groups) in ours {
        assert_eq!(print(name, groups), rows);
    }
    assert_eq!(rows, cases().len());
}

/// What rounding does to the exponents of dark rows: no estimate knows of it.
const ROUNDING: f64 = 1e-11;

/// What estimates of the error are worth: how often they are above it, or both are
/// rounding.
#[test]
fn estimates_are_above_the_error() {
    println!("\n| method | estimates above the error | median of estimate over error |");
    let line = |name: &str, estimate: &dyn Fn(&Case) -> (f64, f64), least: f64| {
        let (mut above, mut ratios) = (0, Vec::new());
        for case in cases() {
            let (radiance, estimate) = estimate(case);
            let error = error(case, radiance);
            above += usize::from(estimate.max(ROUNDING) >= error);
            if error > ROUNDING {
                ratios.push(estimate / error);
            }
        }
        ratios.sort_by(f64::total_cmp);
        let share = above as f64 / cases().len() as f64;
        let median = ratios[ratios.len() / 2];
        println!("| {name} | {:.1} % | {median:.1} |", 100.0 * share);
        assert!(share >= least, "{name}: {share}");
    };
    for points in [8, 16, 24, 32, 48] {
        let by = |case: &Case| {
            let Case { air, ray, .. } = case;
            let estimate = air.radiance_estimated(ray, case.t0, case.t1, points);
            (estimate.radiance[0], estimate.error[0])
        };
        line(&format!("quadrature, {points} points"), &by, 0.93);
    }
    macro_rules! closed {
        ($($n:literal)*) => { $(
            let by = |case: &Case| {
                let Case { air, ray, .. } = case;
                let estimate = closed_form::estimate::<_, $n>(air, ray, case.t0, case.t1);
                (estimate.radiance[0], estimate.error[0])
            };
            line(concat!("closed form, ", $n, " terms"), &by, 0.89);
        )* };
    }
    closed!(4 6 12 20);
}

/// A tolerance is kept, at a cost that falls as it is loosened.
#[test]
fn tolerances_are_kept() {
    println!("\n| tolerance | kept | worst error | points, mean | ns, mean |");
    let mut costs = Vec::new();
    for tolerance in [1e-9, 1e-7, 1e-5, 1e-3] {
        let (mut points, mut worst, mut kept) = (0, 0.0f64, 0);
        for case in cases() {
            let Case { air, ray, .. } = case;
            let estimate = air.radiance_within(ray, case.t0, case.t1, tolerance);
            let error = error(case, estimate.radiance[0]);
            kept += usize::from(error <= tolerance);
            points += estimate.points;
            worst = worst.max(error);
        }
        let n = cases().len();
        let all = nanoseconds_of(1, || {
            for Case {
                air, ray, t0, t1, ..
            } in cases()
            {
                black_box(air.radiance_within(ray, *t0, *t1, black_box(tolerance)));
            }
        });
        println!(
            "| {tolerance:.0e} | {kept} of {n} | {worst:.0e} | {:.1} | {:.0} |",
            points as f64 / n as f64,
            all / n as f64
        );
        costs.push(points);
    }
    let all = nanoseconds_of(1, || {
        for Case {
            air, ray, t0, t1, ..
        } in cases()
        {
            black_box(air.radiance(ray, *t0, *t1));
        }
    });
    println!("| none | | | | {:.0} |", all / cases().len() as f64);
    assert!(costs.is_sorted_by(|a, b| a > b), "{costs:?}");
}
