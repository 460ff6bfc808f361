//! What a library without the standard library must bring along. Nothing reaches any of it: the linked library holds no
//! code that panics, which a test of its symbols shows.

/// A panic cannot happen; the language wants to know what would.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

// The prebuilt `core` was made for unwinding and names a personality routine that is never called. It is hidden and
// weak, so a program that has a real one is not disturbed.
#[cfg(target_os = "linux")]
core::arch::global_asm!(
    ".weak rust_eh_personality",
    ".hidden rust_eh_personality",
    ".type rust_eh_personality, %function",
    "rust_eh_personality:",
    ".long 0",
);
