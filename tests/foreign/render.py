"""Depth and object-ID buffers of a scene, and its true visibility, by a ray tracer that is not ours.

usage: python render.py FOLDER   (needs numpy, trimesh and embreex)

Writes, of a torus over the ground under a sphere light of radius 0.5 m: camera.npy (metres along the
ray), camera-ids.npy, camera-normals.npy, light.npy (an OpenGL depth buffer, bottom row first), light-ids.npy, views.json
and truth.npy (the fraction of 256 light samples that each pixel sees; 1 where there is nothing).
"""

import json
import sys
from pathlib import Path

import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

LIGHT, RADIUS = np.array([1.5, 6.0, 1.5]), 0.5
CAMERA, MAP = 512, 1024
NEAR, FAR = 0.5, 40.0


def scene():
    """The torus (radii 1 and 0.35 m, tilted by 30 degrees) and the ground, with an ID per triangle."""
    ground = trimesh.Trimesh(
        [[-5, 0, -5], [-5, 0, 5], [5, 0, 5], [5, 0, -5]], [[0, 1, 2], [0, 2, 3]], process=False
    )
    torus = trimesh.creation.torus(1.0, 0.35, major_sections=64, minor_sections=32)
    tilt = trimesh.transformations.rotation_matrix(np.radians(-60), [1, 0, 0])
    torus.apply_transform(tilt)
    torus.apply_translation([0, 1.5, 0])
    mesh = trimesh.util.concatenate([ground, torus])
    ids = np.array([1] * len(ground.faces) + [2] * len(torus.faces), dtype=np.uint32)
    return mesh, ids


def look_at(eye, target, up):
    """The view-from-world matrix: x right, y up, looking along -z."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = [right, np.cross(right, forward), -forward]
    view[:3, 3] = -view[:3, :3] @ eye
    return view


def perspective(degrees):
    """OpenGL's clip-from-view matrix of a square picture."""
    f = 1 / np.tan(np.radians(degrees) / 2)
    a, b = (FAR + NEAR) / (NEAR - FAR), 2 * FAR * NEAR / (NEAR - FAR)
    return np.array([[f, 0, 0, 0], [0, f, 0, 0], [0, 0, a, b], [0, 0, -1, 0]])


def cast(rays, ids, view, degrees, size):
    """Hit triangle (-1: none), distance along the ray, and depth along the view axis per pixel."""
    extent = np.tan(np.radians(degrees) / 2)
    x = (2 * (np.arange(size) + 0.5) / size - 1) * extent
    directions = np.stack(np.broadcast_arrays(x[None, :], -x[:, None], -1.0), -1).reshape(-1, 3)
    lengths = np.linalg.norm(directions, axis=1)
    world = (directions / lengths[:, None]) @ view[:3, :3]
    eye = -view[:3, :3].T @ view[:3, 3]
    origins = np.broadcast_to(eye, world.shape)
    triangles = rays.intersects_first(origins, world)
    hit = triangles >= 0
    corners = rays.mesh.triangles[np.where(hit, triangles, 0)]
    normals = rays.mesh.face_normals[np.where(hit, triangles, 0)]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.einsum("ij,ij->i", normals, corners[:, 0] - eye)
        distance = along / np.einsum("ij,ij->i", normals, world)
    distance = np.where(hit, distance, np.inf)
    return triangles, distance, distance / lengths, eye + world * np.where(hit, distance, 0)[:, None]


def disc(count):
    """Points of the unit disc: Hammersley points through the concentric map."""
    index = np.arange(count)
    bits = np.array([int(f"{i:032b}"[::-1], 2) for i in index]) / 2**32
    a, b = 2 * (index + 0.5) / count - 1, 2 * bits - 1
    wide = np.abs(a) > np.abs(b)
    radius = np.where(wide, a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        angle = np.where(wide, np.pi / 4 * b / a, np.pi / 2 - np.pi / 4 * a / b)
    return radius * np.cos(angle), radius * np.sin(angle)


def truth(rays, triangles, positions, eye, samples):
    """The fraction of a disc that faces the receiver: its own horizon and all blockers counted."""
    hit = np.flatnonzero(triangles >= 0)
    normals = rays.mesh.face_normals[triangles[hit]]
    towards_eye = np.einsum("ij,ij->i", normals, eye - positions[hit])
    normals = normals * np.where(towards_eye < 0, -1, 1)[:, None]
    points = positions[hit] + 1e-4 * normals
    axis = points - LIGHT
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    tangent = np.cross(axis, [0.3, 0.1, 0.9])
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    bitangent = np.cross(axis, tangent)
    seen = np.zeros(len(hit))
    for s, t in zip(*disc(samples)):
        ray = LIGHT + RADIUS * (s * tangent + t * bitangent) - points
        above = np.flatnonzero(np.einsum("ij,ij->i", normals, ray) > 0)
        # The light lies beyond every blocker of this scene, so that any hit blocks.
        seen[above] += ~rays.intersects_any(points[above], ray[above])
    visibility = np.ones(len(triangles))
    visibility[hit] = seen / samples
    return visibility


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    mesh, ids = scene()
    rays = RayMeshIntersector(mesh, scale_to_box=False)
    ids_of = lambda triangles: np.where(triangles >= 0, ids[triangles], 0).astype(np.uint32)
    save = lambda name, values, size: np.save(folder / name, values.reshape(size, size))

    eye = np.array([0.0, 5.0, 8.0])
    view = look_at(eye, np.array([0.0, 0.8, 0.0]), np.array([0.0, 1.0, 0.0]))
    triangles, distance, _, positions = cast(rays, ids, view, 40, CAMERA)
    save("camera.npy", distance.astype(np.float32), CAMERA)
    save("camera-ids.npy", ids_of(triangles), CAMERA)
    normals = np.where(triangles[:, None] >= 0, mesh.face_normals[triangles], 0)
    np.save(folder / "camera-normals.npy", normals.reshape(CAMERA, CAMERA, 3).astype(np.float32))
    visibility = truth(rays, triangles, positions, eye, 256)
    save("truth.npy", visibility.astype(np.float32), CAMERA)

    light_view = look_at(LIGHT, np.zeros(3), np.array([0.0, 0.0, -1.0]))
    triangles, _, depth, _ = cast(rays, ids, light_view, 90, MAP)
    with np.errstate(divide="ignore"):
        ndc = (FAR + NEAR) / (FAR - NEAR) - 2 * FAR * NEAR / (FAR - NEAR) / depth
    buffer = np.where(np.isfinite(depth), ndc * 0.5 + 0.5, 1.0).astype(np.float32)
    save("light.npy", buffer.reshape(MAP, MAP)[::-1].copy(), MAP)
    save("light-ids.npy", ids_of(triangles).reshape(MAP, MAP)[::-1].copy(), MAP)

    views = {
        "camera": {
            "projection": perspective(40).tolist(),
            "view": view.tolist(),
            "depth": "distance",
        },
        "light": {
            "clip_from_world": (perspective(90) @ light_view).T.ravel().tolist(),
            "depth": "opengl",
            "origin": "bottom-left",
        },
    }
    (folder / "views.json").write_text(json.dumps(views, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
