//! The part of a light's image plane that matters to its shadows.

/// A point on a view's image plane: x and y, in tangents (perspective) or metres (orthographic),
/// and its nearness.
pub type ImagePoint = [f64; 3];

/// Left, top, right and bottom on an image plane.
pub type Extents = [f64; 4];

/// How the image of one point moves about as a light that is no point is looked at from all over
/// it, along x and y, per unit of nearness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// From the view's eye to where maps are taken from: 0 for a light with one map, half the
    /// length of a linear light along x.
    pub views: [f64; 2],
    /// Between the image of a blocker and that of a receiver that it hides from a part of the
    /// light, per unit of difference in nearness: the radius of a sphere; for a sun the tangent of
    /// half its angular diameter; the length of a linear light along x.
    pub shadow: [f64; 2],
}

/// The part of the image plane that a light's maps must hold: where `blockers` can throw a shadow,
/// as far as it falls onto `receivers`, and what throws it. Both are the corners of triangles, or
/// points whose convex hulls hold them. Receivers outside are lit, and a map of no more than this
/// has its texels where they count.
///
/// Give `None` for a set of which some point lies beside or behind the eye. What is not bounded
/// then is infinite. `None` if nothing is bounded or there are no points.
///
/// ```
/// use shadowmap_core::{Spread, fit_extents};
/// // A blocker of 2 m, 2 m below a light with a radius of half a metre, and a ground 4 m below it.
/// let blocker = [[-0.5, -0.5, 0.5], [0.5, 0.5, 0.5]];
/// let ground = [[-2.0, -2.0, 0.25], [2.0, 2.0, 0.25]];
/// let sphere = Spread { shadow: [0.5; 2], ..Spread::default() };
/// let extents = fit_extents(Some(blocker.into_iter()), Some(ground.into_iter()), sphere);
/// assert_eq!(extents, Some([-0.625, -0.625, 0.625, 0.625]));
/// ```
pub fn fit_extents<P>(blockers: Option<P>, receivers: Option<P>, spread: Spread) -> Option<Extents>
where
    P: Iterator<Item = ImagePoint> + Clone,
{
    let grown = |points: P, differs: &dyn Fn(f64) -> f64| {
        points.fold(NOTHING, |extents, [x, y, n]| {
            let difference = differs(n).max(0.0);
            let half = |axis: usize| match spread.shadow[axis] {
                0.0 => spread.views[axis] * n,
                shadow => spread.views[axis] * n + shadow * difference,
            };
            let (dx, dy) = (half(0), half(1));
            union(extents, [x - dx, y - dy, x + dx, y + dy])
        })
    };
    let extents = match (blockers, receivers) {
        (Some(blockers), Some(receivers)) => {
            let least = receivers.clone().map(|p| p[2]).fold(f64::INFINITY, f64::min);
            let most = blockers.clone().map(|p| p[2]).fold(0.0, f64::max);
            let here = |_: f64| 0.0;
            let all = union(grown(blockers.clone(), &here), grown(receivers.clone(), &here));
            let shadows = grown(blockers, &|n| n - least);
            let casters = grown(receivers, &|n| most - n);
            intersection(intersection(shadows, casters), all)
        }
        (Some(blockers), None) => grown(blockers, &|n| n),
        // The image of a blocker right beside the eye can be anywhere.
        (None, Some(receivers)) => grown(receivers, &|_| f64::INFINITY),
        (None, None) => return None,
    };
    (extents[0] <= extents[2] && extents[1] <= extents[3]).then_some(extents)
}

/// Extents of no points.
const NOTHING: Extents = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];

fn union(a: Extents, b: Extents) -> Extents {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

/// What two extents share; of those that share nothing, a point or an edge of the first.
fn intersection(a: Extents, b: Extents) -> Extents {
    let inside = |value: f64, axis: usize| value.max(a[axis]).min(a[axis + 2]);
    [inside(b[0], 0), inside(b[1], 1), inside(b[2], 0), inside(b[3], 1)]
}
