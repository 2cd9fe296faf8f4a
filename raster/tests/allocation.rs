//! After the first frame nothing is allocated.

mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use raster::{DepthBuffer, Payload, Rasterizer, Target};
use shadowmap_core::{Level, Threads};
use support::{Random, soup, torture, views};

/// Counts what the system's allocator is asked for.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise, passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn frames_after_the_first_allocate_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    // Joining what runs on a pool allocates nothing, handing work to it from outside does.
    for threads in [Threads::One, Threads::Pool] {
        if threads == Threads::One {
            draw_frames(threads);
        } else {
            pool.install(|| draw_frames(threads));
        }
    }
}

fn draw_frames(threads: Threads) {
    let scenes = [soup(&mut Random(1), 20_000, 0.05), torture(&mut Random(2), 2000)];
    let views = [views()[0], views()[4], views()[5]];
    for level in Level::available() {
        for scene in &scenes {
            let mut rasterizer = Rasterizer::new(level, threads);
            let mut maps = views.map(|view| DepthBuffer::new(view.width(), view.height()));
            let [a, b, c] = &mut maps;
            let mut targets: [Target<'_>; 3] = [a.target(), b.target(), c.target()];
            let mut counts = [0; 4];
            for count in &mut counts {
                let before = ALLOCATIONS.load(Ordering::Relaxed);
                rasterizer.draw_many(&views, &scene.mesh(), Payload::ObjectId, &mut targets);
                *count = ALLOCATIONS.load(Ordering::Relaxed) - before;
            }
            assert!(counts[0] > 0, "the counter counts");
            assert_eq!(counts[1..], [0; 3], "{}, {threads:?}", level.kind().name());
        }
    }
}
