//! The views of foreign depth buffers, as JSON.

use std::fs;
use std::path::Path;

use glam::{DMat4, Mat4};
use serde::Deserialize;
use shadowmap_core::{DepthConvention, ForeignDepth};

use crate::Error;

/// The longest file of views.
const MAX_LENGTH: u64 = 1 << 20;

/// What the file of views says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Views {
    /// The camera's view.
    pub camera: ForeignView,
    /// The light's view.
    pub light: ForeignView,
    /// The meaning of depth in both, unless a view says otherwise.
    depth: Option<Depth>,
    /// Where the first row of both buffers is, unless a view says otherwise.
    #[serde(default)]
    origin: Origin,
}

/// One view: `clip_from_world`, or `projection` and `view` whose product it is.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForeignView {
    clip_from_world: Option<Matrix>,
    projection: Option<Matrix>,
    view: Option<Matrix>,
    depth: Option<Depth>,
    origin: Option<Origin>,
}

/// A matrix that multiplies column vectors: 16 numbers column by column, as in glTF and OpenGL, or
/// four rows of four, as NumPy prints it.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
enum Matrix {
    Columns([f64; 16]),
    Rows([[f64; 4]; 4]),
}

impl Matrix {
    fn get(&self) -> DMat4 {
        match self {
            Matrix::Columns(columns) => DMat4::from_cols_array(columns),
            Matrix::Rows(rows) => DMat4::from_cols_array_2d(rows).transpose(),
        }
    }
}

/// [`DepthConvention`] by name.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Depth {
    Linear,
    Distance,
    Opengl,
    ZeroToOne,
    ReversedZ,
}

/// Which row of a buffer comes first.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// The top one, as in picture files.
    #[default]
    TopLeft,
    /// The bottom one, as OpenGL reads back.
    BottomLeft,
}

impl Views {
    /// Reads the file of views.
    ///
    /// # Errors
    ///
    /// If it cannot be read or does not say what it must; the message names it.
    pub fn read(path: &Path) -> Result<Views, Error> {
        let wrong =
            |why: &dyn std::fmt::Display| Error::new(format_args!("{}: {why}", path.display()));
        let length = fs::metadata(path).map_err(|error| wrong(&error))?.len();
        if length > MAX_LENGTH {
            return Err(wrong(&format!("{length} bytes are too many for two matrices")));
        }
        let text = fs::read(path).map_err(|error| wrong(&error))?;
        serde_json::from_slice(&text).map_err(|error| wrong(&error))
    }

    /// Where the first row of a view's buffer is.
    #[must_use]
    pub fn origin(&self, view: &ForeignView) -> Origin {
        view.origin.unwrap_or(self.origin)
    }

    /// The view of a buffer of that size. `name` is `camera` or `light`.
    ///
    /// # Errors
    ///
    /// If the matrices are missing, or are not those of a camera.
    pub fn foreign_depth(
        &self,
        name: &str,
        view: &ForeignView,
        [width, height]: [u32; 2],
    ) -> Result<ForeignDepth, Error> {
        let convention = match view.depth.or(self.depth) {
            Some(Depth::Linear) => DepthConvention::Linear,
            Some(Depth::Distance) => DepthConvention::Distance,
            Some(Depth::Opengl) => DepthConvention::OpenGl,
            Some(Depth::ZeroToOne) => DepthConvention::ZeroToOne,
            Some(Depth::ReversedZ) => DepthConvention::ReversedZ,
            None => {
                return Err(Error::new(format_args!(
                    "{name}: say what depth means: \"depth\": \"linear\", \"distance\", \"opengl\", \
                     \"zero-to-one\" or \"reversed-z\""
                )));
            }
        };
        let matrix = match (&view.clip_from_world, &view.projection, &view.view) {
            (Some(matrix), None, None) => matrix.get(),
            (None, Some(projection), Some(view)) => projection.get() * view.get(),
            _ => {
                return Err(Error::new(format_args!(
                    "{name}: give \"clip_from_world\", or \"projection\" and \"view\" \
                     (view from world)"
                )));
            }
        };
        let clip = |matrix: DMat4| Mat4::from_cols_array(&matrix.to_cols_array().map(|x| x as f32));
        ForeignDepth::new(clip(matrix), convention, width, height).ok_or_else(|| {
            let other = ForeignDepth::new(clip(matrix.transpose()), convention, width, height);
            let hint = match other {
                Some(_) => "; its transpose is: 16 numbers go column by column, rows are nested",
                None => "; it must map world space to clip space",
            };
            Error::new(format_args!("{name}: the matrix is not that of a camera{hint}"))
        })
    }
}
