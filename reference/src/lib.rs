//! The truth that soft shadows are measured against, by ray tracing.
//!
//! A [`Tracer`] answers one question: what fraction of a light does a point of a surface see? It
//! answers for every kind of light, with samples that [`Samples`] places, and with the same bits
//! on every machine and for any number of threads. [`truth::cached`] keeps the answers for whole
//! images on disk.
//!
//! Beside the truth stand the baselines that work on the same depth maps as the methods of the
//! workspace: [`point_lights`] places the N point lights that the papers compare themselves with,
//! [`Pcf`] and [`Pcss`] are what most people use today.
//!
//! # How 4096 rays per receiver are fast
//!
//! All rays of a receiver start at one point. A triangle blocks those that lie on the inner side of
//! three planes, each through that point and one edge; over the light's own coordinates, in which
//! its samples are fixed points, these are half-planes. So the hierarchy of boxes (built by
//! `obvhs`) is walked once per receiver by a pyramid around all of the rays, and every triangle
//! found is drawn into a bit mask of samples, sixteen at a time, whole groups at once where a
//! box around them lies inside or outside. Each sample is decided exactly as by a ray of its own,
//! with planes in double precision that are the same for both triangles of an edge, so that
//! nothing leaks between them. The idea is that of Laine, Aila, Assarsson, Lehtinen and
//! Akenine-Möller, "Soft Shadow Volumes for Ray Tracing", 2005, with triangles in the place of
//! silhouette edges.
#![forbid(unsafe_code)]

mod bvh;
mod cone;
mod light_samples;
mod mask;
mod pcf;
mod pcss;
mod sampling;
mod shaft;
mod tracer;
pub mod truth;

pub use pcf::Pcf;
pub use pcss::Pcss;
pub use sampling::{Samples, point_lights};
pub use tracer::{Cutouts, RAY_OFFSET, Receivers, Tracer};
