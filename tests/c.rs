//! The header and the library as programs in C99 and C++17 see them.
//!
//! Each program in `tests/c` is compiled with all warnings as errors, linked with the static
//! library that this test run has built, and must exit with 0; once more with the address and
//! undefined-behaviour sanitizers where the compiler has them.

use std::path::{Path, PathBuf};
use std::process::Command;

const C: &[&str] = &["-std=c99", "-D_POSIX_C_SOURCE=200809L"];
const CPP: &[&str] = &["-std=c++17"];
const WARNINGS: &[&str] = &["-Wall", "-Wextra", "-Wpedantic", "-Werror"];
const SANITIZERS: &[&str] = &[
    "-fsanitize=address,undefined",
    "-fno-sanitize-recover=all",
    "-g",
];
const SYSTEM_LIBRARIES: &[&str] = &["-lgcc_s", "-lpthread", "-lm", "-ldl"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The directory of this program, where cargo has put the library too.
fn build_dir() -> PathBuf {
    let program = std::env::current_exe().expect("this program has a path");
    program.parent().expect("a directory").to_path_buf()
}

fn library() -> PathBuf {
    let path = build_dir().join("libanalytic_media.a");
    assert!(path.exists(), "cargo should have built {}", path.display());
    path
}

/// The triple that this rustc compiles for.
fn host() -> String {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let output = Command::new(rustc).arg("-vV").output().expect("rustc runs");
    let text = String::from_utf8(output.stdout).expect("a version is text");
    let line = text.lines().find_map(|line| line.strip_prefix("host: "));
    line.expect("rustc names its host").to_string()
}

fn compiler(cpp: bool) -> Command {
    let host = host();
    let mut build = cc::Build::new();
    build
        .cargo_metadata(false)
        .target(&host)
        .host(&host)
        .opt_level(1)
        .cpp(cpp);
    build.get_compiler().to_command()
}

fn run(command: &mut Command) -> Result<(), String> {
    let program = command.get_program().to_os_string();
    let output = command.output().map_err(|e| format!("{program:?}: {e}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let failure = format!("{program:?}: {}: {text}", output.status);
    output.status.success().then_some(()).ok_or(failure)
}

/// Compiles and links `source` into `program`.
fn build(source: &Path, program: &Path, flags: &[&str]) -> Result<(), String> {
    let cpp = source.extension().is_some_and(|e| e == "cpp");
    let mut command = compiler(cpp);
    command
        .args(if cpp { CPP } else { C })
        .args(WARNINGS)
        .args(flags);
    command.arg("-I").arg(root().join("include"));
    command
        .arg("-I")
        .arg(root().join("tests/c"))
        .arg("-o")
        .arg(program)
        .arg(source);
    run(command.arg(library()).args(SYSTEM_LIBRARIES))
}

/// Builds and runs a program, plain and with sanitizers.
fn conforms(source: &str) {
    let source = root().join(source);
    let name = source
        .file_name()
        .expect("a file")
        .to_string_lossy()
        .replace('.', "_");
    let directory = build_dir().join("c");
    std::fs::create_dir_all(&directory).expect("the build directory is writable");

    let flags = if have_sanitizers(&directory) {
        [&[], SANITIZERS].to_vec()
    } else {
        vec![&[][..]]
    };
    for (i, flags) in flags.into_iter().enumerate() {
        let program = directory.join(format!("{name}_{i}"));
        let outcome =
            build(&source, &program, flags).and_then(|()| run(&mut Command::new(&program)));
        if let Err(message) = outcome {
            panic!("{message}");
        }
    }
}

/// Whether the compiler can build and run an empty program with them.
fn have_sanitizers(directory: &Path) -> bool {
    let id = std::thread::current().name().unwrap_or("test").to_string();
    let source = directory.join(format!("empty_{id}.c"));
    let program = directory.join(format!("empty_{id}"));
    std::fs::write(&source, "int main(void) { return 0; }\n").expect("writable");
    let built = run(compiler(false)
        .args(SANITIZERS)
        .arg("-o")
        .arg(&program)
        .arg(&source));
    built
        .and_then(|()| run(&mut Command::new(&program)))
        .is_ok()
}

#[test]
fn questions_have_known_answers() {
    conforms("tests/c/questions.c");
}

#[test]
fn gradients_have_known_answers() {
    conforms("tests/c/gradient.c");
}

#[test]
fn kinds_are_described_and_checked() {
    conforms("tests/c/describe.c");
}

#[test]
fn planets_have_altitudes_and_horizons() {
    conforms("tests/c/planet.c");
}

#[test]
fn special_functions_have_their_values() {
    conforms("tests/c/special.c");
}

#[test]
fn coefficients_have_their_values() {
    conforms("tests/c/coefficients.c");
}

#[test]
fn functions_of_spectra_have_their_values() {
    conforms("tests/c/spectral.c");
}

#[test]
fn airlight_has_its_values() {
    conforms("tests/c/airlight.c");
}

#[test]
fn fogs_in_the_sun_have_their_values() {
    conforms("tests/c/sunlit.c");
}

#[test]
fn recorded_questions_have_the_same_answers() {
    conforms("tests/c/record.c");
}

#[test]
fn errors_stay_in_their_thread() {
    conforms("tests/c/threads.c");
}

#[test]
fn wrapper_throws_and_computes() {
    conforms("tests/c/wrapper.cpp");
}

#[test]
fn header_serves_cpp() {
    conforms("tests/c/header.cpp");
}

#[test]
fn first_example_runs() {
    conforms("examples/first_column.c");
}

/// Every function of the header is called by a program.
#[test]
fn no_function_is_forgotten() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).expect(path);
    let header = read("include/analytic_media.h");
    let tests: String = [
        "questions.h",
        "questions.c",
        "gradient.c",
        "describe.c",
        "record.c",
        "planet.c",
        "airlight.c",
        "spectral.c",
        "sunlit.c",
        "check.h",
    ]
    .map(|name| read(&format!("tests/c/{name}")))
    .concat();
    let functions_of_numbers = read("tests/c/special.c") + &read("tests/c/coefficients.c");
    let functions = header
        .split("am_")
        .skip(1)
        .filter_map(|rest| rest.split_once('('));
    let functions: Vec<_> = functions
        .map(|(name, _)| name)
        .filter(|name| name.chars().all(|c| c.is_alphanumeric() || c == '_'))
        .collect();
    assert!(functions.len() >= 327, "the header declares functions");
    for name in functions {
        // The tests paste the forms to the name of the question.
        let forms = [
            "_record",
            "_batch_f64",
            "_batch_f32",
            "_f64",
            "_f32",
            "_in_box",
        ];
        let question = forms
            .iter()
            .fold(name, |name, form| name.strip_suffix(form).unwrap_or(name));
        // Those of functions of numbers include the recorded form.
        let function = question.trim_end_matches("_record");
        let called =
            tests.contains(question) || functions_of_numbers.contains(&format!("({function}, "));
        assert!(called, "am_{name} is called by a program");
    }
}

/// The C ABI turns panics into a status: an abort would take the host with it.
#[test]
fn release_profile_unwinds() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("Cargo.toml");
    let release = manifest
        .split("[profile.release]")
        .nth(1)
        .expect("a release profile");
    let release = release.split("\n[").next().expect("a section");
    assert!(release.contains("panic = \"unwind\""));
    const { assert!(cfg!(panic = "unwind"), "and so does this build") };
}
