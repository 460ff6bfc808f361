#!/usr/bin/env bash
# Builds the firmware for each board, runs it under QEMU, and prints what it says and what it takes; as many boards at once
# as there are processors. run.sh BOARD[+FEATURE]... does it for these alone; run.sh --write also puts the table of figures
# into README.md. Fails where a budget is exceeded, or where the image holds what panics. Installs the Debian packages it
# lacks as root or with sudo. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR source=../../.ci/packages.sh
. .ci/packages.sh
# shellcheck source-path=SCRIPTDIR source=../../.ci/bare-metal.sh
. .ci/bare-metal.sh
here=c_examples/firmware
out=target/firmware
mkdir -p "$out"
[ "${1-}" = --one ] || rm -f "$out/tactile.row"
exceeded=()
# A board, and a feature of the library after a plus.
programs=(cortex-m7 cortex-m4f riscv32 cortex-m7+full-streams)

# section FILE NAME...: the bytes of these sections.
section() {
    local file=$1 name total=0 size
    shift
    for name in "$@"; do
        size=$("$tools-size" -A "$file" | awk -v name="$name" '$1 == name { print $2 }')
        total=$((total + ${size:-0}))
    done
    echo "$total"
}

# calls_are_known PROGRAM: ends the script where it calls through a pointer, which no call graph shows. For size, compilers load
# the address of a function that is called several times into a register: that is no pointer, where the register was last
# loaded from a constant that is the address of a function.
calls_are_known() {
    local listing=$1.dis
    "$tools-objdump" -d "$1" >"$listing"
    awk -F '\t' '
        function plain(hex) { sub(/^ *(0x)?0*/, "", hex); sub(/[: ].*/, "", hex); return hex }
        # Bit 0 of the address of a function in Thumb code is set.
        function even(hex, last) {
            last = index("13579bdf", substr(hex, length(hex)))
            return last ? substr(hex, 1, length(hex) - 1) substr("02468ace", last, 1) : hex
        }
        FNR == NR && /^[0-9a-f]+ <.*>:$/ { begins[plain($1)] = 1 }
        FNR == NR && $3 == ".word" { constant[plain($1)] = plain($4) }
        FNR == NR { next }
        /^[0-9a-f]+ <.*>:$/ { name = $1; split("", loaded); next }
        { register = $4; sub(/[,\t ].*/, "", register) }
        $3 == "blx" && $4 ~ /^r/ {
            target = (register in loaded) ? even(constant[loaded[register]]) : ""
            if (target == "" || !(target in begins)) { print name, $3, $4; found = 1 }
            next
        }
        $3 ~ /^ldr(\.w)?$/ && $4 ~ /\[pc/ {
            literal = $0
            sub(/.*@ \(?/, "", literal)
            loaded[register] = plain(literal)
            next
        }
        $3 ~ /^(str|cmp|cbz|cbnz|tst|push)/ { next }
        { delete loaded[register] }
        END { exit found }' "$listing" "$listing" || {
        echo "$1: a call through a pointer, which no call graph shows" >&2
        exit 1
    }
}

# said FILE KIND [NAME]: the number that the program printed after '#'.
said() {
    awk -v kind="$2" -v name="${3-}" '$1 == "#" && $2 == kind && (name == "" || $3 == name) { print $NF; exit }' "$1"
}

# budget WHAT VALUE LIMIT
budget() {
    [ "$2" -le "$3" ] || exceeded+=("$1 $2 above $3")
}

# measure_tactile: builds and runs the sensor with a loaded model for the board and archive that were set last, and writes its row of the table.
measure_tactile() {
    local program=$out/tactile row="| tactile, $1" stage
    "${compiler[@]}" -Oz "$here"/{tactile,gel,print}.c "${start[@]}" "$archive" -lgcc -o "$program.elf"
    cannot_panic "$program.elf"
    calls_are_known "$program.elf"
    emulate "$program.elf" -icount shift=0 | tee "$program.txt"
    row+=" | $(section "$program.elf" .text .rodata .data) | $(section "$program.elf" .data .bss)"
    for stage in "stack call" "stack load" "instructions load" "instructions tactile"; do
        # shellcheck disable=SC2086 # two words
        row+=" | $(said "$program.txt" $stage)"
    done
    echo "$row |" >"$out/tactile.row"
    budget "stack in a call with a model" "$(said "$program.txt" stack call)" 4096
    budget "frame with a model" "$(said "$program.txt" instructions tactile)" 13500000
}

# measure BOARD[+FEATURE]: builds and runs the firmware, and writes its row of the table.
measure() {
    local name=${1%%+*} feature="" program=$out/$1 flash ram stack row stage
    [ "$name" = "$1" ] || feature=${1#*+}
    board "$name"
    build_archive "$name" "$triple" "$flags" "$feature"
    "${compiler[@]}" -Oz "$here"/{main,scene,print}.c "${start[@]}" "$archive" -lgcc -o "$program.elf"
    cannot_panic "$program.elf"
    calls_are_known "$program.elf"
    echo "== $1"
    emulate "$program.elf" -icount shift=0 | tee "$program.txt"
    flash=$(section "$program.elf" .text .rodata .data)
    ram=$(section "$program.elf" .data .bss)
    stack=$(said "$program.txt" stack call)
    row="| $name${feature:+, \`$feature\`} | $flash | $ram | $stack | $(said "$program.txt" stack program)"
    for stage in render cold normals warm; do
        row+=" | $(said "$program.txt" instructions $stage)"
    done
    echo "$row |" >"$program.row"
    if [ "$1" = cortex-m7 ]; then
        budget "flash" "$flash" 65536
        budget "RAM" "$ram" 65536
        budget "stack in a call" "$stack" 4096
        budget "cold solve" "$(said "$program.txt" instructions cold)" 100000000
        budget "warm frame" "$(said "$program.txt" instructions warm)" 8000000
        measure_tactile "$1"
    fi
    if [ ${#exceeded[@]} -gt 0 ]; then
        printf 'over budget: %s\n' "${exceeded[@]}" >&2
        exit 1
    fi
}

case ${1-} in
--one)
    measure "$2"
    exit
    ;;
'' | --write) ;;
*) programs=("$@") ;;
esac
need_cargo
mapfile -t rust < <(rust_packages thumbv7em-none-eabihf riscv32imafc-unknown-none-elf)
install_packages "${board_packages[@]}" "${rust[@]}"

# A board's output in one piece.
# shellcheck disable=SC2016 # it is for the shell that xargs starts
printf '%s\n' "${programs[@]}" | xargs -P "$(nproc)" -I{} bash -c \
    'status=0; "$0" --one {} >"$1/{}.said" 2>&1 || status=1; cat "$1/{}.said"; exit $status' "$here/run.sh" "$out"
table=$out/table.md
{
    echo "| | flash | RAM | stack in a call | stack | rendering | cold solve | normals | warm frame |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    for program in "${programs[@]}"; do
        cat "$out/$program.row"
    done
    if [ -f "$out/tactile.row" ]; then
        echo
        echo "| | flash | RAM | stack in a call | stack to load | instructions to load | a frame |"
        echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"
        cat "$out/tactile.row"
    fi
} | tee "$table"
if [ "${1-}" = --write ]; then
    awk -v table="$table" '
        /^<!-- table -->/ { print; while ((getline line < table) > 0) print line; skip = 1 }
        /^<!-- end -->/ { skip = 0 }
        !skip && !/^<!-- table -->/ { print }' "$here/README.md" >"$out/README.md"
    cp "$out/README.md" "$here/README.md"
fi
