"""The pair in a housing with mass whose modes are known."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene, spring_table, with_bushings

from dynamics import Housing, TimeLaw

ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
NAMES = ("input.left", "input.right", "output.left", "output.right")
SEATS, MODES = 12, 20
SPEED = 300.0


def housed_pair(bearing=None, **changes):
    """The pair in a housing of 20 modes from 0.5 to 4 kHz and 12 residual ones up to 30 kHz."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(SPEED), effects=ON)
    shape = 0.3 * np.random.default_rng(3).normal(size=(SEATS, SEATS + MODES))
    hertz = np.concatenate([np.linspace(500.0, 4000.0, MODES), np.geomspace(6e3, 3e4, SEATS)])
    back = np.linalg.inv(np.vstack([shape, np.eye(MODES, SEATS + MODES)]))
    square = back.T @ np.diag((2.0 * np.pi * hertz) ** 2) @ back
    stiffness, mass = (
        tuple(map(tuple, (0.5 * (matrix + matrix.T)).tolist())) for matrix in (square, back.T @ back)
    )
    case = Housing("case", NAMES, stiffness, mass=mass, modal_coordinates=MODES, damping_ratio=0.02)
    return replace(with_bushings(scene, **(bearing or {})), housings=(case,), **changes)
