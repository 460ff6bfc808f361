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
cross=(thumbv7em-none-eabihf riscv32imafc-unknown-none-elf aarch64-unknown-none armebv7r-none-eabihf)
mapfile -t rust < <(rust_packages "${cross[@]}" | tr ' ' '\n')
install_packages "${cortex_m_packages[@]}" "${riscv_packages[@]}" gcc-aarch64-linux-gnu qemu-user "${rust[@]}"

out=$PWD/target/determinism
board=$PWD/c_examples/firmware/board
here=$PWD/tests/determinism
expected=$here/digests.txt
mkdir -p "$out"
warnings=(-Wall -Wextra -Wpedantic -Werror)
options=(-std=c99 -O2 "${warnings[@]}" -ffreestanding -fno-stack-protector -fno-tree-loop-distribute-patterns
    -ffp-contract=off -ffunction-sections -fdata-sections -Iinclude -I"$board" -nostdlib -nostartfiles -static
    "-Wl,--gc-sections" "-Wl,-z,noexecstack" -L"$board")
portable=("$here"/{main,digest,digest_structs,inputs,stages_pure,stages_render,stages_fit,stages_solve}.c)
linux=("$here/linux.c")
bare=("$board/start.c")
failed=()

# compare NAME COMMAND...: runs the program of this name; its output must be the digests.
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

host() { # NAME RUSTFLAGS CARGO-OPTION...
    local name=$1 flags=$2
    shift 2
    RUSTFLAGS=$flags cargo build --quiet -p ofc-ffi --no-default-features --features panic-handler \
        --target-dir "target/determinism/$name-library" "$@"
    gcc "${options[@]}" -no-pie "${portable[@]}" "${linux[@]}" "$here/memory.c" \
        "$out/$name-library"/*/libofc.a -o "$out/$name"
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

build_archive thumbv7em-none-eabihf "" "$out/cortex-m4f-library"
arm-none-eabi-gcc "${options[@]}" -mthumb -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 -T mps2.ld \
    "${portable[@]}" "${bare[@]}" "$board/cortex_m.c" "$archive" -lgcc -o "$out/cortex-m4f"
compare cortex-m4f emulate 600 qemu-system-arm -M mps2-an386 -kernel "$out/cortex-m4f"

build_archive thumbv7em-none-eabihf -Ctarget-cpu=cortex-m7 "$out/cortex-m7-library"
arm-none-eabi-gcc "${options[@]}" -mthumb -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16 -T mps2.ld \
    "${portable[@]}" "${bare[@]}" "$board/cortex_m.c" "$archive" -lgcc -o "$out/cortex-m7"
compare cortex-m7 emulate 600 qemu-system-arm -M mps2-an500 -kernel "$out/cortex-m7"

build_archive riscv32imafc-unknown-none-elf "" "$out/riscv32-library"
riscv64-unknown-elf-gcc "${options[@]}" -march=rv32imafc_zicsr -mabi=ilp32f -T virt.ld \
    "${portable[@]}" "${bare[@]}" "$board/riscv.c" "$archive" -lgcc -o "$out/riscv32"
compare riscv32 emulate 600 qemu-system-riscv32 -M virt -bios none -kernel "$out/riscv32"

build_archive aarch64-unknown-none "" "$out/aarch64-library"
aarch64-linux-gnu-gcc "${options[@]}" "${portable[@]}" "${linux[@]}" "$archive" -o "$out/aarch64"
compare aarch64 qemu-aarch64 "$out/aarch64"

build_archive armebv7r-none-eabihf "" "$out/big-endian-arm-library"
arm-none-eabi-gcc "${options[@]}" -marm -mbig-endian -mcpu=cortex-r5 -mfloat-abi=hard -mfpu=vfpv3-d16 -Wl,--be8 \
    "${portable[@]}" "${linux[@]}" "$archive" -lgcc -o "$out/big-endian-arm"
compare big-endian-arm qemu-armeb "$out/big-endian-arm"

[ ${#failed[@]} -eq 0 ] || { echo "determinism: ${failed[*]}" >&2; exit 1; }
echo "determinism: $(wc -l <"$expected") digests agree"
