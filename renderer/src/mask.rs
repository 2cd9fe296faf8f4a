//! The command `mask`: a shadow mask from depth buffers that another program has drawn.

pub mod buffer;
mod output;
mod views;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use glam::Vec3;
use raster::DepthBuffer;
use shadowmap_core::{Camera, DepthMap, Level, Projection, Surfaces, Threads, View};
use simd_search::{NodeGroup, Pyramid};
use single_sample::{LightMap, Texels, search};

use crate::Error;
use crate::picture::{check_places, write_file};
use crate::stats::timed;
use buffer::Buffer;
use output::Png;
use views::{ForeignView, Origin, Views};

/// Options of `mask`.
#[derive(Debug, Args)]
#[command(after_long_help = MASK_HELP)]
pub struct MaskArgs {
    /// The views of camera and light as JSON (see below).
    pub views: PathBuf,

    /// Depth that the camera sees: .npy, .pfm, .exr or .png (16-bit grey).
    #[arg(long, value_name = "FILE")]
    pub camera_depth: PathBuf,

    /// Depth that the light sees, from its centre.
    #[arg(long, value_name = "FILE")]
    pub light_depth: PathBuf,

    /// Object IDs that the camera sees; they tell where neighbouring pixels may be interpolated.
    #[arg(long, value_name = "FILE")]
    pub camera_ids: Option<PathBuf>,

    /// Geometric normals that the camera sees, in world space: .npy of shape (height, width, 3),
    /// .pfm or .exr. Without them, planes are derived from neighbouring depths, which fails on
    /// parts a pixel wide.
    #[arg(long, value_name = "FILE")]
    pub camera_normals: Option<PathBuf>,

    /// Object IDs that the light sees.
    #[arg(long, value_name = "FILE")]
    pub light_ids: Option<PathBuf>,

    /// Radius of a sphere light in metres, for a perspective light view.
    #[arg(long, value_name = "METRES", conflicts_with = "angle")]
    pub radius: Option<f32>,

    /// Angular diameter of a sun in degrees, for an orthographic light view.
    #[arg(long, value_name = "DEG")]
    pub angle: Option<f32>,

    /// The mask: .npy, .pfm, .exr (floats, 1 = lit) or .png.
    #[arg(short, long, value_name = "FILE", default_value = "mask.png")]
    pub output: PathBuf,

    /// What a .png holds: 8 or 16 bits, or black with the shadow as alpha.
    #[arg(long, value_enum, default_value = "8")]
    pub png: Png,

    /// Threads; by default all.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub threads: Option<u16>,

    /// Write how long it took, and what happened, as JSON.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,

    /// Refuse buffers that need more memory than this, in megabytes.
    #[arg(long, value_name = "MB", default_value = "8192")]
    pub max_memory: u32,
}

const MASK_HELP: &str = "\
The file of views:
  {
    \"depth\": \"opengl\",
    \"camera\": { \"projection\": [16 numbers], \"view\": [16 numbers] },
    \"light\": { \"clip_from_world\": [16 numbers], \"origin\": \"bottom-left\" }
  }
Matrices multiply column vectors: 16 numbers go column by column (glTF, OpenGL), four rows of four
are rows (NumPy). \"view\" is view from world, y up. \"depth\" and \"origin\" hold for both views, or
stand in one. What depth means:
  linear        metres along the view axis (orthographic: from the near plane)
  distance      metres from the eye along the ray
  opengl        0 to 1, z from -w to w
  zero-to-one   0 to 1, z from 0 to w (Direct3D, Vulkan, wgpu)
  reversed-z    1 to 0, z from 0 to w
A .png is divided by its greatest value.

Example:
  penumbra mask views.json --camera-depth camera.npy --light-depth light.npy --radius 0.5 \\
      -o mask.png";

/// A view, and the nearness and IDs of its buffers.
struct Seen {
    view: View,
    origin: Origin,
    map: DepthBuffer,
}

/// Reads a buffer, its top row first.
fn read(path: &Path, channels: usize, origin: Origin, max_memory: u64) -> Result<Buffer, Error> {
    let mut buffer = Buffer::read(path, channels, max_memory)?;
    buffer.bottom_up = origin == Origin::BottomLeft;
    Ok(buffer)
}

impl Seen {
    fn read(
        name: &str,
        views: &Views,
        foreign: &ForeignView,
        depth: &Path,
        ids: Option<&Path>,
        max_memory: u64,
    ) -> Result<Seen, Error> {
        let origin = views.origin(foreign);
        let buffer = read(depth, 1, origin, max_memory)?;
        let (width, height) = (buffer.width, buffer.height);
        let foreign = views.foreign_depth(name, foreign, [width, height])?;
        let mut map = DepthBuffer::new(width, height);
        let mut depths = vec![0.0; width as usize];
        for (y, row) in (0..height).zip(map.nearness.chunks_exact_mut(width as usize)) {
            buffer.floats(y, &mut depths);
            foreign.nearness_of_row(y, &depths, row);
        }
        if map.nearness.iter().all(|&nearness| nearness == 0.0) {
            return Err(Error::new(format_args!(
                "{}: there is nothing in it; is its depth of another kind?",
                depth.display()
            )));
        }
        if let Some(path) = ids {
            let ids = read(path, 1, origin, max_memory)?;
            check_size(path, &ids, &map)?;
            for (y, row) in (0..height).zip(map.payload.chunks_exact_mut(width as usize)) {
                ids.ids(y, row);
            }
        }
        Ok(Seen { view: *foreign.view(), origin, map })
    }

    fn normals(&self, path: &Path, max_memory: u64) -> Result<Vec<Vec3>, Error> {
        let buffer = read(path, 3, self.origin, max_memory)?;
        check_size(path, &buffer, &self.map)?;
        let mut normals = Vec::with_capacity(self.map.nearness.len());
        let mut row = vec![0.0; 3 * buffer.width as usize];
        for y in 0..buffer.height {
            buffer.floats(y, &mut row);
            normals.extend(row.as_chunks::<3>().0.iter().copied().map(Vec3::from_array));
        }
        Ok(normals)
    }
}

fn check_size(path: &Path, buffer: &Buffer, map: &DepthBuffer) -> Result<(), Error> {
    if (buffer.width, buffer.height) == (map.width(), map.height()) {
        return Ok(());
    }
    Err(Error::new(format_args!(
        "{}: {} x {} pixels beside a depth of {} x {}",
        path.display(),
        buffer.width,
        buffer.height,
        map.width(),
        map.height()
    )))
}

/// Computes and writes the mask.
///
/// # Errors
///
/// If an input cannot be used, or a file not be written. Nothing is written then.
pub fn mask(args: &MaskArgs) -> Result<(), Error> {
    check_places(&args.output, args.stats.as_deref())?;
    match args.threads {
        Some(1) => mask_on(args, Threads::One),
        threads => {
            let threads = threads.map_or(0, usize::from);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|error| Error::new(format_args!("--threads: {error}")))?;
            pool.install(|| mask_on(args, Threads::Pool))
        }
    }
}

fn mask_on(args: &MaskArgs, threads: Threads) -> Result<(), Error> {
    let start = Instant::now();
    let [mut read_time, mut pyramid_time, mut shadow] = [Duration::ZERO; 3];
    let (camera, normals, light) = timed(&mut read_time, || {
        let most = u64::from(args.max_memory) << 20;
        let views = Views::read(&args.views)?;
        let ids = args.camera_ids.as_deref();
        let camera = Seen::read("camera", &views, &views.camera, &args.camera_depth, ids, most)?;
        let normals = args.camera_normals.as_deref();
        let normals = normals.map(|path| camera.normals(path, most)).transpose()?;
        let ids = args.light_ids.as_deref();
        let light = Seen::read("light", &views, &views.light, &args.light_depth, ids, most)?;
        Ok::<_, Error>((camera, normals, light))
    })?;
    let parameters = parameters(args, &light.view)?;
    check_plausible(&camera, &light)?;

    let level = Level::detect();
    let map: DepthMap<'_> = light.map.as_depth_map();
    let mut storage = Vec::new();
    let pyramid = timed(&mut pyramid_time, || {
        storage.resize(Pyramid::storage_len(map.width(), map.height()), NodeGroup::default());
        Pyramid::build(level, map, &mut storage, &mut [])
    });
    let pyramid = pyramid.map_err(Error::new)?;
    let (width, height) = (camera.map.width(), camera.map.height());
    let mut values = vec![0.0_f32; camera.map.nearness.len()];
    let normals = normals.map_or_else(
        || {
            let mut normals = vec![Vec3::ZERO; values.len()];
            let seen = camera.map.as_depth_map();
            let seen = Camera::new(&camera.view, seen, Surfaces::FromDepth).map_err(Error::new)?;
            timed(&mut shadow, || seen.normals_from_depth(threads, &mut normals));
            Ok::<_, Error>(normals)
        },
        Ok,
    )?;
    let surfaces = Surfaces::Normals(&normals);
    let receivers = Camera::new(&camera.view, camera.map.as_depth_map(), surfaces);
    let receivers = receivers.map_err(Error::new)?;
    let light_map = LightMap::new(&light.view, Texels::Plain(map)).map_err(Error::new)?;
    let counters = timed(&mut shadow, || {
        search::visibility(
            level,
            threads,
            &receivers,
            &light_map,
            &pyramid,
            &parameters,
            &mut values,
        )
    });
    // Where there is nothing there is no shadow to lay over it.
    for (value, &nearness) in values.iter_mut().zip(&camera.map.nearness) {
        if nearness == 0.0 {
            *value = 1.0;
        }
    }
    let file = output::encode(&args.output, [width, height], values, args.png)?;
    write_file(&args.output, &file)?;
    if let Some(path) = &args.stats {
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        let json = serde_json::json!({
            "version": env!("CARGO_PKG_VERSION"),
            "size": [width, height],
            "map_size": [map.width(), map.height()],
            "simd": level.kind().name(),
            "ms": {
                "read": ms(read_time),
                "pyramid": ms(pyramid_time),
                "shadow": ms(shadow),
                "total": ms(start.elapsed()),
            },
            "counters": {
                "receivers": counters.receivers,
                "searches": counters.searches,
                "cut_by_border": counters.cut_by_border,
                "outside": counters.outside,
            },
        });
        write_file(path, format!("{json:#}\n").as_bytes())?;
    }
    Ok(())
}

/// The size of the light, in the unit that its view asks for.
fn parameters(args: &MaskArgs, view: &View) -> Result<search::Parameters, Error> {
    let radius = match (view.projection(), args.radius, args.angle) {
        (Projection::Perspective, Some(radius), None) => radius,
        (Projection::Orthographic, None, Some(degrees)) => {
            libm::tan(f64::from(degrees).to_radians() * 0.5) as f32
        }
        (Projection::Perspective, ..) => {
            return Err(Error::new("the light's view is a perspective one: give --radius METRES"));
        }
        (Projection::Orthographic, ..) => {
            return Err(Error::new("the light's view is an orthographic one: give --angle DEG"));
        }
    };
    if !(radius.is_finite() && radius >= 0.0) {
        return Err(Error::new("the size of the light must be a number from 0"));
    }
    Ok(search::Parameters { radius, ..search::Parameters::default() })
}

/// Checks that the light's map and the camera's show one scene.
fn check_plausible(camera: &Seen, light: &Seen) -> Result<(), Error> {
    let width = camera.map.width() as usize;
    let is_inside = |(index, &nearness): (usize, &f32)| {
        let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        let point = light.view.texel_from_world(camera.view.world_from_texel(x, y, nearness));
        nearness > 0.0
            && point.is_some_and(|p| {
                (0.0..light.view.width() as f32).contains(&p.x)
                    && (0.0..light.view.height() as f32).contains(&p.y)
            })
    };
    if camera.map.nearness.iter().enumerate().any(is_inside) {
        return Ok(());
    }
    Err(Error::new(
        "none of the points that the camera sees lies in the light's map: check that both matrices \
         start from the same world, that 16 numbers go column by column, and what \"depth\" means",
    ))
}
