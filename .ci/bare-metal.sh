# shellcheck shell=bash
# Sourced by scripts that build for targets without an operating system: libofc.a for any of rustc's targets.

# What the compiler packages of these targets are called.
# shellcheck disable=SC2034
cortex_m_packages=(gcc-arm-none-eabi qemu-system-arm)
# shellcheck disable=SC2034
riscv_packages=(gcc-riscv64-unknown-elf qemu-system-misc)

# rust_packages TARGET...: the packages without which rustc cannot compile for them; none where rustup has the targets, or
# the sources of the Rust library.
rust_packages() {
    local target sysroot
    sysroot=$(rustc --print sysroot)
    for target in "$@"; do
        if [ ! -d "$sysroot/lib/rustlib/$target/lib" ] && [ ! -d "$sysroot/lib/rustlib/src/rust/library" ]; then
            echo rustc-web rust-web-src
            return
        fi
    done
}

# build_archive TARGET FLAGS FOLDER: libofc.a by the profile `firmware`, with the flags for rustc, in a target folder of its
# own. Sets `archive` to its path.
build_archive() {
    local target=$1 flags=$2 folder=$3 sysroot
    local build=(cargo rustc --quiet --profile firmware -p ofc-ffi --lib --crate-type staticlib
        --no-default-features --features panic-handler --target "$target" --target-dir "$folder")
    sysroot=$(rustc --print sysroot)
    if [ -d "$sysroot/lib/rustlib/$target/lib" ]; then
        RUSTFLAGS=$flags "${build[@]}"
    elif [ -d "$sysroot/lib/rustlib/src/rust/library" ]; then
        RUSTC_BOOTSTRAP=1 RUSTFLAGS=$flags "${build[@]}" -Zbuild-std=core
    else
        RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc RUSTFLAGS=$flags "${build[@]}" -Zbuild-std=core
    fi
    # shellcheck disable=SC2034
    archive=$folder/$target/firmware/libofc.a
}

# emulate SECONDS COMMAND...: what a program on an emulated board without anything but semihosting prints; its status. A
# hang ends with status 124.
emulate() {
    local seconds=$1
    shift
    timeout "$seconds" "$@" -nographic -monitor none -serial none -chardev stdio,id=output \
        -semihosting-config enable=on,target=native,chardev=output </dev/null
}
