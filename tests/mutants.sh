#!/usr/bin/env bash
# Mutation tests: cargo-mutants makes thousands of small changes to the core, one at a time (another operator, a function
# that returns a constant), and the fast tests of the changed room must notice each. Says how many survive, and fails where
# more than 10 % do or where one survives that tests/mutants-survivors.txt does not list with a reason.
#
#   tests/mutants.sh [--at-most N] [ROOM...]    test N mutants more in each room (all, unless said); all rooms, unless named
#   tests/mutants.sh --report [ROOM...]         only say what is known
#
# A mutant takes seconds, all of them a night. Mutants are drawn at random and results are kept in target/mutants, so it can
# be stopped at any time, says what the sample so far amounts to, and goes on when it is started again. Results are kept
# until their file changes; those of survivors until a test of their room changes. `rm -r target/mutants` forgets them.
# Not part of CI. Exit status: 0 all tested and good, 1 not good, 3 good so far, 77 cargo-mutants cannot be installed.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source-path=SCRIPTDIR source=../.ci/packages.sh
. .ci/packages.sh
need_cargo

version=27.1.0
rooms=(math color light orientation surface)
most=10
list=tests/mutants-survivors.txt
out=$PWD/target/mutants
tree=$out/tree
results=$out/results.txt
# cargo-mutants rewrites all that it keeps whenever it is started, so it gets a few mutants at a time.
batch=60

# targets ROOM: the test programs that know the room.
targets() {
    case $1 in
        math) echo lmeds orthogonal location uncertainty ;;
        color) echo lmeds location rank segment shadows check ;;
        light) echo constrained_slant least_squares light_direction pentland tilts_given table1 ;;
        orientation) echo orthogonal tilts_given integrability joint table1 ;;
        surface) echo depth depth_rectangle normals uncertainty ;;
    esac
}

# Tests that take longer than all others of their room together.
slow=(rendered_scenes no_root_is_missed_and_none_invented shares_below_one_two_and_three_sigma
    the_truth_is_among_them_in_degenerate_cases)

# chosen ROOM: cargo's options for the room's tests.
chosen() {
    local target
    echo --lib
    for target in $(targets "$1"); do
        printf '%s\n' --test "$target"
    done
}

# code FILE: the file without its tests, which end it.
code() { sed '/^#\[cfg(test)\]/,$d' "$1"; }

files() { find "ofc-core/src/$1" "ofc-core/src/$1.rs" -name '*.rs' 2>/dev/null | LC_ALL=C sort; }

# keys ROOM: a line "tests KEY" and for each file of the room "PATH KEY"; results under other keys are out of date.
keys() {
    local file target
    {
        chosen "$1"
        echo "${slow[@]}"
        cat tests/src/*.rs
        for target in $(targets "$1"); do cat "tests/tests/$target.rs"; done
        while read -r file; do sed -n '/^#\[cfg(test)\]/,$p' "$file"; done < <(files "$1")
    } | sha1sum | sed 's/ .*//; s/^/tests /'
    while read -r file; do
        echo "$file $(code "$file" | sha1sum | cut -d ' ' -f 1)"
    done < <(files "$1")
}

# known ROOM: "OUTCOME<TAB>MUTANT" for each mutant of the room; the outcome is `new` where there is no result, `again`
# where the mutant survived tests that have changed.
known() {
    keys "$1" >"$out/keys"
    (cd "$tree" && "$mutants" mutants --list --file "ofc-core/src/$1/**" --file "ofc-core/src/$1.rs") >"$out/list"
    awk -F '\t' '
        FILENAME == ARGV[1] { split($0, part, " "); key[part[1]] = part[2]; next }
        FILENAME == ARGV[2] {
            file = $4; sub(/:.*/, "", file)
            if ($2 == key[file]) outcome[$4] = $1 == "missed" && $3 != key["tests"] ? "again" : $1
            next
        }
        { print ($0 in outcome ? outcome[$0] : "new") "\t" $0 }
    ' "$out/keys" "$results" "$out/list"
}

# keep ROOM: adds what the last run of cargo-mutants has found to the results.
keep() {
    local outcome
    for outcome in caught missed timeout unviable; do
        [ -f "$out/mutants.out/$outcome.txt" ] || continue
        awk -v outcome="$outcome" '
            NR == FNR { split($0, part, " "); key[part[1]] = part[2]; next }
            { file = $0; sub(/:.*/, "", file); print outcome "\t" key[file] "\t" key["tests"] "\t" $0 }
        ' "$out/keys" "$out/mutants.out/$outcome.txt" >>"$results"
    done
    rm -rf "$out/mutants.out" "$out/mutants.out.old"
}

# copy: the working tree's files under $tree, where cargo-mutants changes them. Their times are new: whatever an
# interrupted run left changed is built again.
copy() {
    rm -rf "$tree"
    mkdir -p "$tree"
    git ls-files -z --cached --others --exclude-standard | tar --create --null --ignore-failed-read --files-from=- \
        | tar --extract --touch --directory="$tree"
}

# test_room ROOM N
test_room() {
    local room=$1 left=$2 programs started limit patterns
    local skip=("${slow[@]/#/--skip=}")
    mapfile -t programs < <(chosen "$room")
    local run=(cargo test --quiet --profile mutants -p ofc-core -p ofc-tests "${programs[@]}")
    echo "$room: the tests without a change"
    (cd "$tree" && "${run[@]}" --no-run)
    started=$SECONDS
    (cd "$tree" && "${run[@]}" -- "${skip[@]}" >"$out/baseline.log" 2>&1) \
        || { cat "$out/baseline.log"; echo "$room: the tests fail without a change" >&2; exit 1; }
    limit=$((20 + 5 * (SECONDS - started)))
    echo "$room: they take $((SECONDS - started)) s"
    while [ "$left" -gt 0 ]; do
        known "$room" >"$out/known"
        # Survivors of older tests come first, or what is known were no random sample.
        mapfile -t patterns < <({ sed -n '/^again/p' "$out/known"; sed -n '/^new/p' "$out/known" | shuf; } | cut -f 2 \
            | sed -n "1,$((left < batch ? left : batch))p" | sed 's/[][\.*^$+?(){}|]/\\&/g; s/.*/--re=^&$/')
        [ ${#patterns[@]} -gt 0 ] || return 0
        left=$((left - ${#patterns[@]}))
        current=$room
        (cd "$tree" && "$mutants" mutants --in-place --baseline skip --timeout "$limit" --output "$out" --no-shuffle \
            --file "ofc-core/src/$room/**" --file "ofc-core/src/$room.rs" "${patterns[@]}" "${programs[@]/#/--cargo-arg=}" -- -- "${skip[@]}") || true
        current=
        keep "$room"
    done
}

# anchored: "PATH: CHANGE | LINE OF CODE" for each mutant in the input, which is how the list names them, so that it
# stays right when lines move.
anchored() {
    awk -v top="$tree/" '{
        match($0, /:[0-9]+:[0-9]+: /)
        path = substr($0, 1, RSTART - 1)
        split(substr($0, RSTART + 1), at, ":")
        change = substr($0, RSTART + RLENGTH)
        if (!(path in read)) {
            read[path] = 1
            for (n = 1; (getline text < (top path)) > 0; n++) {
                gsub(/^[ \t]+|[ \t]+$/, "", text)
                line[path, n] = text
            }
        }
        name = path
        sub(/^ofc-core\/src\//, "", name)
        print name ": " change " | " line[path, at[1]]
    }'
}

# listed: the survivors in the list. Those after a blank line need a comment of their own: the reason.
listed() {
    awk '
        /^$/ { reason = 0; next }
        /^#/ { reason = 1; next }
        !reason { print FILENAME ":" FNR ": no reason given" >"/dev/stderr"; bad = 1 }
        { print }
        END { exit bad }
    ' "$list"
}

# report: what is known of the rooms wanted, and whether it is good enough.
report() {
    local room failed=0
    : >"$out/survivors"
    : >"$out/counts"
    for room in "${wanted[@]}"; do
        known "$room" >"$out/known"
        grep '^missed' "$out/known" | cut -f 2 >>"$out/survivors" || true
        { echo "$room"; cut -f 1 "$out/known"; } | paste -s -d ' ' >>"$out/counts"
    done
    awk -v most="$most" '
        function row(name, of, survive) {
            survive = of["caught"] + of["timeout"] + of["missed"]
            printf "%-12s %7d %7d %7d %9d %9d %8d", name, of["all"], of["caught"], of["missed"], of["timeout"], of["unviable"], of["all"] - survive - of["unviable"]
            if (survive) printf " %8.1f %%", 100 * of["missed"] / survive
            print ""
            return survive && 100 * of["missed"] > most * survive
        }
        BEGIN { printf "%-12s %7s %7s %7s %9s %9s %8s %10s\n", "room", "mutants", "caught", "missed", "timed out", "unviable", "untested", "survive" }
        {
            delete of
            for (i = 2; i <= NF; i++) { of[$i]++; sum[$i]++; of["all"]++; sum["all"]++ }
            row($1, of)
        }
        END { exit row("all", sum) }
    ' "$out/counts" || { echo "more than $most % survive"; failed=1; }
    listed | LC_ALL=C sort -u >"$out/listed" || failed=1
    anchored <"$out/survivors" | LC_ALL=C sort -u >"$out/anchored"
    if LC_ALL=C comm -23 "$out/anchored" "$out/listed" | grep .; then
        echo "these survive and are not in $list"
        failed=1
    fi
    [ "$failed" -eq 0 ] || return 1
    if awk '$0 ~ / (new|again)( |$)/ { found = 1 } END { exit !found }' "$out/counts"; then
        echo "nothing wrong so far, but some are untested: this is a sample"
        return 3
    fi
}

at_most=1000000
only_report=
wanted=()
while [ $# -gt 0 ]; do
    case $1 in
        --at-most) at_most=$2; shift ;;
        --report) only_report=yes ;;
        *) [ -n "$(targets "$1")" ] || { echo "no room: $1 (there are ${rooms[*]})" >&2; exit 2; }; wanted+=("$1") ;;
    esac
    shift
done
[ ${#wanted[@]} -gt 0 ] || wanted=("${rooms[@]}")

export CARGO_TARGET_DIR=$out/build
mkdir -p "$out"
touch "$results"
exec 9>"$out/lock"
flock --nonblock 9 || { echo "another run is at work in $out" >&2; exit 1; }

mutants=$PWD/target/tools/bin/cargo-mutants
if [ "$("$mutants" mutants --version 2>/dev/null)" != "cargo-mutants $version" ]; then
    CARGO_TARGET_DIR=target/tools/build cargo install --quiet --locked --root target/tools --version "$version" cargo-mutants \
        || { echo "SKIPPED: cargo-mutants $version cannot be installed"; exit 77; }
    rm -rf target/tools/build
fi

copy
current=
trap 'if [ -n "$current" ]; then keep "$current"; fi' EXIT
if [ -z "$only_report" ]; then
    for room in "${wanted[@]}"; do
        test_room "$room" "$at_most"
    done
fi
report
