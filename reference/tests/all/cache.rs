//! The cache of truth images.

use glam::Vec3;
use reference::{Samples, Tracer, truth};
use shadowmap_core::{Light, Threads};

use crate::scenes::{blocker, camera};

#[test]
fn what_is_read_back_is_what_was_computed() {
    let scene = blocker();
    let tracer = Tracer::new(&scene.mesh());
    let view = camera(Vec3::new(0.0, 6.0, 7.0), Vec3::ZERO, 16);
    let seen = tracer.receivers(&view, Threads::One);
    let mut light = Light::Sphere { center: Vec3::new(0.0, 4.0, 0.0), radius: 0.5 };
    let read = |light: &Light| {
        let samples = Samples::Fixed(64);
        truth::cached(&scene.mesh(), &seen.positions, &seen.normals, light, samples)
    };
    let mut exact = vec![0.0; seen.positions.len()];
    let (positions, normals) = (&seen.positions, &seen.normals);
    tracer.visibility(&light, positions, normals, Samples::Fixed(64), Threads::One, &mut exact);
    // The second time from disk, if the disk could be written.
    assert_eq!(read(&light), exact);
    assert_eq!(read(&light), exact);
    if let Light::Sphere { radius, .. } = &mut light {
        *radius = 0.6;
    }
    assert_ne!(read(&light), exact, "another light is another truth");
}
