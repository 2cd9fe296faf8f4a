//! The node tree: which nodes the scene shows, and where.

use glam::{DMat4, DQuat, DVec3};

use super::super::error::{Fault, malformed};
use super::json::{Node, Root};

/// A node that the scene shows.
pub(super) struct Placed {
    pub(super) node: usize,
    pub(super) world: DMat4,
}

/// The nodes of the default scene, parents before their children. A file without scenes shows
/// all of its nodes.
///
/// # Errors
///
/// When the nodes do not form trees: a node has two parents, or is its own ancestor.
pub(super) fn place(root: &Root) -> Result<Vec<Placed>, Fault> {
    let roots = check_trees(root)?;
    let shown = match root.scenes.get(root.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.as_slice(),
        None => roots.as_slice(),
    };
    let mut placed = Vec::new();
    let mut seen = vec![false; root.nodes.len()];
    // A stack instead of recursion: a chain may be as deep as the file is long.
    let mut stack: Vec<(usize, DMat4)> = Vec::new();
    for &node in shown {
        stack.push((node, DMat4::IDENTITY));
        while let Some((node, parent)) = stack.pop() {
            if std::mem::replace(&mut seen[node], true) {
                return Err(malformed(format!("the scene shows nodes[{node}] twice")));
            }
            let json = &root.nodes[node];
            let world = parent * local_transform(json, node)?;
            stack.extend(json.children.iter().rev().map(|&child| (child, world)));
            placed.push(Placed { node, world });
        }
    }
    Ok(placed)
}

/// The nodes without parents, when all nodes hang from them.
fn check_trees(root: &Root) -> Result<Vec<usize>, Fault> {
    let mut parents: Vec<Option<usize>> = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for &child in &node.children {
            if let Some(parent) = parents[child] {
                return Err(malformed(format!(
                    "nodes[{child}] has two parents, nodes[{parent}] and nodes[{i}]"
                )));
            }
            parents[child] = Some(i);
        }
    }
    let roots: Vec<usize> = (0..parents.len()).filter(|&i| parents[i].is_none()).collect();
    let mut reached = vec![false; parents.len()];
    let mut stack = roots.clone();
    while let Some(node) = stack.pop() {
        reached[node] = true;
        stack.extend(&root.nodes[node].children);
    }
    match reached.iter().position(|&r| !r) {
        Some(node) => Err(malformed(format!("nodes[{node}] is its own ancestor"))),
        None => Ok(roots),
    }
}

fn local_transform(node: &Node, index: usize) -> Result<DMat4, Fault> {
    if let Some(matrix) = &node.matrix {
        let matrix = DMat4::from_cols_array(matrix);
        if matrix.row(3) != DMat4::IDENTITY.row(3) {
            return Err(malformed(format!("nodes[{index}]: its matrix is not affine")));
        }
        return Ok(matrix);
    }
    let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
    let translation = node.translation.map_or(DVec3::ZERO, DVec3::from);
    let rotation = node.rotation.map_or(DQuat::IDENTITY, DQuat::from_array);
    // Rounded quaternions are not quite of unit length; a zero one turns nothing.
    let length = rotation.length();
    let rotation =
        if length > 0.0 && length.is_finite() { rotation / length } else { DQuat::IDENTITY };
    Ok(DMat4::from_scale_rotation_translation(scale, rotation, translation))
}
