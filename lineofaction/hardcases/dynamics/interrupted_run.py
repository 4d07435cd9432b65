"""A run that is interrupted in the middle of impacts, and taken up again."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path

import numpy as np

from dynamics.results import RunResult
from dynamics.scene import Integration, Outputs, Scene
from dynamics.simulation import simulate_to_file
from dynamics.types import RunStatus
from lineofaction.hardcases.dynamics.laws import METHODS, by_method
from lineofaction.hardcases.dynamics.oscillators import RPM, coast, damping_of, spring, torsional
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("dynamics")

_BACKLASH, _WAVE = 20e-6, 30e-6


@SCENES.add(
    "restart_from_checkpoint",
    "In chaotic rattle one bit lost at an interruption is another motion a few impacts later.",
    "Interrupted every seventh block and taken up again, all series are those of the whole run, bit by bit.",
)
def _resumed_run() -> Sequence[Measured]:
    """Cancel a chaotic rattle every few blocks and resume it, until it has ended."""
    scene = torsional(
        spring(_WAVE), speed=1000.0 * RPM, torque=0.0, back=coast(_BACKLASH, _WAVE),
        damping=damping_of(0.1), duration=0.1, outputs=Outputs(displacements=True, accelerations=True),
        integration=Integration(tolerance=1e-9),
    )  # fmt: skip
    figures: list[Measured] = []
    for method in METHODS:
        scene_of_method = by_method(scene, method)
        with tempfile.TemporaryDirectory() as folder:
            unbroken_file, parts = Path(folder, "whole.nc"), Path(folder, "parts.nc")
            simulate_to_file(scene_of_method, unbroken_file)
            legs = _in_legs(scene_of_method, parts)
            unbroken, resumed = (RunResult.from_netcdf(path) for path in (unbroken_file, parts))
        extra = abs(unbroken.statistics.accepted - resumed.statistics.accepted)
        series = [
            entry.name for entry in fields(unbroken) if isinstance(getattr(unbroken, entry.name), np.ndarray)
        ]
        changed = [name for name in series if _bits(unbroken, name) != _bits(resumed, name)]
        # an odd value of `contact` says that the driving flank touches
        impacts = int(np.count_nonzero(np.diff(unbroken.contact[0] % 2.0) == 1.0))
        figures += [
            Measured(f"{method}: times it was taken up again", legs - 1, minimum=5.0),
            Measured(f"{method}: impacts on the driving flank", impacts, minimum=10.0),
            Measured(f"{method}: series with a bit that differs", len(changed), maximum=0.0),
            Measured(f"{method}: steps more or fewer", extra, maximum=0.0),
        ]
    return figures


def _in_legs(scene: Scene, path: Path) -> int:
    """Run in legs of seven blocks, each from the checkpoint of the one before; return how many it took."""
    legs, status = 0, RunStatus.CANCELLED
    while status is RunStatus.CANCELLED:
        status = simulate_to_file(scene, path, resume=legs > 0, cancel=_stop_after(7))
        legs += 1
    return legs


def _stop_after(blocks: int) -> Callable[[], bool]:
    """Return a function that is False until its last call of `blocks`, when it requests the stop."""
    left = iter(range(blocks - 1))
    return lambda: next(left, None) is None


def _bits(result: RunResult, name: str) -> bytes:
    return bytes(getattr(result, name).tobytes())
