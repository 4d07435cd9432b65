"""Reduced housings of matrices with the surface of a hull, for sound in closed form."""

from dataclasses import replace

import numpy as np
from reduced_housings import seat

from dynamics.acoustics import Hull
from dynamics.housings import ModalDamping, housing_of_matrices, scene_housing
from dynamics.housings.reduced_housing import ReducedHousing, SurfaceMotion
from dynamics.housings.reduced_matrices import ReducedMatrices


def rigid_housing(mass: float, stiffness: float, damping: float, hull: Hull) -> ReducedHousing:
    """A rigid hull on springs along x, y and z, with one seat of three motions."""
    matrices = ReducedMatrices(stiffness * np.eye(3), mass * np.eye(3))
    held = housing_of_matrices(matrices, (seat("seat", motions=3),), ModalDamping((damping,)))
    return with_surface(held, hull, np.broadcast_to(np.eye(3), (len(hull.nodes), 3, 3)))


def with_surface(housing: ReducedHousing, hull: Hull, motion: np.ndarray) -> ReducedHousing:
    """Give a housing the surface of a hull; `motion` (N, 3, r) of its nodes, linear between them."""
    edges = np.stack([hull.triangles, np.roll(hull.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    pairs, number = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    points = np.concatenate([hull.nodes, hull.nodes[pairs].mean(axis=1)])
    moving = np.concatenate([motion, motion[pairs].mean(axis=1)])
    triangles = np.concatenate([hull.triangles, len(hull.nodes) + number.reshape(-1, 3)], axis=1)
    return replace(housing, surface=SurfaceMotion(points, triangles, moving))


def smooth_motion(hull: Hull, coordinates: int, seed=2) -> np.ndarray:
    """Random waves along the hull, (N, 3, r), longer than its panels."""
    draw = np.random.default_rng(seed)
    waves = 6.0 / np.ptp(hull.nodes, axis=0).max() * draw.normal(size=(3, coordinates))
    phase = hull.nodes @ waves + draw.uniform(0.0, 2.0 * np.pi, coordinates)
    return np.cos(phase)[:, None, :] * draw.normal(size=(1, 3, coordinates))


def part_of_scene(housing: ReducedHousing, name: str = "case"):
    """The same housing as a part of a scene whose bearings are elsewhere than the seats."""
    return replace(scene_housing(housing, name), seat_positions=None)
