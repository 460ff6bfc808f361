#!/usr/bin/env bash
# The library against what others have, in one run on one core: run.sh [fit] [normals] [depth] [solve] [--repeats N], all of them by default.
# Prints tables in Markdown. Makes a virtual environment in target/peers from PyPI, installs the Debian packages it lacks as root or with
# sudo, and builds the library as it is shipped and for x86-64-v3. Not part of the tests. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/../../.."
# shellcheck source-path=SCRIPTDIR source=../../../.ci/packages.sh
. .ci/packages.sh
install_packages gcc python3-venv r-base-core r-cran-mass r-cran-robustbase
need_cargo

out=target/peers
[ -x "$out/bin/python" ] || python3 -m venv "$out"
"$out/bin/python" -m pip install --quiet --disable-pip-version-check --requirement tests/benches/peers/requirements.txt
env -u RUSTFLAGS cargo build --quiet --release -p ofc-ffi
libraries=("ofc=target/release/libofc.so")
if grep -qw avx2 /proc/cpuinfo; then
    RUSTFLAGS=-Ctarget-cpu=x86-64-v3 cargo build --quiet --release -p ofc-ffi --target-dir target/x86-64-v3
    libraries+=("ofc, AVX2=target/x86-64-v3/release/libofc.so")
fi
# The scenes of the counts, which the library itself renders, and its header without what the compiler's own headers say.
gcc -O2 -std=c99 -shared -fPIC -Iinclude tests/benches/counts/scenes.c target/release/libofc.a -lm -o "$out/scenes.so"
mkdir -p "$out/no-headers"
touch "$out/no-headers/stddef.h" "$out/no-headers/stdint.h"
gcc -E -P -nostdinc -I"$out/no-headers" -Iinclude tests/benches/counts/scenes.h -o "$out/scenes.h"

# One core; and in favor of the peers, who make new arrays all the time, glibc keeps what they give back.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 NUMBA_NUM_THREADS=1
export MALLOC_MMAP_THRESHOLD_=1073741824 MALLOC_TRIM_THRESHOLD_=1073741824
exec "$out/bin/python" -B tests/benches/peers/main.py "$out" "${libraries[@]}" -- "$@"
