//! Draws the tiny render on a Cortex-M4 and prints the hash of its mask.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use cortex_m_semihosting::{debug, hprintln};
use embedded_alloc::LlffHeap;
use panic_semihosting as _;
use shadowmap_core::Level;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

const HEAP_SIZE: usize = 1 << 20;
static mut HEAP_MEMORY: [MaybeUninit<u8>; HEAP_SIZE] = [MaybeUninit::uninit(); HEAP_SIZE];

#[cortex_m_rt::entry]
fn main() -> ! {
    // SAFETY: called once, before anything allocates, with memory that nothing else uses.
    unsafe { HEAP.init(&raw mut HEAP_MEMORY as usize, HEAP_SIZE) }
    let mask = tiny_render::mask(Level::SCALAR);
    hprintln!("mask {:016x}", tiny_render::hash(&mask));
    hprintln!("heap {} bytes in use after the render", HEAP.used());
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
