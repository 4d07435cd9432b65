"""Checks of a run on its own model, gathered from its series block by block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import SolveError
from dynamics.motion.sampled_states import States
from dynamics.results.bearing_load_checks import BearingLoadChecks
from dynamics.results.checks import Check, SeriesBlock, ending
from dynamics.results.contact_checks import ContactChecks
from dynamics.results.histories import FIELDS, axis_rows
from dynamics.results.operating_point_checks import WHAT, HeldOperatingPointChecks
from dynamics.results.small_motion import SmallMotionCheck
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, Json

STRAIGHT_ON = 1.2
"""Force over the highest load of a table up to which linear extrapolation by the last stiffness is valid.

The result is then reported as extrapolated. Beyond this it is wrong: further tooth pairs that would share the
load, and corner contact that would set in, are not in the table. A table of two levels is a closed form and
holds everywhere.
"""


class _AxisChecks:
    """Misalignment and center distance, gathered block by block, beyond the tables' axes."""

    def __init__(self, system: System) -> None:
        self._system, self._samples = system, 0
        # (axis, mesh): 0 is the misalignment, 1 the center distance, of meshes that follow the motion in it
        self._watched = [(axis, mesh) for axis in (0, 1) for mesh in axis_rows(system, axis, follows=True)]
        self._beyond = dict.fromkeys(self._watched, 0)
        self._range = dict.fromkeys(self._watched, (np.inf, -np.inf))

    def see(self, series: SeriesBlock, _states: States) -> None:
        self._samples += series["time"].size
        for axis, mesh in self._watched:
            values, (low, high) = series[FIELDS[axis]][mesh], self._range[axis, mesh]
            first, last = self._ends(axis, mesh)
            self._beyond[axis, mesh] += int(np.count_nonzero((values < first) | (values > last)))
            self._range[axis, mesh] = float(np.min(values, initial=low)), float(np.max(values, initial=high))

    def checks(self) -> list[Check]:
        """Return one check per mesh and axis in use.

        ``beyond`` is the share of the samples beyond the ends of the axis, where the table's last value
        holds; ``farthest`` is the largest distance from the ends, m.
        """
        return [self._check(axis, mesh) for axis, mesh in self._watched if self._samples]

    def _check(self, axis: int, mesh: int) -> Check:
        (low, high), (first, last) = self._range[axis, mesh], self._ends(axis, mesh)
        farthest = max(first - low, high - last, 0.0)
        span = f"{low:.4g} to {high:.4g} m of {first:.4g} to {last:.4g} m"
        reason = f"{WHAT[axis]} inside the table's axis: {span}"
        if farthest > 0.0:
            reason = f"{WHAT[axis]} beyond the axis: {span}; the last value was held. Compute a wider axis"
        return Check(
            effect=self._system.ledger.effect_adding(FIELDS[axis]),
            assumption=f"{WHAT[axis]} inside the table",
            part=self._system.scene.meshes[mesh].name,
            holds=farthest <= 0.0,
            reason=reason,
            figures={"beyond": self._beyond[axis, mesh] / self._samples, "farthest": farthest},
        )

    def _ends(self, axis: int, mesh: int) -> tuple[float, float]:
        """Return the first and the last knot of the table's axis, m."""
        knots = np.ravel(getattr(self._system.scene.meshes[mesh].table, FIELDS[axis]))
        return float(knots[0]), float(knots[-1])


class _ForceChecks:
    """Forces of flanks, gathered block by block, beyond the loads of their tables."""

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
        """Return the checks of all meshes; ``beyond`` is the share of samples above the highest load."""
        shares = self._beyond / max(self._samples, 1)
        return _force_checks(self._scene, self._largest, shares)


def _force_checks(scene: Scene, largest: FloatArray, beyond: FloatArray | None = None) -> list[Check]:
    """Return one check per mesh whose table is read between its loads.

    `largest` (m,) are the largest transverse mesh forces, N, by mesh. `beyond` (m,) are the shares of samples
    above the highest load. Both are figures of the checks.
    """
    checks = []
    for index, mesh in enumerate(scene.meshes):
        share = {} if beyond is None else {"beyond": float(beyond[index])}
        if mesh.table.level.size > 2:  # a table of two levels is a closed form
            checks.append(_force_check(scene, index, float(largest[index]), share))
    return checks


def checked_ledger(system: System, largest: FloatArray) -> Json:
    """Return the effect ledger of a study whose largest mesh forces are `largest` (m,), N, with its checks.

    Raises `SolveError`: a force is beyond its table, and the scene's ``on_violation`` makes that an error.
    """
    checks = _force_checks(system.scene, largest)
    entries = [check.to_json() for check in checks]
    wrong = ending(entries, system.scene.on_violation)
    if wrong:
        raise SolveError(f"violated assumptions of the study: {wrong}")
    return {**system.ledger.to_json(), "checks": entries}


def _force_check(scene: Scene, index: int, largest: float, share: Mapping[str, float]) -> Check:
    highest = _highest(scene, index)
    times = largest / highest
    reason = f"forces up to {largest:.4g} N of {highest:.4g} N in the table"
    if times > 1.0:
        mesh = scene.meshes[index]
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        # the table's torques are those of the driving gear, but of the pinion where the ring gear drives
        radius = driven.base_radius if driver.internal else driver.base_radius
        maximum = largest * radius
        # rounded up to two significant digits
        digit = 10.0 ** (np.floor(np.log10(maximum)) - 1.0)
        rounded = float(np.ceil(maximum / digit) * digit)
        reason = (
            f"forces up to {largest:.4g} N, {times:.3g} times the table's highest load of {highest:.4g} N; "
            f"above it the table is extrapolated linearly, up to {STRAIGHT_ON:g} times. Compute it with "
            f"torques up to {rounded:g} N m, it ends at {highest * radius:.4g} N m"
        )
    return Check(
        effect="",
        assumption="force inside the table",
        part=scene.meshes[index].name,
        holds=times <= 1.0,
        reason=reason,
        figures={**share, "largest": largest},
        valid=times <= STRAIGHT_ON,
    )


def _highest(scene: Scene, index: int) -> float:
    """Return the highest load of a mesh's table, N.

    Where the coast flank has a table of its own, it is that of the table with the lower highest load.
    """
    coast = scene.meshes[index].coast
    tables = [scene.meshes[index].table, *([coast.table] if coast is not None and coast.table else [])]
    return min(float(table.level[-1]) for table in tables)


class _RunCheck(Protocol):
    def see(self, series: SeriesBlock, states: States) -> None: ...

    def checks(self) -> list[Check]: ...


class RunChecks:
    """All checks of a run on its own model, and `further` ones."""

    def __init__(self, system: System, further: Sequence[_RunCheck] = ()) -> None:
        kinds = (ContactChecks, _AxisChecks, _ForceChecks, BearingLoadChecks, HeldOperatingPointChecks)
        small = SmallMotionCheck(system)
        self._all: tuple[_RunCheck, ...] = (*(kind(system) for kind in kinds), small, *further)

    def see(self, series: SeriesBlock, states: States) -> None:
        """Take a block of unfiltered series, and the states they are of."""
        for check in self._all:
            check.see(series, states)

    def checks(self) -> list[Check]:
        """Return the checks of all blocks taken."""
        return [check for part in self._all for check in part.checks()]
