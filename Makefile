# The commands of this repository. Each sets up what it needs; nothing has to run before it.
#
#   make build      .venv with pinned packages, then the Rust core, the plugin and the Python package
#   make compare    build, then render the height fog with our medium and with its voxelised twin
#   make street     build, then find the fog of a street from its picture (make sunset: haze)
#   make test       build, then lint, and the tests of Rust, C, C++ and Python
#   make lint       the formatters and linters alone
#   make install    the C library for other programs, into PREFIX
#   make clean      remove what was built, but not .venv
#
# VARIANTS="scalar_rgb llvm_ad_rgb" builds the plugin for some of Mitsuba's variants only.

PYTHON ?= python3
VARIANTS ?= all
PREFIX ?= /usr/local
SCENE ?= scenes/height_fog.xml

bin := .venv/bin
cxx_sources = $(wildcard include/*.hpp mitsuba_plugin/src/*.h mitsuba_plugin/src/*.cpp \
                mitsuba_plugin/src/*/*.h mitsuba_plugin/src/*/*.cpp tests/c/*.cpp)

# pip, pytest and CMake find the tools of .venv first.
export PATH := $(CURDIR)/$(bin):$(PATH)

.PHONY: build llvm compare street sunset test test-rust test-python lint install clean

build: llvm .venv/.requirements
	@echo "== Building the Rust core, the plugin ($(VARIANTS)) and the Python package"
	pip install --quiet --no-build-isolation --no-deps --force-reinstall \
	    --config-settings=cmake.define.AM_VARIANTS="$(VARIANTS)" .

.venv/.requirements: requirements.txt
	@echo "== Installing Mitsuba and the tools into .venv"
	test -x $(bin)/pip || $(PYTHON) -m venv .venv
	pip install --quiet --disable-pip-version-check -r requirements.txt
	@touch $@

llvm:
	@tools/ensure_llvm.sh

compare: build
	@echo "== Comparing $(SCENE) with its voxelised twin; the report goes to report/"
	analytic-media compare $(SCENE) --output report

street sunset: build
	@echo "== Finding what examples/inverse/$@.py looks for; the picture goes to report/"
	@mkdir -p report
	python examples/inverse/$@.py --output report/$@_fit.png

test: lint test-rust test-python

lint: .venv/.requirements
	@echo "== Formatters and linters"
	cargo fmt --check
	cargo clippy --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --locked --quiet
	ruff check
	ruff format --check
	clang-format --dry-run -Werror $(cxx_sources)

test-rust:
	@echo "== Rust, C and C++: debug, then release"
	cargo test --locked
	CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 cargo test --locked --release

test-python: build
	@echo "== Python and Mitsuba"
	pytest

# CMake may be the system's; .venv is made for it only where there is none.
install: $(if $(shell command -v cmake),,.venv/.requirements)
	cmake -S . -B build/library -DCMAKE_BUILD_TYPE=Release \
	    -DAM_MITSUBA_PLUGIN=OFF -DCMAKE_INSTALL_PREFIX=$(abspath $(PREFIX))
	cmake --build build/library
	cmake --install build/library

clean:
	rm -rf build target report dist
