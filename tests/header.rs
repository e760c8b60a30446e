//! The committed header is what cbindgen makes of the sources today.
//!
//! `AM_BLESS=1 cargo test --test header` rewrites it.

use std::path::Path;

#[test]
fn header_is_fresh() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml");
    // SAFETY: no other thread of this program reads the environment; the functions come out
    // of macros, and only a nightly compiler, or one told to be so, shows their expansion.
    unsafe { std::env::set_var("RUSTC_BOOTSTRAP", "1") };
    let bindings = cbindgen::Builder::new()
        .with_crate(root)
        .with_config(config)
        .generate()
        .expect("cbindgen understands the crate");
    let mut fresh = Vec::new();
    bindings.write(&mut fresh);
    let fresh = String::from_utf8(fresh).expect("a header is text");

    let path = root.join("include/analytic_media.h");
    if std::env::var_os("AM_BLESS").is_some() {
        std::fs::write(&path, &fresh).expect("the header can be written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == fresh,
        "include/analytic_media.h is stale: run AM_BLESS=1 cargo test --test header"
    );
}
