//! The options of the program.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::mask::MaskArgs;

/// Soft shadows on the CPU, from depth maps.
#[derive(Debug, Parser)]
#[command(name = "penumbra", version, about, long_about = None, max_term_width = 100)]
#[command(after_help = "\
Examples:
  penumbra render                              the show scene, to penumbra.png
  penumbra render model.glb --fit -o model.png a model on a ground, seated and lit
  penumbra render torus --light sphere:1.5,6,1.5:0.5 --pass visibility -o v.exr
  penumbra compare a.png b.png --diff difference.png

`penumbra render --help` explains scenes, lights, methods and passes.")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a picture with soft shadows.
    Render(Box<RenderArgs>),
    /// Measure how far apart two pictures are, as JSON.
    Compare(CompareArgs),
    /// A shadow mask from depth buffers that another program has drawn.
    Mask(Box<MaskArgs>),
}

/// Options of `render`. Values are text here: what is wrong with one is said in one line and ends
/// in exit code 1.
#[derive(Debug, Args)]
#[command(after_long_help = RENDER_EXAMPLES)]
pub struct RenderArgs {
    /// A built-in scene (torus, blocker, crowded, grille, show) or a .glb, .gltf or .obj file.
    ///
    /// Without it, `show` is drawn: a knot between a sphere light and a linear light.
    pub scene: Option<String>,

    /// The picture to write: .png or .jpg for the screen, .exr or .pfm for numbers.
    #[arg(short, long, value_name = "FILE", default_value = "penumbra.png")]
    pub output: PathBuf,

    /// What to write: beauty, visibility, depth, ids, normals, light-depth, light-ids,
    /// visibility-channel.
    ///
    /// beauty: the shaded picture.
    /// visibility: the fraction of the light that each pixel sees, the mean over all lights.
    /// depth: metres along the camera's axis. ids: object IDs. normals: world space.
    /// light-depth, light-ids: the first depth maps of the first light.
    /// visibility-channel: those of --method skins, one sample below the other.
    #[arg(long, value_name = "PASS", default_value = "beauty", verbatim_doc_comment)]
    pub pass: String,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    pub size: String,

    /// Antialiasing: N x N samples per pixel, from 1 to 16 (beauty and visibility). N times a side
    /// of the picture is at most 16384.
    #[arg(long, value_name = "N", default_value = "1")]
    pub aa: String,

    /// Where the camera stands. By default the scene's own camera, else one that sees all of it.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub eye: Option<String>,

    /// What the camera looks at.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub target: Option<String>,

    /// Vertical field of view of the camera in degrees.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub fov: Option<String>,

    /// Scale a loaded model to 4 m, seat it on a ground, and set up camera and lights for that.
    #[arg(long)]
    pub fit: bool,

    /// Put a ground under the scene.
    #[arg(long)]
    pub ground: bool,

    /// A light; may be given more than once. By default the scene's own, else one above it.
    ///
    /// point:x,y,z                        no penumbra
    /// sphere:x,y,z:RADIUS                metres
    /// sun:dx,dy,dz:DEGREES               the way it shines, and its angular diameter
    /// linear:x,y,z:x,y,z                 from one end to the other
    /// triangle:x,y,z:x,y,z:x,y,z         three corners
    /// rect:x,y,z:ex,ey,ez:ex,ey,ez       a corner and two edges
    #[arg(long, value_name = "SPEC", verbatim_doc_comment)]
    pub light: Vec<String>,

    /// Aim the lights' depth maps by hand at this point, with --light-fov.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "light_fov")]
    pub light_target: Option<String>,

    /// The angle of the lights' square frustum in degrees, with --light-target.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, requires = "light_target")]
    pub light_fov: Option<String>,

    /// How shadows are found. By default the best for each light.
    ///
    /// search         point, sphere, sun: one map (Brabec and Seidel 2002), any number of edges
    /// intervals      linear, triangle, rect: all that maps from both ends know of the light
    /// skins          linear: --samples maps (Heidrich, Brabec and Seidel 2000)
    /// hard           one shadow map from the light's middle (Williams 1978)
    /// point-samples  --samples hard maps, averaged: the papers' baseline
    /// search-paper   like search, with the paper's --r-scale, --r-bias, --r-shrink
    /// pcf            percentage-closer filtering (Reeves et al. 1987)
    /// pcss           sphere, sun: percentage-closer soft shadows (Fernando 2005)
    /// ray-traced     --samples rays per pixel: the truth
    #[arg(long, value_name = "METHOD", verbatim_doc_comment)]
    pub method: Option<String>,

    /// Light maps are N x N texels.
    #[arg(long, value_name = "N", default_value = "1024")]
    pub map_size: String,

    /// Samples of the light: maps of skins (2 or more, by default 3), maps of intervals (2 or more,
    /// by default `adaptive`: 2, and more where a map between two of them shows what they do not),
    /// lines of intervals across a triangle or rect (8), maps of point-samples (16), rays per pixel
    /// of ray-traced (256).
    #[arg(long, value_name = "N")]
    pub samples: Option<String>,

    /// search-paper: search radius per metre from the light, in texels.
    #[arg(long, value_name = "TEXELS", allow_hyphen_values = true)]
    pub r_scale: Option<String>,

    /// search-paper: search radius at the light, in texels.
    #[arg(long, value_name = "TEXELS", allow_hyphen_values = true)]
    pub r_bias: Option<String>,

    /// search-paper: factor on the radius per metre between blocker and receiver.
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    pub r_shrink: Option<String>,

    /// Instructions to use: auto, scalar, sse4.1, avx2, avx512, neon, simd128. Never changes a bit
    /// of the result.
    #[arg(long, value_name = "LEVEL", default_value = "auto")]
    pub simd: String,

    /// Threads; 1 = no thread pool. Never changes a bit of the result. By default all.
    #[arg(long, value_name = "N")]
    pub threads: Option<String>,

    /// Write what was done, and how long it took, as JSON.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,

    /// Render N times; --stats then holds the times of every repetition.
    #[arg(long, value_name = "N", default_value = "1")]
    pub repeat: String,

    /// Refuse models, pictures and maps that need more memory than this, in megabytes.
    #[arg(long, value_name = "MB", default_value = "8192")]
    pub max_memory: String,

    /// Refuse models with more triangles than this, all instances counted.
    #[arg(long, value_name = "N", default_value = "50000000")]
    pub max_triangles: String,
}

const RENDER_EXAMPLES: &str = "\
Examples:
  penumbra render crowded --size 1280x720 --aa 2 -o crowded.png
  penumbra render blocker --light linear:-1,4,0:1,4,0 --method point-samples --samples 64 \\
      --pass visibility -o blocker.pfm
  penumbra render model.gltf --ground --light sun:-1,-2,-1:0.53 --eye 4,3,6 --target 0,1,0
  penumbra render torus --method ray-traced --samples 4096 --pass visibility -o truth.exr

World: metres, right-handed, y up. Exit code: 0 done, 1 an input is bad (one line says which),
2 wrong usage.";

/// Options of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Prints one JSON object: rmse, max (and max_at: column, row), penumbra_rmse and penumbra_pixels
(pixels where the reference lies between 0.002 and 0.998), not_finite (pixels left out), flip.")]
pub struct CompareArgs {
    /// A picture: png, jpg, exr or pfm.
    pub a: PathBuf,

    /// Another one of the same size: the reference.
    pub b: PathBuf,

    /// A third one that says where the penumbra is, instead of B.
    #[arg(long, value_name = "R")]
    pub reference: Option<PathBuf>,

    /// Write the absolute difference: numbers to .exr and .pfm, colours from 0 to 0.25 to .png.
    #[arg(long, value_name = "FILE")]
    pub diff: Option<PathBuf>,

    /// Refuse pictures that need more memory than this, in megabytes.
    #[arg(long, value_name = "MB", default_value = "8192")]
    pub max_memory: u32,
}
