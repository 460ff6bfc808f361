#!/usr/bin/env bash
# The same bits on every target: builds the digest program for each, runs it, under QEMU where the machine cannot, and
# compares what it prints with digests.txt. run.sh TARGET... does it for these alone; run.sh --bless writes that file from
# this machine's program. As many targets as there are processors are under way at once. Installs the Debian packages it
# lacks as root or with sudo. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR source=../../.ci/packages.sh
. .ci/packages.sh
# shellcheck source-path=SCRIPTDIR source=../../.ci/bare-metal.sh
. .ci/bare-metal.sh

here=tests/determinism
out=target/determinism
expected=$here/digests.txt
mkdir -p "$out"
portable=("$here"/{main,digest,digest_structs,inputs}.c "$here"/stages_*.c)
memory=c_examples/firmware/board/memory.c
options=(-O2 -std=c99 -Wall -Wextra -Wpedantic -Werror -ffreestanding -fno-stack-protector -ffp-contract=off
    -fno-tree-loop-distribute-patterns -Iinclude -Ic_examples/firmware/board -nostdlib -static "-Wl,--gc-sections" "-Wl,-z,noexecstack")
# Those that take longest come first: the others fill what is left of the time.
targets=(cortex-m4f riscv32 cortex-m7 big-endian-arm aarch64 x86-64-debug x86-64-release x86-64-v3)

# host NAME FLAGS OPTION...: builds for this machine with these flags for rustc and options for cargo.
host() {
    local name=$1 flags=$2 library=$out/$1-library
    shift 2
    RUSTFLAGS=$flags cargo build --quiet -p ofc-ffi --target-dir "$library" "$@"
    gcc "${options[@]}" -no-pie "${portable[@]}" "$here/linux.c" "$memory" "$library"/*/libofc.a -o "$out/$name"
}

# build TARGET: sets `run` to the command that runs its program.
build() {
    run=("$out/$1")
    case $1 in
    x86-64-debug) host "$1" "" ;;
    x86-64-release) host "$1" "" --release ;;
    x86-64-v3)
        host "$1" -Ctarget-cpu=x86-64-v3 --release
        # The wider registers are in use, or there is nothing to compare.
        objdump -d "$out/$1" | grep ymm >"$out/wide" || { echo "$1: no wide registers"; exit 1; }
        grep -qw avx2 /proc/cpuinfo || run=(qemu-x86_64 -cpu max "$out/$1")
        ;;
    aarch64)
        tools=aarch64-linux-gnu target=(aarch64-linux-gnu-gcc)
        build_archive aarch64 aarch64-unknown-none "" full-streams
        "${target[@]}" "${options[@]}" "${portable[@]}" "$here/linux.c" "$memory" "$archive" -o "$out/$1"
        run=(qemu-aarch64 "$out/$1")
        ;;
    big-endian-arm)
        tools=arm-none-eabi
        target=(arm-none-eabi-gcc -marm -mbig-endian -mcpu=cortex-r5 -mfloat-abi=hard -mfpu=vfpv3-d16)
        # Debian's libgcc is not for this one: what the C code needs of it comes from Rust's runtime.
        build_archive big-endian-arm armebv7r-none-eabihf "" full-streams
        "${target[@]}" "${options[@]}" "-Wl,--be8" "${portable[@]}" "$here/linux.c" "$memory" "$archive" "$raw" -o "$out/$1"
        run=(qemu-armeb "$out/$1")
        ;;
    cortex-m4f | cortex-m7 | riscv32)
        board "$1"
        build_archive "$1" "$triple" "$flags" full-streams
        "${compiler[@]}" -O2 "${portable[@]}" "${start[@]}" "$archive" -lgcc -o "$out/$1"
        cannot_panic "$out/$1"
        run=(emulate "$out/$1")
        ;;
    *)
        echo "$1: no such target" >&2
        exit 2
        ;;
    esac
}

# compare TARGET: what its program prints must be the digests.
compare() {
    local status=0
    build "$1"
    "${run[@]}" >"$out/$1.txt" || status=$?
    if [ "$status" -ne 0 ]; then
        echo "$1: ended with status $status"
    elif cmp --silent "$expected" "$out/$1.txt"; then
        echo "$1: the same bits, after $SECONDS s"
        return
    else
        diff "$expected" "$out/$1.txt" || true
        echo "$1: other bits"
    fi
    return 1
}

case ${1-} in
--one)
    compare "$2"
    exit
    ;;
'' | --bless) ;;
*) targets=("$@") ;;
esac
need_cargo
mapfile -t rust < <(rust_packages thumbv7em-none-eabihf riscv32imafc-unknown-none-elf aarch64-unknown-none \
    armebv7r-none-eabihf)
install_packages "${board_packages[@]}" gcc-aarch64-linux-gnu qemu-user "${rust[@]}"
if [ "${1-}" = --bless ]; then
    build x86-64-release
    "${run[@]}" >"$expected"
fi
# A target's output in one piece, all of it where it failed.
# shellcheck disable=SC2016 # it is for the shell that xargs starts
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c \
    '"$0" --one {} >"$1/{}.said" 2>&1 || { cat "$1/{}.said" >&2; exit 1; }; tail -n 1 "$1/{}.said"' "$here/run.sh" "$out" ||
    { echo "determinism: not the same bits everywhere" >&2; exit 1; }
echo "determinism: $(wc -l <"$expected") digests agree on ${#targets[@]} targets"
