#!/usr/bin/env bash
# Builds the library and the examples, and solves a picture: run.sh [IMAGE and options of ofc_photo; --help lists them].
# Installs the Debian packages it lacks (.ci/packages.sh names them) as root or with sudo. Can be run again.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source-path=SCRIPTDIR source=../.ci/packages.sh
. "$root/.ci/packages.sh"
install_packages "${example_packages[@]}"
need_cargo

build="$root/target/c_examples/build"
log="$build.log"
mkdir -p "$build"
[ -f "$build/Makefile" ] || echo "building the library and the examples (about a minute the first time)"
if ! { cmake -S "$root/c_examples" -B "$build" && cmake --build "$build" --parallel 2; } >"$log" 2>&1; then
    cat "$log" >&2
    exit 1
fi
exec "$root/target/c_examples/ofc_photo" "$@"
