"""Whether mesh forces stayed below the highest load of their tables.

A table of several loads goes on straight with its last stiffness above the highest one. Up to `STRAIGHT_ON`
times that load the result is reported as extrapolated. Beyond it is wrong: tooth pairs that would share the
load, and corner contact that would set in, are not in the table. A table of two levels is a closed form and
holds everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import SolveError
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock, ending
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, Json

STRAIGHT_ON = 1.2
"""Times the highest load of a table: up to here it may go on straight."""


class ForceChecks:
    """Gathers, block by block, how far flanks were pressed beyond the loads of their tables."""

    def __init__(self, system: System) -> None:
        self._scene = system.scene
        self._samples = 0
        self._highest = np.array([_highest(system.scene, i) for i in range(len(system.scene.meshes))])
        self._beyond = np.zeros(self._highest.size, dtype=np.int64)
        self._largest = np.zeros(self._highest.size)

    def see(self, series: SeriesBlock, _states: States) -> None:
        """Take a block of series of a run."""
        driving, coast = series["largest_mesh_force"], series["coast_force"]
        force = np.maximum(driving, coast) if coast.shape == driving.shape else driving
        self._samples += force.shape[1]
        self._beyond += np.count_nonzero(force > self._highest[:, None], axis=1)
        self._largest = np.maximum(self._largest, np.max(force, axis=1, initial=0.0))

    def checks(self) -> list[Check]:
        """Return those of all meshes; ``beyond`` is the share of samples above the highest load."""
        shares = self._beyond / max(self._samples, 1)
        return _force_checks(self._scene, self._largest, shares)


def _force_checks(scene: Scene, largest: FloatArray, beyond: FloatArray | None = None) -> list[Check]:
    """Return one check per mesh whose table is read between its loads.

    `largest` (m,) are the largest transverse mesh forces, N, also among the figures.
    """
    return [
        _force_check(
            scene, index, float(largest[index]), {} if beyond is None else {"beyond": float(beyond[index])}
        )
        for index, mesh in enumerate(scene.meshes)
        if mesh.table.level.size > 2
    ]


def checked_ledger(system: System, largest: FloatArray) -> Json:
    """Return the effect ledger of a study whose largest mesh forces are `largest` (m,), N, with its checks.

    Raises
    ------
    SolveError
        If a force is beyond its table and the scene's ``on_violation`` does not let that pass.
    """
    checks = _force_checks(system.scene, largest)
    entries = [check.to_json() for check in checks]
    if wrong := ending(entries, system.scene.on_violation):
        raise SolveError(f"violated assumptions of the study: {wrong}")
    return {**system.ledger.to_json(), "checks": entries}


def _force_check(scene: Scene, index: int, largest: float, share: Mapping[str, float]) -> Check:
    highest = _highest(scene, index)
    times = largest / highest
    reason = f"forces up to {largest:.4g} N of {highest:.4g} N in the table"
    if times > 1.0:
        radius = _table_driver_radius(scene, index)
        reason = (
            f"forces up to {largest:.4g} N, {times:.3g} times the table's highest load of {highest:.4g} N; "
            f"above it the table is extrapolated linearly, up to {STRAIGHT_ON:g} times. Compute it with "
            f"torques up to {_rounded_up(largest * radius):g} N m, it ends at {highest * radius:.4g} N m"
        )
    figures = {**share, "largest": largest}
    name, valid = scene.meshes[index].name, times <= STRAIGHT_ON
    return Check("", "force inside the table", name, times <= 1.0, reason, figures, valid)


def _highest(scene: Scene, index: int) -> float:
    """Highest load of a mesh's table, N; of the lower one where the coast flank has its own."""
    coast = scene.meshes[index].coast
    tables = [scene.meshes[index].table, *([coast.table] if coast is not None and coast.table else [])]
    return min(float(table.level[-1]) for table in tables)


def _table_driver_radius(scene: Scene, index: int) -> float:
    """Return the base radius of the gear whose torques the table counts, m: the driver, or the pinion."""
    driver, driven = scene.gear(scene.meshes[index].driver), scene.gear(scene.meshes[index].driven)
    return driven.base_radius if driver.internal else driver.base_radius


def _rounded_up(value: float) -> float:
    """Return the next number of two digits."""
    digit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(np.ceil(value / digit) * digit)
