//! Draws the tiny render on a Cortex-M4 and prints the hash of its mask, and the heap it took.
#![no_std]
#![no_main]

use core::alloc::{GlobalAlloc, Layout};
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicUsize, Ordering};

use cortex_m_semihosting::{debug, hprintln};
use embedded_alloc::LlffHeap;
use panic_semihosting as _;
use shadowmap_core::Level;

/// A heap that remembers the most that was in use.
struct Measured {
    heap: LlffHeap,
    most: AtomicUsize,
}

// SAFETY: everything is passed on to the heap.
unsafe impl GlobalAlloc for Measured {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise, passed on.
        let pointer = unsafe { self.heap.alloc(layout) };
        self.most.fetch_max(self.heap.used(), Ordering::Relaxed);
        pointer
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise, passed on.
        unsafe { self.heap.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static HEAP: Measured = Measured { heap: LlffHeap::empty(), most: AtomicUsize::new(0) };

const HEAP_SIZE: usize = 1 << 20;
static mut HEAP_MEMORY: [MaybeUninit<u8>; HEAP_SIZE] = [MaybeUninit::uninit(); HEAP_SIZE];

#[cortex_m_rt::entry]
fn main() -> ! {
    // SAFETY: called once, before anything allocates, with memory that nothing else uses.
    unsafe { HEAP.heap.init(&raw mut HEAP_MEMORY as usize, HEAP_SIZE) }
    let mask = tiny_render::mask(Level::SCALAR);
    hprintln!("mask {:016x}", tiny_render::hash(&mask));
    let most = HEAP.most.load(Ordering::Relaxed);
    hprintln!(
        "heap {} bytes at most, for a map of {} x {} and a mask of {} x {}",
        most,
        tiny_render::MAP,
        tiny_render::MAP,
        tiny_render::MASK,
        tiny_render::MASK
    );
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
