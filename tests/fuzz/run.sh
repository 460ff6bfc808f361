#!/usr/bin/env bash
# Fuzzes the C ABI, with debug assertions and overflow checks in the library. Any finding ends it with a status that is not 0, and its input
# lies in target/fuzz/findings.
#
#   run.sh           some seconds for each target, as CI does it: the inputs that once failed, the corpus, and fresh inputs; then each
#                    target with a fault planted into it, which it must find
#   run.sh HOURS     so long, all targets in turn, from the corpus and what earlier long runs left in target/fuzz/corpus
#   run.sh --merge   makes the corpus of what the long runs left: the smallest inputs that reach all code that all of them reach
set -euo pipefail
cd "$(dirname "$0")/../.."
triple=$(rustc -vV | sed -n 's/^host: //p')
out=$PWD/target/fuzz
library=$out/$triple/debug/libofc.a
targets=()
for file in tests/fuzz/*.c; do
    grep -q '^void target(void)' "$file" && targets+=("$(basename "$file" .c)")
done
# What every process of a target is told: a panic, an abort or 30 s for one input are findings.
options=(-max_len=400 -len_control=0 -timeout=30 -rss_limit_mb=1024 -print_final_stats=1)

RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=3 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
    -Cllvm-args=-sanitizer-coverage-pc-table -Copt-level=3 -Ccodegen-units=1 -Cdebug-assertions=on -Coverflow-checks=on
    -Cdebuginfo=line-tables-only" \
    cargo build --quiet -p ofc-ffi --target "$triple" --target-dir "$out"
# The library loops in a panic, which cannot happen. Here one ends the program.
# The metadata of Rust in the archive is nothing to nm, which says so.
panic=$({ nm "$library" 2>/dev/null || true; } | grep -o '_R[A-Za-z0-9_]*rust_begin_unwind' | sort -u)
# compile NAME OPTION...: the program of a target.
compile() {
    local name=$1 program=$out/$1$2
    shift 2
    clang -std=c11 -g -O1 -Wall -Wextra -Wpedantic -Werror -Wno-gnu-zero-variadic-macro-arguments -D_GNU_SOURCE -Iinclude \
        -fsanitize=fuzzer,undefined -fno-sanitize-recover=all "-DPANIC=__wrap_$panic" "$@" \
        tests/fuzz/{bytes,memory,pictures,outputs,"$name"}.c "$library" "-Wl,--wrap=$panic" -Wl,--gc-sections -lm -o "$program"
}
# fuzz NAME SECONDS OPTION...: prints how many inputs it ran.
fuzz() {
    local name=$1 seconds=$2
    shift 2
    mkdir -p "$out/corpus/$name" "$out/findings/$name"
    if ! nice -n 19 "$out/$name" "${options[@]}" "-max_total_time=$seconds" "-artifact_prefix=$out/findings/$name/" "$@" \
        >"$out/$name.log" 2>&1; then
        grep -vE '^#[0-9]' "$out/$name.log" | tail -40 >&2
        echo "$name: a finding in $out/findings/$name" >&2
        return 1
    fi
    echo "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$name.log") inputs in $seconds s"
}

for name in "${targets[@]}"; do
    compile "$name" ''
    # Hundreds of files of some bytes, in one.
    rm -rf "$out/seeds/$name"
    mkdir -p "$out/seeds/$name"
    tar xzf "tests/fuzz/corpus/$name.tar.gz" -C "$out/seeds/$name"
    # The inputs that failed once are run by themselves: libFuzzer may leave those of a corpus out.
    for input in "tests/fuzz/findings/$name"/*; do
        [ -f "$input" ] || continue
        "$out/$name" "${options[@]}" "$input" >"$out/$name.log" 2>&1 || { cat "$out/$name.log" >&2; echo "$name: $input fails again" >&2; exit 1; }
    done
done

case ${1-} in
'')
    for name in "${targets[@]}"; do
        fresh=$(mktemp -d)
        fuzz "$name" 4 "$fresh" "$out/seeds/$name"
        rm -r "$fresh"
        compile "$name" -planted -DPLANTED_FAULT
        if nice "$out/$name-planted" "${options[@]}" -max_total_time=90 -artifact_prefix="$out/planted-" "$out/seeds/$name" \
            >"$out/$name-planted.log" 2>&1; then
            echo "$name: the planted fault was not found" >&2
            exit 1
        fi
        grep -q -e 'FINDING: ' -e 'SEGV' -e 'deadly signal' "$out/$name-planted.log" || { cat "$out/$name-planted.log" >&2; exit 1; }
        rm -f "$out"/planted-*
    done
    ;;
--merge)
    for name in "${targets[@]}"; do
        least=$(mktemp -d)
        # Edges alone, not how often: a small corpus.
        "$out/$name" "${options[@]}" -merge=1 -use_counters=0 "$least" "$out/seeds/$name" "$out/corpus/$name" 2>&1 | grep 'MERGE-OUTER: .* new files'
        tar c --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=644 -C "$least" . | gzip -9n >"tests/fuzz/corpus/$name.tar.gz"
        rm -r "$least"
    done
    ;;
*)
    failed='' slice=120 end=$((SECONDS + $(awk -v hours="$1" 'BEGIN { printf "%d", hours * 3600 }')))
    while [ $SECONDS -lt $end ]; do
        for name in "${targets[@]}"; do
            [ $SECONDS -lt $end ] || break
            # A finding does not end the run: there may be others.
            fuzz "$name" $((end - SECONDS < slice ? end - SECONDS : slice)) "$out/corpus/$name" "$out/seeds/$name" || failed=yes
        done
    done
    [ -z "$failed" ]
    ;;
esac
