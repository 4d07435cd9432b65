"""A free-form flank at random: heights with no law at all between neighboring nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.geometry import FlankGrid, Gear

_NODES = (2, 12)
"""Fewest nodes of an axis, and one more than the most."""


def with_random_grid(gear: Gear, random: np.random.Generator, size: float, across_face: bool) -> Gear:
    """Return the gear with a grid of its own added to its modification.

    Parameters
    ----------
    gear : Gear
    random : numpy.random.Generator
    size : float
        Largest height in modules.
    across_face : bool
        Whether heights differ along the face; in the plane all are those of mid-face.
    """
    profile, face = (int(count) for count in random.integers(*_NODES, 2))
    heights = random.uniform(0.0, size * gear.normal_module, (profile, face if across_face else 1))
    grid = FlankGrid(
        tuple(np.linspace(gear.form_roll_length, gear.tip_roll_length, profile)),
        tuple(np.linspace(-0.5, 0.5, face) * gear.face_width),
        tuple(map(tuple, np.broadcast_to(heights, (profile, face)).tolist())),
    )
    return replace(gear, modification=replace(gear.modification, flank_grid=grid))
