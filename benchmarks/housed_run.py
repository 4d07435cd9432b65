"""The run-up of the paper's pair in a housing with 80 modes up to 6.3 kHz, against the same without one."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from dynamics.housings import ModalDamping, Ring, SeatFrame, housing_of_matrices
from dynamics.housings.reduced_matrices import ReducedMatrices
from dynamics.housings.supports import MOTIONS
from dynamics.joints import Housing
from dynamics.scene import Scene
from dynamics.simulation import simulate
from dynamics.vibration import motion_pieces, run_seat_forces
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.subjects import scene_of

EXAMPLE = Path(__file__).parents[1] / "examples" / "palermo_scene.toml"
SEATS, MODES = 12, 80
LIMIT = 1.5
TURNS = 4


def figures() -> list[Figure]:
    """Return the times of both runs and their ratio."""
    given, folder = scene_of(EXAMPLE)
    scene = tabled_scene(given, folder, None, lambda _stage, _fraction: None).scene
    alone, housed = _seconds(scene), _seconds(in_housing(scene))
    subject = f"run-up of {scene.duration:g} s, 4 bearings, {MODES} modes and {SEATS} residual ones"
    return [
        Figure(subject, "without a housing", alone, "CPU s"),
        Figure(subject, "in a housing", housed, "CPU s"),
        Figure(subject, "ratio", housed / alone, "-", LIMIT),
        Figure(subject, "modes that do not act back over integration alone", _propagated(scene), "-", 2.0),
    ]


def _propagated(scene: Scene) -> float:
    """Return integration and the modes moved by the bearing forces of the run, over integration."""
    rows = in_housing(scene).housings[0]
    names = [part.name for part in scene.bushings]
    seats = [SeatFrame(name, np.zeros(3), np.eye(3), Ring.RIGID, MOTIONS[:3]) for name in names]
    matrices = ReducedMatrices(np.array(rows.stiffness), np.array(rows.mass))
    housing = housing_of_matrices(matrices, tuple(seats), ModalDamping((rows.damping_ratio,)))
    integration, propagation = [], []
    for _ in range(TURNS):
        run = simulate(scene)
        integration.append(float(run.receipt["seconds"]["integration"]))
        force, began = run_seat_forces(run, housing), time.process_time()
        for _moved in motion_pieces(housing, run.time, force, np.eye(3, len(matrices.stiffness))):
            pass
        propagation.append(time.process_time() - began)
    return 1.0 + min(propagation) / min(integration)


def in_housing(scene: Scene) -> Scene:
    """Put all bearings into a housing of modes of random shapes, amplitude 0.2 kg^-1/2 at the seats."""
    size = SEATS + MODES
    shape = 0.2 * np.random.default_rng(1).normal(size=(SEATS, size))
    hertz = np.concatenate([np.linspace(670.0, 6300.0, MODES), np.geomspace(8e3, 6e4, SEATS)])
    back = np.linalg.inv(np.vstack([shape, np.eye(MODES, size)]))
    square = back.T @ np.diag((2.0 * np.pi * hertz) ** 2) @ back
    stiffness, mass = (0.5 * (matrix + matrix.T) for matrix in (square, back.T @ back))
    names = tuple(part.name for part in scene.bushings)
    rows = (tuple(map(tuple, matrix.tolist())) for matrix in (stiffness, mass))
    housing = Housing("case", names, next(rows), mass=next(rows), modal_coordinates=MODES)
    return replace(scene, housings=(housing,))


def _seconds(scene: Scene) -> float:
    """Return the CPU time of a run, compiled before, the code of its structure too."""
    for _ in range(2):
        simulate(scene)
    began = time.process_time()
    simulate(scene)
    return time.process_time() - began
