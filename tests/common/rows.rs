//! Rows of the reference tables, and the profiles in them.

use analytic_media::profile::Kind;
use serde_json::Value;

/// The rows of a table in `tests/reference`, as many as it says.
pub fn table(name: &str) -> Vec<Value> {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let table: Value = serde_json::from_str(&text).expect("a table is JSON");
    let rows = table["rows"].as_array().expect("a table has rows").clone();
    assert_eq!(table["count"], rows.len(), "{path} is cut off");
    rows
}

/// The regime of a row without the name of the planet.
pub fn regime(row: &Value) -> String {
    let tag = row["regime"].as_str().expect("a row has a regime");
    let named = |part: &&str| !["earth", "mars", "titan", "moonlet", "small"].contains(part);
    tag.split('_').filter(named).collect::<Vec<_>>().join(" ")
}

/// A number, or the string "inf".
pub fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().expect("a decimal number"),
        _ => value.as_f64().expect("a number"),
    }
}

pub fn point(value: &Value) -> [f64; 3] {
    std::array::from_fn(|i| number(&value[i]))
}

/// Kind and parameter values of a profile of the tables.
pub fn profile(value: &Value) -> (Kind, Vec<f64>) {
    let up = || point(&value["up"]).to_vec();
    let center = || point(&value["c"]).to_vec();
    let numbers =
        |names: &[&str]| -> Vec<f64> { names.iter().map(|n| number(&value[n])).collect() };
    match value["type"].as_str().expect("a profile has a type") {
        "constant" => (Kind::Constant, vec![]),
        "linear" => (
            Kind::Linear,
            [up(), vec![0.0], numbers(&["a", "k"])].concat(),
        ),
        "exponential" => (Kind::Exponential, [up(), numbers(&["h0", "H"])].concat()),
        "sphere_exp" => (Kind::Spherical, [center(), numbers(&["R", "H"])].concat()),
        "sphere_tent" => (Kind::Tent, [center(), numbers(&["R", "h_c", "w"])].concat()),
        "gaussian" => (Kind::Gaussian, [center(), numbers(&["s"])].concat()),
        other => panic!("{other} is not a profile of the tables"),
    }
}
