#!/usr/bin/env bash
# How many instructions calls of the library take, against instructions.txt: fails where one takes more than 3 % more, and says where
# one takes as much less. counts.sh --bless writes that file anew. Counts are those of callgrind and of the static archive for any
# x86-64; they do not depend on the machine, but on the compiler, which the file names.
set -euo pipefail
cd "$(dirname "$0")/../.."
case ${1-} in
'' | --bless) ;;
*)
    echo "usage: tests/benches/counts.sh [--bless]" >&2
    exit 2
    ;;
esac
if [ "$(uname -m)" != x86_64 ]; then
    echo "instructions are counted on x86-64"
    exit
fi
# shellcheck source-path=SCRIPTDIR source=../../.ci/packages.sh
. .ci/packages.sh
install_packages gcc valgrind
need_cargo

here=tests/benches
out=target/counts
mkdir -p "$out"
rm -f "$out"/callgrind.*
env -u RUSTFLAGS cargo build --quiet --release -p ofc-ffi
# With functions of its own for copying and filling memory: those of the C library are chosen by the processor.
gcc -O3 -std=c99 -Wall -Wextra -Wpedantic -Werror -ffp-contract=off -fno-tree-loop-distribute-patterns -Iinclude -I"$here/counts" \
    "$here"/counts/*.c c_examples/firmware/board/memory.c target/release/libofc.a -Wl,--gc-sections -lm -o "$out/counts"

# count PART: every dump of callgrind names the call and holds its count.
count() {
    valgrind --quiet --tool=callgrind --instr-atstart=no --callgrind-out-file="$out/callgrind.$1" "$out/counts" "$1"
}
count solve &
solve=$!
count stages
wait "$solve"
# The pixels, the instructions and the name of each call.
awk '/^desc: Trigger: Client Request: / { pixels = $5; name = $0; sub(/^.*Request: [0-9]+ /, "", name) }
    /^(summary|totals): / && name != "" { printf "%8d %12d  %s\n", pixels, $2, name; name = "" }' "$out"/callgrind.*.* |
    sort -k3 -k1n >"$out/counted"

compiler=$(rustc --version)
if [ "${1-}" = --bless ]; then
    { echo "# pixels, instructions and name of calls; $compiler"; cat "$out/counted"; } >"$here/instructions.txt"
    exit
fi
awk -v compiler="$compiler" -v limit=1.03 '
    { pixels = $1; instructions = $2; name = $0; sub(/^ *[0-9]+ +[0-9]+ +/, "", name); call = name ", " pixels " pixels" }
    FILENAME == ARGV[1] && /^#/ { of = $0; sub(/^.*; /, "", of); next }
    FILENAME == ARGV[1] { expected[call] = instructions; next }
    {
        counted++
        printf "%-46s %11d, %.1f a pixel", call, instructions, instructions / pixels
        if (!(call in expected)) { printf ": not in the file"; failed = 1 }
        else {
            ratio = instructions / expected[call]
            if (ratio > limit) { printf ": %+.1f %%, TOO MANY", 100 * (ratio - 1); failed = 1 }
            else if (ratio < 1 / limit) printf ": %+.1f %%, fewer than in the file", 100 * (ratio - 1)
            delete expected[call]
        }
        print ""
    }
    END {
        for (call in expected) { print call ": was not counted"; failed = 1 }
        if (failed && of != compiler) print "the file is of " of ", this is " compiler
        if (failed) print "after a change that is worth it: tests/benches/counts.sh --bless"
        exit failed || counted == 0
    }' "$here/instructions.txt" "$out/counted"
