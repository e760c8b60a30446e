# The Rust core as two targets: analytic_media_static and analytic_media_shared.
#
# Cargo gets a target directory of its own below target/, so that its compiler flags and
# those of a plain `cargo test` never overwrite each other's files.

if(AM_MITSUBA_PLUGIN)
  # The wheel itself runs on nothing older than x86-64-v3, so the core may use AVX2 and FMA.
  set(default_cpu x86-64-v3)
else()
  set(default_cpu "")
endif()
set(AM_RUST_TARGET_CPU "${default_cpu}" CACHE STRING
    "rustc's target-cpu for the core; empty: the portable baseline of the target")

find_program(AM_CARGO cargo HINTS "$ENV{HOME}/.cargo/bin" REQUIRED)

if(AM_RUST_TARGET_CPU)
  set(rust_flags "-C target-cpu=${AM_RUST_TARGET_CPU}")
  set(cargo_target_dir "${PROJECT_SOURCE_DIR}/target/${AM_RUST_TARGET_CPU}")
else()
  set(rust_flags "")
  set(cargo_target_dir "${PROJECT_SOURCE_DIR}/target/portable")
endif()

# The shared object's name changes with every release that may break its C ABI.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(AM_SOVERSION "0.${PROJECT_VERSION_MINOR}")
else()
  set(AM_SOVERSION "${PROJECT_VERSION_MAJOR}")
endif()

set(AM_STATIC_LIBRARY "${cargo_target_dir}/release/libanalytic_media.a")
set(AM_SHARED_LIBRARY "${cargo_target_dir}/release/libanalytic_media.so")

file(GLOB_RECURSE rust_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.rs")

# Cargo leaves the files alone when nothing in them changes; touching them tells Ninja that
# they are up to date.
add_custom_command(
  OUTPUT "${AM_STATIC_LIBRARY}" "${AM_SHARED_LIBRARY}"
  COMMAND ${CMAKE_COMMAND} -E env "RUSTFLAGS=${rust_flags}"
          "${AM_CARGO}" rustc --release --locked --lib --target-dir "${cargo_target_dir}"
          -- -C "link-arg=-Wl,-soname,libanalytic_media.so.${AM_SOVERSION}"
  COMMAND ${CMAKE_COMMAND} -E touch "${AM_STATIC_LIBRARY}" "${AM_SHARED_LIBRARY}"
  DEPENDS ${rust_sources} "${PROJECT_SOURCE_DIR}/Cargo.toml" "${PROJECT_SOURCE_DIR}/Cargo.lock"
  WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
  COMMENT "Building the Rust core"
  VERBATIM)
add_custom_target(rust_core ALL DEPENDS "${AM_STATIC_LIBRARY}" "${AM_SHARED_LIBRARY}")

find_package(Threads REQUIRED)

add_library(analytic_media_static STATIC IMPORTED GLOBAL)
set_target_properties(analytic_media_static PROPERTIES IMPORTED_LOCATION "${AM_STATIC_LIBRARY}")
target_include_directories(analytic_media_static INTERFACE "${PROJECT_SOURCE_DIR}/include")
target_link_libraries(analytic_media_static INTERFACE Threads::Threads ${CMAKE_DL_LIBS} m)
add_dependencies(analytic_media_static rust_core)
