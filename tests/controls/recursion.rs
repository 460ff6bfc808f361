//! Negative control: recursion in three disguises, and a call that no reading can follow.
#![no_std]

use core::hint::black_box;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[inline(never)]
fn product(n: u32) -> u32 {
    if n == 0 { 1 } else { n.wrapping_mul(black_box(product(n - 1))) }
}

#[inline(never)]
fn is_even(n: u32) -> bool {
    n == 0 || black_box(is_odd(black_box(n - 1)))
}

#[inline(never)]
fn is_odd(n: u32) -> bool {
    n != 0 && black_box(is_even(black_box(n - 1)))
}

/// Calls a function that calls itself, one that calls it back, and one that cannot be known.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_control(callback: extern "C" fn(u32) -> u32, n: u32) -> u32 {
    product(n).wrapping_add(u32::from(is_even(n))).wrapping_add(callback(n))
}

/// Hands itself to a function that calls it.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_call_back(n: u32) -> u32 {
    black_box(ofc_control(black_box(ofc_call_back), n))
}
