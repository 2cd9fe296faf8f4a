//! Where a map is taken from.

use glam::{DMat4, DVec3, DVec4, Mat4, Vec2, Vec3};

/// How a view projects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Projection {
    /// Through a pin-hole. Nearness is 1 / z.
    Perspective,
    /// Along parallel rays. Nearness is the distance in front of the view's far plane.
    Orthographic,
}

/// The part of the image plane that a map covers, not necessarily centred on the view axis
/// ("off-axis"). x grows to the right, y downwards. In tangents for a perspective view (the image
/// plane at distance 1), in metres for an orthographic one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Left edge.
    pub left: f32,
    /// Top edge.
    pub top: f32,
    /// Right edge, greater than `left`.
    pub right: f32,
    /// Bottom edge, greater than `top`.
    pub bottom: f32,
}

impl Window {
    /// The window from -`half_width` to `half_width` and from -`half_height` to `half_height`.
    #[must_use]
    pub fn centered(half_width: f32, half_height: f32) -> Window {
        Window { left: -half_width, top: -half_height, right: half_width, bottom: half_height }
    }
}

/// A light's or a camera's view, and the size of the map taken from it.
///
/// A view maps world space to *texel space* (u, v, n): texel coordinates u, v and the
/// **nearness** n. It is a projective map, given as four rows U, V, N, Q over (x, y, z, 1), with
/// `u = U / Q`, `v = V / Q`, `n = N / Q`. With z the depth along the view axis:
///
/// | projection | n | N | Q |
/// |---|---|---|---|
/// | perspective | 1 / z | 1 | z |
/// | orthographic | far - z | far - z | 1 |
///
/// Nearness grows towards the viewer and is 0 where there is nothing. It is the choice that makes
/// planes affine in the image for both projections: every stage (rasterization, shadow tests,
/// disparity, penumbra radii, receiver planes) is linear in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    projection: Projection,
    width: u32,
    height: u32,
    texel_from_world: [[f32; 4]; 4],
    world_from_texel: [[f32; 4]; 4],
    eye: [f32; 4],
    axes: [Vec3; 3],
    focal: Vec2,
    max_nearness: f32,
}

impl View {
    /// A pin-hole camera with a square texel and a centred window, `vertical_fov` in radians,
    /// between 0 and pi. Geometry nearer than `near` metres (along the view axis), which must be
    /// positive, is not seen. Out of these ranges, as with a size of 0 or numbers that are not
    /// finite, nothing panics, but what the view maps to means nothing.
    ///
    /// ```
    /// use glam::Vec3;
    /// use shadowmap_core::View;
    /// let view = View::perspective(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, 1.0, 640, 480, 0.1);
    /// let seen = view.texel_from_world(Vec3::ZERO).unwrap();
    /// assert_eq!((seen.x, seen.y), (320.0, 240.0));
    /// assert_eq!(seen.z, 0.25); // nearness: 1 / (4 metres)
    /// ```
    #[must_use]
    pub fn perspective(
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        vertical_fov: f32,
        width: u32,
        height: u32,
        near: f32,
    ) -> View {
        let half_height = libm::tan(f64::from(vertical_fov) * 0.5) as f32;
        let half_width = half_height * width as f32 / height as f32;
        let window = Window::centered(half_width, half_height);
        let [right, down, forward] = axes(target - eye, up);
        View::perspective_window(eye, [right, down, forward], window, width, height, near)
    }

    /// A perspective view through any window. `axes` are the unit vectors right, down and forward
    /// of the view, as [`View::axes_towards`] makes them; `near` is as in [`View::perspective`].
    #[must_use]
    pub fn perspective_window(
        eye: Vec3,
        axes: [Vec3; 3],
        window: Window,
        width: u32,
        height: u32,
        near: f32,
    ) -> View {
        View::new(Projection::Perspective, [eye; 2], axes, window, width, height, [near, 0.0])
    }

    /// One of several rectified views: perspective views from places along one line, the x axis of
    /// all, with the same image plane and window. This is the one from `eye`; `first` is the place
    /// of one of them, the same for all.
    ///
    /// Such views share the rows V, N and Q, and U but for its constant. That holds to the last
    /// bit: whatever `eye` is off the line, by rounding, counts for nothing. So what the views
    /// share can be computed once.
    #[must_use]
    pub fn perspective_rectified(
        first: Vec3,
        eye: Vec3,
        axes: [Vec3; 3],
        window: Window,
        width: u32,
        height: u32,
        near: f32,
    ) -> View {
        let eyes = [eye, first];
        View::new(Projection::Perspective, eyes, axes, window, width, height, [near, 0.0])
    }

    /// An orthographic view of what lies between the depths `near` and `far`, in metres from `eye`
    /// along the view axis (either may be negative, `far` must be the greater).
    #[must_use]
    pub fn orthographic_window(
        eye: Vec3,
        axes: [Vec3; 3],
        window: Window,
        width: u32,
        height: u32,
        [near, far]: [f32; 2],
    ) -> View {
        View::new(Projection::Orthographic, [eye; 2], axes, window, width, height, [near, far])
    }

    /// The unit vectors right, down and forward of a view along `forward` with `up` upwards in the
    /// image. If the two are parallel, some other up is taken.
    #[must_use]
    pub fn axes_towards(forward: Vec3, up: Vec3) -> [Vec3; 3] {
        axes(forward, up)
    }

    /// The second of the eyes stands for the first across the x axis.
    fn new(
        projection: Projection,
        [eye, across]: [Vec3; 2],
        axes: [Vec3; 3],
        window: Window,
        width: u32,
        height: u32,
        [near, far]: [f32; 2],
    ) -> View {
        let [right, down, forward] = axes.map(Vec3::as_dvec3);
        let (eye64, across64) = (eye.as_dvec3(), across.as_dvec3());
        let (near, far) = (f64::from(near), f64::from(far));
        let span_x = f64::from(window.right) - f64::from(window.left);
        let span_y = f64::from(window.bottom) - f64::from(window.top);
        let (fx, fy) = (f64::from(width) / span_x, f64::from(height) / span_y);
        let (cx, cy) = (-f64::from(window.left) * fx, -f64::from(window.top) * fy);
        // World to view coordinates x (right), y (down), z (forward), each a row over (p, 1).
        let row = |axis: DVec3, from: DVec3| axis.extend(-axis.dot(from));
        let (x, y, z) = (row(right, eye64), row(down, across64), row(forward, across64));
        let one = DVec4::W;
        let (n, q) = match projection {
            Projection::Perspective => (one, z),
            Projection::Orthographic => (one * far - z, one),
        };
        let rows = [x * fx + q * cx, y * fy + q * cy, n, q];
        // The inverse, written down: image plane position times z (or 1) along the axes.
        let base = -right * (cx / fx) - down * (cy / fy);
        let columns = match projection {
            // X / W with W = n: (dx (u-cx)/fx + dy (v-cy)/fy + dz + eye n) / n.
            Projection::Perspective => [
                (right / fx).extend(0.0),
                (down / fy).extend(0.0),
                eye64.extend(1.0),
                (base + forward).extend(0.0),
            ],
            Projection::Orthographic => [
                (right / fx).extend(0.0),
                (down / fy).extend(0.0),
                (-forward).extend(0.0),
                (base + eye64 + forward * far).extend(1.0),
            ],
        };
        let (eye, max_nearness) = match projection {
            Projection::Perspective => (eye.extend(1.0), 1.0 / near),
            Projection::Orthographic => ((-axes[2]).extend(0.0), far - near),
        };
        View {
            projection,
            width,
            height,
            texel_from_world: rows.map(|r| r.as_vec4().to_array()),
            world_from_texel: rows_of(columns),
            eye: eye.to_array(),
            axes,
            focal: Vec2::new(fx as f32, fy as f32),
            max_nearness: max_nearness as f32,
        }
    }

    /// A view from the `clip_from_world` matrix of another renderer (column vectors, clip x to the
    /// right and y upwards, both from -w to w). `depth_range` holds the normalized depth of
    /// the near and of the far plane: `[0, 1]` (Direct3D, Vulkan, wgpu), `[-1, 1]` (OpenGL),
    /// `[1, 0]` (reversed z). The far plane may be at infinity.
    ///
    /// `None` if the matrix is singular, not finite, or its w row is neither constant
    /// (orthographic) nor a direction (perspective).
    #[must_use]
    pub fn from_clip(
        clip_from_world: Mat4,
        depth_range: [f32; 2],
        width: u32,
        height: u32,
    ) -> Option<View> {
        let clip = clip_from_world.as_dmat4();
        let [row_x, row_y, row_z, row_w] = [clip.row(0), clip.row(1), clip.row(2), clip.row(3)];
        let [ndc_near, ndc_far] = depth_range.map(f64::from);
        let perspective = row_w.truncate() != DVec3::ZERO;
        // Scale so that Q is metric depth (perspective) or 1 (orthographic).
        let scale = if perspective { row_w.truncate().length() } else { row_w.w };
        let u = (row_x + row_w) * (f64::from(width) * 0.5 / scale);
        let v = (row_w - row_y) * (f64::from(height) * 0.5 / scale);
        let q = row_w / scale;
        let forward = if perspective {
            q.truncate()
        } else {
            (row_z.truncate() * (ndc_far - ndc_near).signum()).normalize_or_zero()
        };
        // Normalized depth is affine in nearness: in 1 / z (perspective) or in z (orthographic).
        let depth_scale = row_z.truncate().length() / scale;
        let (n, max_nearness) = if perspective {
            // z_clip = a w + b  =>  ndc = a + b n with n = 1 / depth.
            let a = row_z.truncate().dot(row_w.truncate()) / row_w.truncate().length_squared();
            let b = (row_z.w - a * row_w.w) / scale;
            (DVec4::W, (ndc_near - a) / b)
        } else {
            let toward_near = (ndc_far - ndc_near).signum();
            let n = (DVec4::W * ndc_far - row_z / scale) * (toward_near / depth_scale);
            (n, (ndc_far - ndc_near).abs() / depth_scale)
        };
        let rows = [u, v, n, q];
        let matrix = DMat4::from_cols(u, v, n, q).transpose();
        let inverse = matrix.inverse();
        let finite = rows.iter().all(|r| r.is_finite()) && inverse.is_finite();
        if !finite || matrix.determinant() == 0.0 || max_nearness.is_nan() || max_nearness <= 0.0 {
            return None;
        }
        // The eye is the point with N-axis direction: texel space (0, 0, 1, 0) in both cases.
        let eye = inverse.z_axis;
        let eye = if perspective { eye / eye.w } else { (-forward).extend(0.0) };
        // Along the image: what is left of a row without its part along the view axis.
        let across = |row: DVec4| row.truncate() - forward * row.truncate().dot(forward);
        let (along_u, along_v) = (across(u), across(v));
        let (right, down) = (along_u.normalize_or_zero(), along_v.normalize_or_zero());
        let focal = Vec2::new(along_u.length() as f32, along_v.length() as f32);
        Some(View {
            projection: if perspective {
                Projection::Perspective
            } else {
                Projection::Orthographic
            },
            width,
            height,
            texel_from_world: rows.map(|r| r.as_vec4().to_array()),
            world_from_texel: rows_of([
                inverse.x_axis,
                inverse.y_axis,
                inverse.z_axis,
                inverse.w_axis,
            ]),
            eye: eye.as_vec4().to_array(),
            axes: [right.as_vec3(), down.as_vec3(), forward.as_vec3()],
            focal,
            max_nearness: max_nearness as f32,
        })
    }

    /// How the view projects.
    #[must_use]
    pub fn projection(&self) -> Projection {
        self.projection
    }
    /// Texels per row of the map.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Rows of the map.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }
    /// The rows U, V, N, Q of the projective map from world to texel space, each over (x, y, z, 1).
    /// Kernels evaluate a row as `((r[0] * x + r[1] * y) + r[2] * z) + r[3]`.
    #[must_use]
    pub fn rows(&self) -> &[[f32; 4]; 4] {
        &self.texel_from_world
    }
    /// The rows X, Y, Z, W of the inverse map, each over (u, v, n, 1); a world position is
    /// (X, Y, Z) / W.
    #[must_use]
    pub fn inverse_rows(&self) -> &[[f32; 4]; 4] {
        &self.world_from_texel
    }
    /// The centre of projection as a homogeneous point: (position, 1) for a perspective view,
    /// (unit direction towards the viewer, 0) for an orthographic one.
    #[must_use]
    pub fn eye(&self) -> [f32; 4] {
        self.eye
    }
    /// The unit vectors right, down and forward of the view.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        self.axes
    }
    /// Focal length in texels, along u and v: texels per unit tangent (perspective) or per metre
    /// (orthographic).
    ///
    /// A sphere light of radius R at the eye of a perspective view has the penumbra radius
    /// `focal * R * (n_blocker - n_receiver)` texels; a sun of angular diameter `a` in an
    /// orthographic view `focal * tan(a / 2) * (n_blocker - n_receiver)`.
    #[must_use]
    pub fn focal(&self) -> Vec2 {
        self.focal
    }
    /// The nearness of the near plane; nothing nearer is drawn.
    #[must_use]
    pub fn max_nearness(&self) -> f32 {
        self.max_nearness
    }

    /// Texel coordinates u, v and nearness of a world position; `None` behind the viewer.
    #[must_use]
    pub fn texel_from_world(&self, position: Vec3) -> Option<Vec3> {
        let [u, v, n, q] = self.homogeneous_texel(position);
        (q > 0.0).then(|| Vec3::new(u / q, v / q, n / q))
    }

    /// The homogeneous texel-space coordinates U, V, N, Q of a world position.
    #[must_use]
    pub fn homogeneous_texel(&self, p: Vec3) -> [f32; 4] {
        self.texel_from_world.map(|r| ((r[0] * p.x + r[1] * p.y) + r[2] * p.z) + r[3])
    }

    /// The world position at texel coordinates u, v with the given nearness, which must not be 0
    /// for a perspective view (that is at infinity: the result is then not finite).
    #[must_use]
    pub fn world_from_texel(&self, u: f32, v: f32, nearness: f32) -> Vec3 {
        let [x, y, z, w] =
            self.world_from_texel.map(|r| ((r[0] * u + r[1] * v) + r[2] * nearness) + r[3]);
        Vec3::new(x / w, y / w, z / w)
    }

    /// Depth in metres along the view axis: from the eye (perspective) or from the near plane
    /// (orthographic).
    #[must_use]
    pub fn depth_from_nearness(&self, nearness: f32) -> f32 {
        match self.projection {
            Projection::Perspective => 1.0 / nearness,
            Projection::Orthographic => self.max_nearness - nearness,
        }
    }
}

fn rows_of(columns: [DVec4; 4]) -> [[f32; 4]; 4] {
    let transposed = DMat4::from_cols(columns[0], columns[1], columns[2], columns[3]).transpose();
    [transposed.x_axis, transposed.y_axis, transposed.z_axis, transposed.w_axis]
        .map(|r| r.as_vec4().to_array())
}

/// Right, down, forward, computed in double precision so that they are orthonormal to the last
/// bit that single precision can hold.
fn axes(forward: Vec3, up: Vec3) -> [Vec3; 3] {
    let forward = forward.as_dvec3().normalize_or(DVec3::NEG_Z);
    let cross = forward.cross(up.as_dvec3());
    let right = if cross.length_squared() > 1e-12 * up.as_dvec3().length_squared() {
        cross.normalize()
    } else {
        forward.any_orthonormal_vector()
    };
    let down = forward.cross(right);
    [right.as_vec3(), down.as_vec3(), forward.as_vec3()]
}
