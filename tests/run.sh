#!/usr/bin/env bash
# All tests, and how long each kind of them took. run.sh --fast leaves out instruction counts, Python, the documentation, the emulated
# boards, the other targets, the fuzzing, the examples and the newcomers. Installs the Debian packages it lacks (.ci/packages.sh names them) as root or with sudo. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/.."
case ${1-} in
'') fast= ;;
--fast) fast=yes ;;
*)
    echo "usage: tests/run.sh [--fast]" >&2
    exit 2
    ;;
esac
# shellcheck source-path=SCRIPTDIR source=../.ci/packages.sh
. .ci/packages.sh
install_packages "${example_packages[@]}" "${test_packages[@]}"
need_cargo

name=
# step NAME: says how long the step before took, and what comes next; ends the last one without a name.
step() {
    [ -z "$name" ] || printf '   %s took %d s\n' "$name" $((SECONDS - began))
    name=${1-} began=$SECONDS
    [ -z "$name" ] || printf '\n== %s\n' "$name"
}

step "scripts"
shellcheck -x .ci/run .ci/*.sh c_examples/*.sh c_examples/firmware/*.sh tests/*.sh tests/benches/*.sh tests/benches/peers/*.sh tests/determinism/*.sh tests/fuzz/run.sh tests/newcomer/run.sh ofc-ffi/package/*.sh bindings/*/*.sh docs/*.sh

step "format and lints"
cargo fmt --all --check
cargo clippy --quiet --workspace --all-targets -- -D warnings
# Without the features that the tests ask for.
cargo clippy --quiet -p ofc-core -- -D warnings
# As the registry would get it.
cargo package --quiet --allow-dirty --no-verify -p ofc-core
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps -p ofc-core -p ofc-ffi --features ofc-core/full-streams

step "Rust tests"
cargo test --quiet --workspace

step "contract tests from C"
cmake -S tests -B target/ctest >target/ctest.log
cmake --build target/ctest --parallel 2 >>target/ctest.log || { cat target/ctest.log >&2; exit 1; }
ctest --test-dir target/ctest --output-on-failure

if [ -n "$fast" ]; then
    step
    echo "the fast tests passed in $SECONDS s; instruction counts, Python, documentation, firmware, other targets, fuzzing, examples and newcomers were left out"
    exit
fi

step "instruction counts"
./tests/benches/counts.sh

step "Python and the documentation"
if reaches_pypi; then
    bindings/python/test.sh
    docs/build.sh
fi

step "firmware"
./c_examples/firmware/run.sh

step "the same bits on every target"
./tests/determinism/run.sh

step "fuzzing"
./tests/fuzz/run.sh

step "examples"
./tests/examples.sh

step "newcomers"
./tests/newcomer/run.sh

step
printf '\nall tests passed in %d s\n' "$SECONDS"
