//! Rows of the reference tables, and the profiles in them.

use analytic_media::profile::Kind;
use serde_json::Value;

/// The rows of a table in `tests/reference`.
pub fn table(name: &str) -> Vec<Value> {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let table: Value = serde_json::from_str(&text).expect("a table is JSON");
    table["rows"].as_array().expect("a table has rows").clone()
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

/// Kind and parameter values of a profile of the tables; `None` if it is not built yet.
pub fn profile(value: &Value) -> Option<(Kind, Vec<f64>)> {
    let up = || point(&value["up"]).to_vec();
    match value["type"].as_str().expect("a profile has a type") {
        "constant" => Some((Kind::Constant, vec![])),
        "linear" => {
            let numbers = [0.0, number(&value["a"]), number(&value["k"])];
            Some((Kind::Linear, [up(), numbers.to_vec()].concat()))
        }
        "exponential" => {
            let numbers = [number(&value["h0"]), number(&value["H"])];
            Some((Kind::Exponential, [up(), numbers.to_vec()].concat()))
        }
        "sphere_tent" => {
            let numbers = ["R", "h_c", "w"].map(|name| number(&value[name]));
            Some((Kind::Tent, [&point(&value["c"])[..], &numbers].concat()))
        }
        "gaussian" => {
            let center = point(&value["c"]).to_vec();
            Some((Kind::Gaussian, [center, vec![number(&value["s"])]].concat()))
        }
        _ => None,
    }
}
