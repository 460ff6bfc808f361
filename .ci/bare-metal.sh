# shellcheck shell=bash
# Sourced by scripts that build for boards without an operating system and run them under QEMU.
# shellcheck disable=SC2034 # what is set here is used there

# What the boards below need from Debian.
board_packages=(gcc-arm-none-eabi gcc-riscv64-unknown-elf qemu-system-arm qemu-system-misc)

# board NAME: sets what is special to it: `triple` and `flags` for rustc, `target`, the C compiler with the options that
# choose the processor, `compiler` and `emulator` with all their options, `start`, the sources that come before main(), and `tools`, the prefix of nm and size.
board() {
    local folder=c_examples/firmware/board layout
    start=("$folder"/{start,memory}.c)
    # Inlining and aligned loops cost more flash than they save instructions; short constants may lie with the code.
    flags="-Cllvm-args=-inline-threshold=5 -Cllvm-args=-align-loops=1 -Cllvm-args=-arm-promote-constant=1"
    case $1 in
    cortex-m7)
        triple=thumbv7em-none-eabihf
        flags+=" -Ctarget-cpu=cortex-m7"
        tools=arm-none-eabi
        target=(arm-none-eabi-gcc -mthumb -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16)
        layout=mps2.ld
        emulator=(qemu-system-arm -M mps2-an500)
        start+=("$folder/cortex_m.c")
        ;;
    cortex-m4f)
        triple=thumbv7em-none-eabihf
        tools=arm-none-eabi
        target=(arm-none-eabi-gcc -mthumb -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16)
        layout=mps2.ld
        emulator=(qemu-system-arm -M mps2-an386)
        start+=("$folder/cortex_m.c")
        # Double precision is that of Rust's runtime. libgcc's sums and products take half the instructions, but not all of its
        # results have the bits of every other target.
        ;;
    riscv32)
        triple=riscv32imafc-unknown-none-elf
        tools=riscv64-unknown-elf
        target=(riscv64-unknown-elf-gcc -march=rv32imafc -misa-spec=2.2 -mabi=ilp32f)
        layout=virt.ld
        emulator=(qemu-system-riscv32 -M virt -bios none)
        start+=("$folder/riscv.c")
        ;;
    esac
    compiler=("${target[@]}" -T "$layout" -std=c99 -Wall -Wextra -Wpedantic -Werror -ffreestanding
        -fno-stack-protector -ffp-contract=off -fno-math-errno -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections -Iinclude -I"$folder"
        -nostdlib -nostartfiles -static "-Wl,--gc-sections" "-Wl,-z,noexecstack" -L"$folder")
}

# rust_packages TRIPLE...: the packages without which rustc cannot compile for them, a line each; none where rustup has
# the targets, or the sources of the Rust library.
rust_packages() {
    local triple sysroot
    sysroot=$(rustc --print sysroot)
    for triple in "$@"; do
        if [ ! -d "$sysroot/lib/rustlib/$triple/lib" ] && [ ! -d "$sysroot/lib/rustlib/src/rust/library" ]; then
            printf '%s\n' rustc-web rust-web-src
            return
        fi
    done
}

# build_archive NAME TRIPLE FLAGS [FEATURE]: libofc.a by the profile `firmware`, with these flags for rustc, for `target` and
# `tools`. Sets `archive` to its path, and `raw` to that of the one from cargo.
build_archive() {
    local name=$1 triple=$2 flags=$3 features=${4-} sysroot folder=target/bare/$1${4:+-$4}
    local build=(cargo rustc --quiet --profile firmware -p ofc-ffi --lib --crate-type staticlib
        --no-default-features --features "$features" --target "$triple" --target-dir "$folder")
    sysroot=$(rustc --print sysroot)
    if [ -d "$sysroot/lib/rustlib/$triple/lib" ]; then
        RUSTFLAGS=$flags "${build[@]}"
    elif [ -d "$sysroot/lib/rustlib/src/rust/library" ]; then
        RUSTC_BOOTSTRAP=1 RUSTFLAGS=$flags "${build[@]}" -Zbuild-std=core
    else
        RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc RUSTFLAGS=$flags "${build[@]}" -Zbuild-std=core
    fi
    raw=$folder/$triple/firmware/libofc.a archive=$folder/libofc.a
    CC="${target[*]}" NM=$tools-nm OBJCOPY=$tools-objcopy AR=$tools-ar \
        ofc-ffi/package/archive.sh "$raw" "$archive"
}

# cannot_panic PROGRAM: ends the script if the program for the board that was set last holds panic machinery.
cannot_panic() {
    if "$tools-nm" -C "$1" | grep -E 'panic|core::fmt|unwrap_failed|expect_failed|_fail|_Unwind_|eh_personality|unwind'; then
        echo "$1 holds panic machinery" >&2
        exit 1
    fi
}

# emulate PROGRAM OPTION...: runs it on the emulator of the board that was set last; its output and status. A program that
# hangs ends with status 124.
emulate() {
    local program=$1
    shift
    timeout 300 "${emulator[@]}" "$@" -nographic -monitor none -serial none -chardev stdio,id=output \
        -semihosting-config enable=on,target=native,chardev=output -kernel "$program" </dev/null
}
