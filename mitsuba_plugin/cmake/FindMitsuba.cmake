# Finds Mitsuba 3 as installed by pip, through the Python interpreter that has it.
#
# Defines
#   Mitsuba::Mitsuba     headers, libraries, and the flags that its binary interface depends on
#   Mitsuba_VERSION      version of the wheel
#   Mitsuba_VARIANTS     names of the variants the wheel holds
#   Mitsuba_TYPES_<v>    "Float, Spectrum" of variant <v>, as C++ inside namespace mitsuba

find_package(Python COMPONENTS Interpreter REQUIRED)

execute_process(
  COMMAND "${Python_EXECUTABLE}" -c [[
from importlib.metadata import version
from importlib.util import find_spec
for package in ("mitsuba", "drjit", "nanobind"):
    print(find_spec(package).submodule_search_locations[0])
print(version("mitsuba"))
]]
  OUTPUT_VARIABLE output
  ERROR_VARIABLE error
  RESULT_VARIABLE status
  OUTPUT_STRIP_TRAILING_WHITESPACE)

if(status EQUAL 0)
  string(REPLACE "\n" ";" output "${output}")
  list(GET output 0 mitsuba_dir)
  list(GET output 1 drjit_dir)
  list(GET output 2 nanobind_dir)
  list(GET output 3 Mitsuba_VERSION)
  find_library(Mitsuba_LIBRARY mitsuba PATHS "${mitsuba_dir}" NO_DEFAULT_PATH NO_CACHE)
  set(config_header "${mitsuba_dir}/include/mitsuba/core/config.h")
else()
  set(reason "${Python_EXECUTABLE} cannot import mitsuba, drjit and nanobind:\n${error}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Mitsuba
  REQUIRED_VARS Mitsuba_LIBRARY mitsuba_dir drjit_dir nanobind_dir
  VERSION_VAR Mitsuba_VERSION
  REASON_FAILURE_MESSAGE "${reason}")

if(NOT CMAKE_SYSTEM_NAME STREQUAL Linux OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  message(FATAL_ERROR "The plugin knows the binary interface of Mitsuba's x86-64 Linux wheels "
                      "only, not of ${CMAKE_SYSTEM_NAME} on ${CMAKE_SYSTEM_PROCESSOR}.")
endif()

# config.h dispatches over the variants: if (variant == "name") return func<Float, Spectrum>(...);
file(READ "${config_header}" config)
string(REGEX MATCHALL "variant == \"[a-z_]+\"\\)[^;]*func<[^;]*>\\(__VA_ARGS__\\)" branches "${config}")
set(Mitsuba_VARIANTS "")
foreach(branch IN LISTS branches)
  string(REGEX MATCH "variant == \"([a-z_]+)\".*func<(.*)>\\(" _ "${branch}")
  list(APPEND Mitsuba_VARIANTS "${CMAKE_MATCH_1}")
  set(Mitsuba_TYPES_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
endforeach()
if(NOT Mitsuba_VARIANTS)
  message(FATAL_ERROR "No variants found in ${config_header}")
endif()

if(NOT TARGET Mitsuba::Mitsuba)
  add_library(Mitsuba::Mitsuba INTERFACE IMPORTED)
  target_include_directories(Mitsuba::Mitsuba SYSTEM INTERFACE
    "${mitsuba_dir}/include"
    "${drjit_dir}/include"
    "${nanobind_dir}/include"
    "${nanobind_dir}/ext/robin_map/include")
  target_link_libraries(Mitsuba::Mitsuba INTERFACE
    "${Mitsuba_LIBRARY}" "${drjit_dir}/libdrjit-core.so" "${drjit_dir}/libdrjit-extra.so")
  target_link_options(Mitsuba::Mitsuba INTERFACE
    "LINKER:-rpath-link,${mitsuba_dir}:${drjit_dir}")
  target_compile_definitions(Mitsuba::Mitsuba INTERFACE
    MI_ENABLE_LLVM=1 MI_ENABLE_CUDA=1 MI_ENABLE_EMBREE=1 MI_ENABLE_AUTODIFF=1
    LITTLE_ENDIAN NDEBUG)
  target_compile_features(Mitsuba::Mitsuba INTERFACE cxx_std_17)
  # The size of Dr.Jit's static arrays follows the instruction set, so -march is part of the
  # binary interface: not native, not plain x86-64 (docs/design.md, and selfcheck.cpp).
  target_compile_options(Mitsuba::Mitsuba INTERFACE
    -march=haswell -O3 -fno-strict-aliasing -fno-math-errno -ffp-contract=fast
    -fno-trapping-math)
endif()
