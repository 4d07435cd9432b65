"""Whether bodies moved so little that the equations of small motion hold: the check that ends other runs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.mechanism.columns import gear_row
from dynamics.meshes import GearMesh
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock
from dynamics.types import FloatArray

LARGEST_TILT = 0.01
"""Largest tilt, rad: beyond it a gear's displacement along the line of action is no linear function of its
tilt.
"""
MAX = 4
"""Parts beyond their bound that are named: where one is, most of them are."""
WORKING_DEPTH = 2.0
"""Modules on the operating pitch circle: the working depth of standard teeth (ISO 53)."""


@dataclass(frozen=True)
class _Limit:
    """Limit of the motion of a part."""

    quantity: str
    part: str
    bound: float
    """Largest motion in SI; times `size` it is in the `unit`."""
    unit: str = "mm"
    size: float = 1e3
    rows: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    """Displacement per freedom, whose length counts; empty for a transmission error, which the run states.
    Shape (k, n).
    """
    line: FloatArray | None = None
    """Line whose end the displacement moves: the change of its length counts. Shape (k,)."""

    def farthest(self, q: FloatArray) -> float:
        """Return the largest motion of the states q (T, n)."""
        displacement = q @ self.rows[:, : q.shape[1]].T
        if self.line is None:
            return float(np.sqrt(np.max(np.sum(displacement**2, axis=1))))
        length = np.sqrt(np.sum((self.line + displacement) ** 2, axis=1))
        return float(np.max(np.abs(length - math.hypot(*self.line))))


class SmallMotionCheck:
    """Motion of meshes, axes, gears and rolling bearings, gathered block by block."""

    def __init__(self, system: System) -> None:
        self._errors = tuple(_errors(system))
        self._others = (*_approaches(system), *_tilts(system), *_closures(system))
        self._largest = np.zeros(len(self._errors) + len(self._others))

    def see(self, series: SeriesBlock, states: States) -> None:
        """Take a block of unfiltered series, and the states they are of."""
        if not states.q.shape[0]:
            return
        amplitudes = [np.max(np.abs(series["dynamic_transmission_error"]), axis=1, initial=0.0)]
        for limit in self._others:
            amplitudes.append(np.array([limit.farthest(states.q)]))
        self._largest = np.fmax(self._largest, np.concatenate(amplitudes))

    def checks(self) -> list[Check]:
        """Return the checks of the parts farthest beyond their bound, or of the part nearest to it."""
        limits = (*self._errors, *self._others)
        if not limits:
            return []
        share = self._largest / np.array([limit.bound for limit in limits])
        beyond = np.flatnonzero(share >= 1.0)
        chosen = beyond[np.argsort(-share[beyond])] if beyond.size else [int(np.argmax(share))]
        return [_check(limits[index], float(self._largest[index])) for index in chosen[:MAX]]


def _check(limit: _Limit, largest: float) -> Check:
    within = largest < limit.bound
    value, bound = (engineering(limit.size * number, 4) for number in (largest, limit.bound))
    reason = f"{limit.quantity} up to {value} {limit.unit} of {bound} {limit.unit} that linear motion allows"
    figures = {"largest": largest, "bound": limit.bound}
    return Check("", "small motion", limit.part, within, reason, figures, within)


def _errors(system: System) -> Iterator[_Limit]:
    """Yield the transmission errors: beyond a base pitch the next pair of teeth would carry."""
    for mesh in system.scene.meshes:
        pitch = system.scene.gear(mesh.driver).base_pitch
        yield _Limit("transmission error", mesh.name, pitch)


def _approaches(system: System) -> Iterator[_Limit]:
    """Yield the changes of center distance: beyond the working depth teeth jam, or leave each other."""
    for mesh, line in zip(system.scene.meshes, system.lines, strict=True):
        driver = system.scene.gear(mesh.driver)
        module = 2.0 * driver.base_radius / (driver.teeth * math.cos(line.working_pressure_angle))
        rows = np.stack([_parting_row(system, mesh, float(line.point[2]), axis) for axis in (0, 1)])
        if np.any(rows):
            first, second = system.scene.gear(mesh.driver).shaft, system.scene.gear(mesh.driven).shaft
            ends = system.scene.shaft(second).origin[:2], system.scene.shaft(first).origin[:2]
            line_of_centers = np.subtract(*ends)
            bound = WORKING_DEPTH * module
            yield _Limit("change of center distance", mesh.name, bound, rows=rows, line=line_of_centers)


def _parting_row(system: System, mesh: GearMesh, z: float, axis: int) -> FloatArray:
    """Return the motion of the driven gear's axis along x or y, less the driver's, at z per freedom, (n,)."""
    along = np.eye(3)[axis]

    def displacement(center: FloatArray) -> FloatArray:
        return np.concatenate([along, np.cross([0.0, 0.0, z - center[2]], along)])

    sides = [(mesh.driven, displacement), (mesh.driver, lambda center: -displacement(center))]
    return system.freedoms.keep(gear_row(system.scene, system.rotors, sides))


def _tilts(system: System) -> Iterator[_Limit]:
    """Yield the tilts of the gears."""
    for gear in system.scene.gears:
        rows = np.stack([_tilt_row(system, gear.name, axis) for axis in (0, 1)])
        if np.any(rows):
            yield _Limit("tilt", gear.name, LARGEST_TILT, "mrad", rows=rows)


def _tilt_row(system: System, gear: str, axis: int) -> FloatArray:
    """Return the rotation of a gear's section about x or y per freedom, (n,)."""
    about = np.eye(6)[3 + axis]
    return system.freedoms.keep(gear_row(system.scene, system.rotors, [(gear, lambda _: about)]))


def _closures(system: System) -> Iterator[_Limit]:
    """Yield the displacements in rolling bearings: beyond a rolling element's diameter rings would meet."""
    diameters = {bearing.name: bearing.row.diameter for bearing in system.scene.rolling_bearings}
    for name, motion in zip(system.supports.name, system.supports.motion, strict=True):
        rows = system.freedoms.keep(motion)
        if name in diameters and np.any(rows):
            yield _Limit("displacement of the inner ring", name, diameters[name], rows=rows)
