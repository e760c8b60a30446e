//! What each formula costs: the transcendental operations, divisions and roots that a host
//! records for it.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::node::Node;
use analytic_media::sampling;
use common::host::Host;
use common::random::{Components, medium};

/// Number of exps, logs, square roots and divisions.
#[derive(Debug, PartialEq)]
struct Cost {
    exp: usize,
    log: usize,
    sqrt: usize,
    div: usize,
}

const FREE: Cost = Cost {
    exp: 0,
    log: 0,
    sqrt: 0,
    div: 0,
};

fn cost(record: impl FnOnce(&Host)) -> Cost {
    let host = Host::new(true);
    record(&host);
    let counts = host.counts();
    let count = |name| counts.get(name).copied().unwrap_or(0);
    Cost {
        exp: count("exp"),
        log: count("log"),
        sqrt: count("sqrt"),
        div: count("div"),
    }
}

/// The host has seen what it is about.
fn ignore(_: Node<'_>) {}

fn ray(host: &Host) -> Ray<Node<'_>> {
    let vector = |x: [f64; 3]| x.map(|x| host.input(x));
    Ray {
        origin: vector([0.0, 0.0, 1.0]),
        direction: vector([0.6, 0.0, 0.8]),
    }
}

/// Values of a profile; 1/H is recorded with the profile, so that one division is its own.
fn values(kind: Kind) -> Vec<f64> {
    let own: &[f64] = match kind {
        Kind::Constant => return vec![],
        Kind::Linear => &[-0.5, 1.0],
        Kind::Exponential => &[2.0],
        _ => unimplemented!("costs of {kind:?}"),
    };
    [&[0.0, 0.0, 1.0, 0.0], own].concat()
}

fn profile(host: &Host, kind: Kind) -> AnyProfile<Node<'_>> {
    let values: Vec<_> = values(kind).iter().map(|v| host.input(*v)).collect();
    AnyProfile::from_values(kind, &values)
}

#[test]
fn constant_costs_nothing() {
    let column = cost(|h| ignore(profile(h, Kind::Constant).column(&ray(h), h.input(3.0))));
    let inverse = cost(|h| ignore(profile(h, Kind::Constant).inv_column(&ray(h), h.input(3.0))));
    assert_eq!((column, inverse), (FREE, FREE));
}

#[test]
fn linear_costs_divisions_and_a_root() {
    let column = cost(|h| ignore(profile(h, Kind::Linear).column(&ray(h), h.input(3.0))));
    assert_eq!(column, Cost { div: 2, ..FREE });
    let inverse = cost(|h| ignore(profile(h, Kind::Linear).inv_column(&ray(h), h.input(3.0))));
    assert_eq!(
        inverse,
        Cost {
            div: 2,
            sqrt: 1,
            ..FREE
        }
    );
}

#[test]
fn exponential_costs_two_exps_and_its_inverse_two_logs() {
    fn exponential(host: &Host) -> AnyProfile<Node<'_>> {
        profile(host, Kind::Exponential)
    }
    let density = cost(|h| ignore(exponential(h).density(ray(h).origin)));
    assert_eq!(
        density,
        Cost {
            exp: 1,
            div: 1,
            ..FREE
        }
    );
    let column = cost(|h| ignore(exponential(h).column(&ray(h), h.input(3.0))));
    assert_eq!(
        column,
        Cost {
            exp: 2,
            div: 3,
            ..FREE
        }
    );
    let inverse = cost(|h| ignore(exponential(h).inv_column(&ray(h), h.input(3.0))));
    assert_eq!(
        inverse,
        Cost {
            exp: 1,
            log: 2,
            div: 6,
            ..FREE
        }
    );
    let bounds = cost(|h| ignore(exponential(h).bounds(&ray(h), h.input(3.0)).0));
    assert_eq!(
        bounds,
        Cost {
            exp: 2,
            div: 1,
            ..FREE
        }
    );
}

/// Channels share the columns: a spectrum costs no more exps than one number.
#[test]
fn channels_share_columns() {
    let host = Host::new(true);
    let grey = Kind::Exponential;
    let sigma_t = (0..3).map(|_| host.input(1.0)).collect();
    let medium = analytic_media::medium::Medium::new(vec![profile(&host, grey)], sigma_t);
    assert_eq!(
        medium.optical_depth(&ray(&host), host.input(3.0)).count(),
        3
    );
    assert_eq!(host.counts()["exp"], 2);
}

/// One component is inverted in closed form; a sum takes six steps, each of which needs the
/// column and the density of every component.
#[test]
fn free_flight_through_a_sum_costs_its_steps() {
    let flight = |components: Components| {
        cost(move |h| {
            let m = medium(&components, |x| h.input(x));
            let (endless, tau) = (h.input(f64::INFINITY), h.input(0.5));
            ignore(sampling::free_flight(&m, 0, &ray(h), endless, tau));
        })
    };
    let layer = (Kind::Exponential, values(Kind::Exponential), 0.2);
    let one = flight(vec![layer.clone()]);
    assert_eq!((one.exp, one.log), (1, 2));
    let two = flight(vec![layer.clone(), layer]);
    println!("sum of two: {two:?}");
    // Per component: τ(t_max), three inverses for the bracket, six steps and the last one.
    assert!(two.exp <= 2 * (2 + 3 + 6 * 3 + 3), "{two:?}");
    assert!(two.log <= 2 * 3 * 2 + 6 * 2, "{two:?}"); // and two per step of the solver
}
