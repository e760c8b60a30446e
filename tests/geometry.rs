//! Altitudes, and rays past a planet: single against double precision at planet scale.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::geometry::planet::Sphere;
use analytic_media::real::Real;
use common::random::{Random, ray};

/// A planet with the origin of coordinates on its surface, and its lengths in single precision.
fn planet(radius: f64) -> Sphere<f64> {
    Sphere {
        center: [0.0, 0.0, -radius],
        radius,
    }
}

fn single(sphere: &Sphere<f64>) -> Sphere<f32> {
    Sphere {
        center: sphere.center.map(|x| x as f32),
        radius: sphere.radius as f32,
    }
}

/// A ray that single precision holds exactly: from up to `extent` of the origin and between
/// `low` and `high` above the surface.
fn exact_ray(random: &mut Random, radius: f64, extent: f64, (low, high): (f64, f64)) -> Ray<f64> {
    let (x, y) = (
        random.between(-extent, extent),
        random.between(-extent, extent),
    );
    let r = radius + random.magnitude(low, high);
    let drop = (x * x + y * y) / (r + (r * r - x * x - y * y).sqrt());
    let origin = [x, y, r - radius - drop];
    let direction = random.ray(1.0).direction;
    let exact = |x: f64| f64::from(x as f32);
    Ray {
        origin: origin.map(exact),
        direction: direction.map(exact),
    }
}

const METRE: f64 = 1e-3;

/// Within 1000 km of the origin single precision knows an altitude to a few ulps of itself,
/// plus what 1e-7 of the drop of the surface is.
#[test]
fn altitudes_near_the_origin_keep_their_digits() {
    for (radius, unit) in [(6371.0, 1.0), (6_371_000.0, 1000.0), (3389.5, 1.0)] {
        let sphere = planet(radius);
        let mut random = Random::with_seed(1);
        for _ in 0..20_000 {
            let extent = random.magnitude(METRE, 1000.0) * unit;
            let heights = (METRE * unit, 1000.0 * unit);
            let ray = exact_ray(&mut random, radius, extent, heights);
            let exact = sphere.altitude(ray.origin);
            let got = f64::from(single(&sphere).altitude(ray.origin.map(|x| x as f32)));
            let drop = 2.0 * extent * extent / radius;
            let error = (got - exact).abs();
            assert!(
                error <= 4e-7 * exact.abs() + 1.2e-7 * drop,
                "{got} {exact} {ray:?}"
            );
        }
    }
}

/// Climbs along a ray keep their digits, too, up to what one rounding of the direction does.
#[test]
fn climbs_keep_their_digits() {
    let sphere = planet(6371.0);
    let mut random = Random::with_seed(2);
    for _ in 0..50_000 {
        let ray = exact_ray(&mut random, 6371.0, 100.0, (METRE, 500.0));
        let t = f64::from(random.magnitude(1e-6, 1e5) as f32);
        let passage = sphere.passage(&ray);
        let single_passage = single(&sphere).passage(&common::random::ray(&ray, |x| x as f32));
        let (exact, got) = (passage.rise(t), f64::from(single_passage.rise(t as f32)));
        assert!(
            (got - exact).abs() <= 4e-7 * (exact.abs() + t.min(passage.along.abs())),
            "{got} {exact} t {t} {ray:?}"
        );
        let (exact, got) = (passage.depth(), f64::from(single_passage.depth()));
        assert!(
            (got - exact).abs() <= 8e-7 * (exact + passage.along.abs()),
            "{got} {exact} {ray:?}"
        );
    }
}

/// The altitude of a point of the ray is the altitude of the start plus the climb.
#[test]
fn a_climb_is_a_difference_of_altitudes() {
    let mut random = Random::with_seed(3);
    for _ in 0..20_000 {
        let center = std::array::from_fn(|_| random.between(-1e4, 1e4));
        let radius = random.magnitude(1.0, 1e4);
        let sphere = Sphere { center, radius };
        let ray = random.ray(1e4);
        let t = random.magnitude(1e-3, 1e5);
        let passage = sphere.passage(&ray);
        let end = sphere.altitude(ray.at(t));
        let got = passage.altitude + passage.rise(t);
        assert!(
            (got - end).abs() <= 1e-15 * (6e4 + 3.0 * t),
            "{got} {end} {t}"
        );
        let perigee = sphere.altitude(ray.at((-passage.along).max(0.0)));
        if passage.along < 0.0 {
            let got = passage.altitude - passage.depth();
            assert!((got - perigee).abs() <= 1e-10, "{got} {perigee}");
            assert!((got - (passage.perigee - radius)).abs() <= 1e-10);
        }
    }
}

/// Bounds of altitude hold for every point of segments and boxes, and are tight.
fn check_ranges<R: Real + PartialOrd + Into<f64>>(lift: impl Fn(f64) -> R, slack: f64) {
    let mut random = Random::with_seed(4);
    for _ in 0..5000 {
        let radius = random.magnitude(1.0, 1e4);
        let center = match random.index(3) {
            0 => [0.0; 3],
            1 => [0.0, 0.0, -radius],
            _ => std::array::from_fn(|_| random.between(-1e4, 1e4)),
        };
        let extent = random.magnitude(1e-2, 1e5);
        let double = random.ray(extent);
        let length = random.magnitude(1e-3, 1e5);
        let sphere = Sphere {
            center: center.map(&lift),
            radius: lift(radius),
        };
        let ray = ray(&double, &lift);
        let t = lift(length);
        let (low, high) = sphere.range(&ray, t);
        let far = ray.at(t);
        let lo = std::array::from_fn(|i| ray.origin[i].min(far[i]));
        let hi = std::array::from_fn(|i| ray.origin[i].max(far[i]));
        let (box_low, box_high) = sphere.range_in_box(lo, hi);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let perigee = (-sphere.passage(&ray).along).max(lift(0.0)).min(t);
        for i in 0..=33 {
            let s = if i == 33 {
                perigee
            } else {
                t * lift(f64::from(i) / 32.0)
            };
            let altitude = sphere.altitude(ray.at(s));
            assert!(
                low <= altitude && altitude <= high,
                "{altitude:?} {low:?} {high:?}"
            );
            assert!(box_low <= altitude && altitude <= box_high);
            least = least.min(altitude.into());
            most = most.max(altitude.into());
        }
        let magnitude = 4.0 * extent + 1e4 + length;
        let magnitude = magnitude + center.iter().map(|x| x.abs()).sum::<f64>();
        let (low, high): (f64, f64) = (low.into(), high.into());
        assert!(least - low <= slack * magnitude, "{least} {low}");
        assert!(high - most <= slack * magnitude, "{most} {high}");
    }
}

#[test]
fn ranges_are_bounds_and_tight() {
    check_ranges(|x| x, 8e-15);
    check_ranges(|x| x as f32, 4e-6);
}

#[test]
fn boxes_around_the_planet_and_without_end() {
    let sphere = planet(100.0);
    let (low, high) = sphere.range_in_box([-200.0; 3], [200.0; 3]);
    assert_eq!(low, -100.0);
    let corner = (2.0f64 * 200.0 * 200.0 + 300.0 * 300.0).sqrt() - 100.0;
    assert!((high - corner).abs() < 1e-11, "{high} {corner}");
    let above = [f64::NEG_INFINITY, f64::NEG_INFINITY, 3.0];
    let (low, high) = sphere.range_in_box(above, [f64::INFINITY; 3]);
    assert!((low - 3.0).abs() < 1e-12, "{low}");
    assert_eq!(high, f64::INFINITY);
    let (_, high) = sphere.range(
        &Ray::<f64>::new(glam::DVec3::ZERO, glam::DVec3::NEG_Z),
        f64::INFINITY,
    );
    assert_eq!(high, f64::INFINITY);
}

/// Where rays meet the ground and the top of the atmosphere, to what one rounding of the
/// coordinates does to it. Rays are lowered until they graze.
#[test]
fn crossings_keep_their_digits() {
    let (sphere, top) = (planet(6371.0), 100.0);
    let mut random = Random::with_seed(5);
    let mut met = [0; 2];
    for _ in 0..100_000 {
        let ray = exact_ray(&mut random, 6371.0, 100.0, (METRE, 90.0));
        let rounded = common::random::ray(&ray, |x| x as f32);
        let half = |altitude: f64| {
            let passage = sphere.passage(&ray);
            let (inwards, outwards, _) = passage.crossings(altitude);
            (outwards - inwards) / 2.0
        };
        // A crossing moves by δr · r/X: by metres at a grazing angle.
        let moves = |altitude: f64| 4e-7 * (100.0 + 6371.0 * 100.0 / half(altitude));
        let (enter, exit) = sphere.shell(&ray, top);
        let (got_enter, got_exit) = single(&sphere).shell(&rounded, top as f32);
        assert_eq!((enter, got_enter), (0.0, 0.0));
        let error = (f64::from(got_exit) / exit - 1.0).abs();
        assert!(error <= 2e-6, "{got_exit} {exit} {ray:?}");
        met[0] += 1;

        let (exact, got) = (sphere.hit(&ray), f64::from(single(&sphere).hit(&rounded)));
        if exact.is_finite() && half(0.0) > 10.0 {
            assert!((got - exact).abs() <= moves(0.0), "{got} {exact} {ray:?}");
            let altitude = sphere.altitude(ray.at(exact));
            // Directions are unit vectors to single precision.
            assert!(altitude.abs() < 2e-7 * exact, "{altitude} at {exact}");
            met[1] += 1;
        }
    }
    assert!(met[1] > 10_000, "{met:?}");
}

/// The horizon parts the rays that hit the planet from those that do not.
#[test]
fn the_horizon_parts_rays() {
    let sphere = planet(6371.0);
    for altitude in [1e-6, 1e-3, 1.0, 400.0, 1e6] {
        let point = [0.0, 0.0, altitude];
        let mu = sphere.horizon(point);
        let expected = -(1.0 - (6371.0f64 / (6371.0 + altitude)).powi(2)).sqrt();
        assert!((mu / expected - 1.0).abs() < 1e-6, "{mu} {expected}");
        let got = f64::from(single(&sphere).horizon(point.map(|x| x as f32)));
        assert!((got / mu - 1.0).abs() < 4e-7, "{got} {mu}");
        for (factor, hits) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
            let cosine = (mu * factor).max(-1.0);
            let direction = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
            let ray = Ray {
                origin: point,
                direction,
            };
            assert_eq!(sphere.hit(&ray).is_finite(), hits, "{altitude} {factor}");
        }
    }
    assert!(sphere.horizon([0.0, 0.0, -1.0]).abs() < 1e-100);
}

#[test]
fn rays_from_the_ground_and_from_space() {
    let sphere = planet(100.0);
    let from = |z: f64, down: bool| Ray {
        origin: [0.0, 0.0, z],
        direction: [0.0, 0.0, if down { -1.0 } else { 1.0 }],
    };
    assert_eq!(sphere.hit(&from(0.0, false)), f64::INFINITY);
    assert_eq!(sphere.hit(&from(-1.0, false)), f64::INFINITY);
    assert_eq!(sphere.hit(&from(0.0, true)), 0.0);
    assert_eq!(sphere.hit(&from(-1.0, true)), 0.0);
    assert_eq!(sphere.hit(&from(5.0, true)), 5.0);
    assert_eq!(sphere.shell(&from(50.0, true), 20.0), (30.0, 270.0));
    assert_eq!(
        sphere.shell(&from(50.0, false), 20.0),
        (f64::INFINITY, f64::INFINITY)
    );
    assert_eq!(sphere.shell(&from(5.0, false), 20.0), (0.0, 15.0));
    let far = f64::INFINITY;
    assert_eq!(sphere.shell(&from(5.0, false), -200.0), (far, far));
}
