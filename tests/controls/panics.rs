//! Negative control: a library that looks right and can panic.
#![no_std]

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// Panics for an index that is out of range.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_control(values: &[u8; 4], index: usize) -> u8 {
    values[index]
}
