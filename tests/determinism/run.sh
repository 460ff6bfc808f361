#!/usr/bin/env bash
# The same bits on every target: builds the digest program for each, runs it, under QEMU where the machine cannot, and
# compares what it prints with digests.txt. run.sh --bless writes that file from the first target. Installs the Debian
# packages it lacks as root or with sudo. Can be run again.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source-path=SCRIPTDIR source=../../.ci/packages.sh
. .ci/packages.sh
# shellcheck source-path=SCRIPTDIR source=../../.ci/bare-metal.sh
. .ci/bare-metal.sh
need_cargo
mapfile -t rust < <(rust_packages thumbv7em-none-eabihf riscv32imafc-unknown-none-elf aarch64-unknown-none \
    armebv7r-none-eabihf)
install_packages "${board_packages[@]}" gcc-aarch64-linux-gnu qemu-user "${rust[@]}"

here=tests/determinism
out=target/determinism
expected=$here/digests.txt
mkdir -p "$out"
portable=("$here"/{main,digest,digest_structs,inputs,stages_pure,stages_render,stages_fit,stages_paint,stages_solve,stages_depth,stages_stream,stages_relief}.c)
memory=c_examples/firmware/board/memory.c
options=(-O2 -std=c99 -Wall -Wextra -Wpedantic -Werror -ffreestanding -fno-stack-protector -ffp-contract=off
    -fno-tree-loop-distribute-patterns -Iinclude -Ic_examples/firmware/board -nostdlib -static "-Wl,--gc-sections" "-Wl,-z,noexecstack")
failed=()

# compare NAME COMMAND...: what the command prints must be the digests.
compare() {
    local name=$1 status=0
    shift
    "$@" >"$out/$name.txt" || status=$?
    if [ "$status" -ne 0 ]; then
        echo "$name: ended with status $status"
    elif cmp --silent "$expected" "$out/$name.txt"; then
        echo "$name: the same bits"
        return
    else
        diff "$expected" "$out/$name.txt" || true
        echo "$name: other bits"
    fi
    failed+=("$name")
}

# host NAME FLAGS OPTION...: builds for this machine with these flags for rustc and options for cargo.
host() {
    local name=$1 flags=$2 library=$out/$1-library
    shift 2
    RUSTFLAGS=$flags cargo build --quiet -p ofc-ffi --target-dir "$library" "$@"
    gcc "${options[@]}" -no-pie "${portable[@]}" "$here/linux.c" "$memory" "$library"/*/libofc.a -o "$out/$name"
}

host x86-64-debug ""
host x86-64-release "" --release
host x86-64-v3 -Ctarget-cpu=x86-64-v3 --release
if [ "${1-}" = --bless ]; then
    "$out/x86-64-release" >"$expected"
fi
compare x86-64-debug "$out/x86-64-debug"
compare x86-64-release "$out/x86-64-release"
# The wider registers are in use, or there is nothing to compare.
objdump -d "$out/x86-64-v3" | grep ymm >"$out/wide" || { echo "x86-64-v3: no wide registers" >&2; exit 1; }
if grep -qw avx2 /proc/cpuinfo; then
    compare x86-64-v3 "$out/x86-64-v3"
else
    compare x86-64-v3 qemu-x86_64 -cpu max "$out/x86-64-v3"
fi

for name in cortex-m4f cortex-m7 riscv32; do
    board "$name"
    build_archive "$name" "$triple" "$flags" full-streams
    "${compiler[@]}" -O2 "${portable[@]}" "${start[@]}" "$archive" -lgcc -o "$out/$name"
    cannot_panic "$out/$name"
    compare "$name" emulate "$out/$name"
done

tools=aarch64-linux-gnu target=(aarch64-linux-gnu-gcc)
build_archive aarch64 aarch64-unknown-none "" full-streams
"${target[@]}" "${options[@]}" "${portable[@]}" "$here/linux.c" "$memory" "$archive" -o "$out/aarch64"
compare aarch64 qemu-aarch64 "$out/aarch64"

tools=arm-none-eabi
target=(arm-none-eabi-gcc -marm -mbig-endian -mcpu=cortex-r5 -mfloat-abi=hard -mfpu=vfpv3-d16)
# Debian's libgcc is not for this one: what the C code needs of it comes from Rust's runtime.
build_archive big-endian-arm armebv7r-none-eabihf "" full-streams
"${target[@]}" "${options[@]}" "-Wl,--be8" "${portable[@]}" "$here/linux.c" "$memory" "$archive" "$raw" -o "$out/big-endian-arm"
compare big-endian-arm qemu-armeb "$out/big-endian-arm"

[ ${#failed[@]} -eq 0 ] || { echo "determinism: ${failed[*]}" >&2; exit 1; }
echo "determinism: $(wc -l <"$expected") digests agree"
