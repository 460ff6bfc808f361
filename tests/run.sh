#!/usr/bin/env bash
# All tests. Installs the Debian packages it lacks (.ci/packages.sh names them) as root or with sudo. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source-path=SCRIPTDIR source=../.ci/packages.sh
. .ci/packages.sh
install_packages "${example_packages[@]}" "${test_packages[@]}"
need_cargo

step() { printf '\n== %s\n' "$*"; }

step "scripts"
shellcheck -x .ci/run .ci/*.sh c_examples/*.sh c_examples/firmware/*.sh tests/*.sh tests/determinism/*.sh

step "format and lints"
cargo fmt --all --check
cargo clippy --quiet --workspace --all-targets -- -D warnings
# Without the features that the tests ask for.
cargo clippy --quiet -p ofc-core -- -D warnings

step "Rust tests"
cargo test --quiet --workspace

step "contract tests from C"
cmake -S tests -B target/ctest >target/ctest.log
cmake --build target/ctest --parallel 2 >>target/ctest.log || { cat target/ctest.log >&2; exit 1; }
ctest --test-dir target/ctest --output-on-failure

step "firmware"
./c_examples/firmware/run.sh

step "the same bits on every target"
./tests/determinism/run.sh

step "examples"
./tests/examples.sh

step "all tests passed"
