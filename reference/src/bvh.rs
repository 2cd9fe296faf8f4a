//! The triangles of a scene in a bounding volume hierarchy, and how rays and shafts walk it.

use std::time::Duration;

use glam::{DVec3, Vec3};
use obvhs::{BvhBuildParams, bvh2::builder::build_bvh2_from_tris, triangle::Triangle};
use shadowmap_core::Mesh;

use crate::cone::Cone;
pub(crate) use crate::shaft::Shaft;

/// Coordinates beyond this many metres overflow the bounds of the hierarchy.
const FARTHEST: f32 = 1e12;

#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    /// First child, its sibling follows; or first triangle.
    first: u32,
    high: Vec3,
    /// Triangles of a leaf, 0 for an inner node.
    count: u32,
}

/// A triangle in leaf order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub corners: [Vec3; 3],
    /// Its index in the mesh.
    pub triangle: u32,
}

impl Leaf {
    fn seen_from(&self, eye: DVec3) -> [DVec3; 3] {
        self.corners.map(|corner| corner.as_dvec3() - eye)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// The largest coordinate.
    extent: f64,
}

/// Nodes still to visit.
pub(crate) type Stack = Vec<u32>;

impl Bvh {
    pub fn new(mesh: &Mesh<'_>) -> Bvh {
        let corners = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| mesh.positions.get(i as usize).copied());
            let corners = [a?, b?, c?];
            corners.iter().all(|p| p.abs().cmple(Vec3::splat(FARTHEST)).all()).then_some(corners)
        };
        let all: Vec<Leaf> = (0u32..)
            .zip(mesh.triangles)
            .filter_map(|(triangle, t)| Some(Leaf { corners: corners(t)?, triangle }))
            .collect();
        if all.is_empty() {
            return Bvh { nodes: Vec::new(), leaves: all, extent: 0.0 };
        }
        let triangles: Vec<Triangle> = all
            .iter()
            .map(|leaf| {
                let [v0, v1, v2] = leaf.corners.map(Into::into);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let params = BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::medium_build() };
        let built = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
        let node = |node: &obvhs::bvh2::node::Bvh2Node| Node {
            low: node.aabb().min.into(),
            high: node.aabb().max.into(),
            first: node.first_index,
            count: node.prim_count,
        };
        let nodes: Vec<Node> = built.nodes.iter().map(node).collect();
        let leaves = built.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        let root = &nodes[0];
        let extent = root.low.abs().max(root.high.abs()).max_element();
        Bvh { nodes, leaves, extent: f64::from(extent) }
    }

    /// Whether `blocks` holds for any triangle on the ray from `eye` along `ray`, which ends at
    /// parameter 1 if `w` is 1 and never if it is 0.
    pub fn any(
        &self,
        eye: DVec3,
        ray: DVec3,
        w: f64,
        stack: &mut Stack,
        mut blocks: impl FnMut(&Leaf, [f64; 3]) -> bool,
    ) -> bool {
        let slabs = Slabs::new(eye, ray);
        let end = if w > 0.0 { 1.0 / w } else { f64::INFINITY };
        self.walk(
            stack,
            |node| slabs.enter(node, end).is_some(),
            |leaf| {
                let cone = Cone::new(leaf.seen_from(eye));
                cone.and_then(|cone| cone.hit(ray, w))
                    .is_some_and(|[_, weights @ ..]| blocks(leaf, weights))
            },
        )
    }

    /// The nearest triangle at a parameter of at least `start` on the ray for which `blocks`
    /// holds: the parameter, the weights of the triangle's corners, and the triangle.
    pub fn nearest(
        &self,
        eye: DVec3,
        ray: DVec3,
        start: f64,
        stack: &mut Stack,
        mut blocks: impl FnMut(&Leaf, [f64; 3]) -> bool,
    ) -> Option<(f64, [f64; 3], &Leaf)> {
        let slabs = Slabs::new(eye, ray);
        let mut best: Option<(f64, [f64; 3], &Leaf)> = None;
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            let end = best.map_or(f64::INFINITY, |(t, ..)| t);
            if slabs.enter(node, end).is_none() {
                continue;
            }
            if node.count == 0 {
                // The nearer child first: it is the one on top of the stack.
                let [a, b] = [node.first, node.first + 1];
                let far =
                    |i: u32| slabs.enter(&self.nodes[i as usize], end).unwrap_or(f64::INFINITY);
                stack.extend(if far(a) < far(b) { [b, a] } else { [a, b] });
                continue;
            }
            for leaf in &self.leaves[node.first as usize..(node.first + node.count) as usize] {
                let hit = Cone::new(leaf.seen_from(eye)).and_then(|cone| cone.hit(ray, 0.0));
                let Some([t, weights @ ..]) = hit else { continue };
                // Ties go to the lower triangle, whatever the order of the hierarchy.
                let nearer =
                    best.is_none_or(|(t0, _, l)| t < t0 || (t == t0 && leaf.triangle < l.triangle));
                if t >= start && nearer && blocks(leaf, weights) {
                    best = Some((t, weights, leaf));
                }
            }
        }
        best
    }

    /// Calls `visit` for every triangle whose leaf meets `shaft`, until it returns true.
    pub fn in_shaft(
        &self,
        shaft: &Shaft,
        stack: &mut Stack,
        mut visit: impl FnMut(&Leaf, [DVec3; 3]) -> bool,
    ) {
        let eye = shaft.eye();
        let meets =
            |node: &Node| shaft.meets(node.low.as_dvec3() - eye, node.high.as_dvec3() - eye);
        self.walk(stack, meets, |leaf| visit(leaf, leaf.seen_from(eye)));
    }

    /// Visits the leaves below all nodes that `enter` admits; stops and is true once `visit` is.
    fn walk(
        &self,
        stack: &mut Stack,
        enter: impl Fn(&Node) -> bool,
        mut visit: impl FnMut(&Leaf) -> bool,
    ) -> bool {
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            if !enter(node) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first + 1, node.first]);
                continue;
            }
            let leaves = &self.leaves[node.first as usize..(node.first + node.count) as usize];
            if leaves.iter().any(&mut visit) {
                return true;
            }
        }
        false
    }

    /// The largest coordinate of any triangle.
    pub fn extent(&self) -> f64 {
        self.extent
    }
}

/// A ray as the slab test wants it.
struct Slabs {
    eye: DVec3,
    inverse: DVec3,
}

impl Slabs {
    fn new(eye: DVec3, ray: DVec3) -> Slabs {
        Slabs { eye, inverse: ray.recip() }
    }

    /// The parameter at which the ray enters the box, if it does so before `end`.
    fn enter(&self, node: &Node, end: f64) -> Option<f64> {
        let a = (node.low.as_dvec3() - self.eye) * self.inverse;
        let b = (node.high.as_dvec3() - self.eye) * self.inverse;
        // 0 * infinity, a ray within a face, is NaN: f64::min and max drop it, and the slab holds.
        let (mut first, mut last) = (0.0_f64, end);
        for axis in 0..3 {
            first = first.max(a[axis].min(b[axis]));
            last = last.min(a[axis].max(b[axis]));
        }
        // Wider by more than the rounding, so that no ray slips between boxes (Ize 2013).
        (first <= last * (1.0 + 1e-14)).then_some(first)
    }
}
