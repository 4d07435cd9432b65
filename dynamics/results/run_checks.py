"""Checks of a run on its own model, gathered from its series block by block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.mechanism.additions import BEARING_LAWS, COAST_FLANKS, MISALIGNMENT
from dynamics.mechanism.line_of_action import distance_gradient, misalignment_gradient
from dynamics.meshes import GearMesh
from dynamics.meshes.technique import table_at_operating_point
from dynamics.motion.observation import static_deflections
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock
from dynamics.results.force_check import ForceChecks
from dynamics.results.histories import FIELDS, axis_rows
from dynamics.types import FloatArray

# Whether a run stayed on the axes of its mesh-force tables.


WHAT = ("tilt", "center distance")


class _AxisChecks:
    """Gathers, block by block, how far misalignment and center distance left the tables' axes."""

    def __init__(self, system: System) -> None:
        self._system, self._samples = system, 0
        self._watched = [(axis, mesh) for axis in (0, 1) for mesh in axis_rows(system, axis, follows=True)]
        self._beyond = dict.fromkeys(self._watched, 0)
        self._range = dict.fromkeys(self._watched, (np.inf, -np.inf))

    def see(self, series: SeriesBlock, _states: States) -> None:
        self._samples += series["time"].size
        for axis, mesh in self._watched:
            values, (low, high) = series[FIELDS[axis]][mesh], self._range[axis, mesh]
            first, last = self._ends(axis, mesh)
            self._beyond[axis, mesh] += int(np.count_nonzero((values < first) | (values > last)))
            self._range[axis, mesh] = (
                float(np.min(values, initial=low)),
                float(np.max(values, initial=high)),
            )

    def checks(self) -> list[Check]:
        """Return one per mesh and axis in use.

        ``beyond`` is the share of the samples off the axis, where the table's last value holds, ``farthest``
        in m how far off.
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
            self._system.ledger.effect_adding(FIELDS[axis]),
            f"{WHAT[axis]} inside the table",
            self._system.scene.meshes[mesh].name,
            farthest <= 0.0,
            reason,
            {"beyond": self._beyond[axis, mesh] / self._samples, "farthest": farthest},
        )

    def _ends(self, axis: int, mesh: int) -> tuple[float, float]:
        """First and last knot of the table's axis, m."""
        knots = np.ravel(getattr(self._system.scene.meshes[mesh].table, FIELDS[axis]))
        return float(knots[0]), float(knots[-1])


# Whether tables that are read at one misalignment or center distance were right to: how far bodies moved.


USUAL_TOLERANCE = 0.01
"""Relative change of the mean transmission error that may pass where no tolerance was requested."""


@dataclass(frozen=True)
class _Watched:
    """A mesh whose table has an axis that is not followed: its derivative in the freedoms (n,)."""

    axis: int
    mesh: int
    gradient: FloatArray


class _HeldOperatingPointChecks:
    """Gathers, block by block, how far bodies moved along axes of tables that did not follow them."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._watched = [
            _Watched(axis, index, _gradient(system, axis, index))
            for axis, field in enumerate(FIELDS)
            for index, mesh in enumerate(system.scene.meshes)
            if any(
                row.possible and not row.on for row in system.ledger.adding(field) if row.part == mesh.name
            )
        ]
        self._range = [(0.0, 0.0)] * len(self._watched)

    def see(self, _series: SeriesBlock, states: States) -> None:
        for k, watched in enumerate(self._watched):
            moved = states.q @ watched.gradient
            low, high = self._range[k]
            self._range[k] = (float(np.min(moved, initial=low)), float(np.max(moved, initial=high)))

    def checks(self) -> list[Check]:
        """Return one per mesh and axis.

        ``farthest`` is how far the bodies moved in m, ``change`` how much that changes the mean transmission
        error of the nominal force, of its value.
        """
        pairs = zip(self._watched, self._range, strict=True)
        return [self._check(watched, max(span, key=abs)) for watched, span in pairs]

    def _check(self, watched: _Watched, farthest: float) -> Check:
        system, quantity = self._system, WHAT[watched.axis]
        mesh, force = system.scene.meshes[watched.mesh], float(system.flanks.nominal_force[watched.mesh])
        change = _change(mesh, force, watched.axis, farthest)
        reported = (
            f"bodies moved by up to {farthest:.3g} m, which "
            f"changes the mean by {engineering(100.0 * change, 2)} %"
        )
        return Check(
            system.ledger.effect_adding(FIELDS[watched.axis]),
            f"{quantity} stays at the operating point",
            mesh.name,
            abs(change) <= (system.scene.tolerance or USUAL_TOLERANCE),
            reported,
            {"farthest": farthest, "change": change},
        )


def _change(mesh: GearMesh, force: float, axis: int, moved: float) -> float:
    """Return the relative change of the mean transmission error at `force` by `moved` (m) along an axis."""
    level = int(np.argmin(np.abs(np.asarray(mesh.table.level) - force)))
    point = np.array([mesh.misalignment, mesh.center_distance_change])
    means = [
        float(np.mean(table_at_operating_point(mesh.table, *at).deflection[..., level]))
        for at in (point, point + moved * np.eye(2)[axis])
    ]
    return means[1] / means[0] - 1.0 if means[0] != 0.0 else 0.0


def _gradient(system: System, axis: int, index: int) -> FloatArray:
    """Return the derivative of a mesh's operating point on an axis in the free freedoms, (n,)."""
    scene, rotors, line = system.scene, system.rotors, system.lines[index]
    if FIELDS[axis] == MISALIGNMENT:
        sense = system.kinematics.mesh_sense[index]
        return system.freedoms.keep(misalignment_gradient(scene, rotors, index, line, sense))
    return system.freedoms.keep(distance_gradient(scene, rotors, index, line))


# Whether what a run left out about contact would have mattered: flanks that parted without a coast flank.


class _ContactChecks:
    """Gathers, block by block, how far the driving flanks of meshes without backlash parted."""

    def __init__(self, system: System) -> None:
        meshes = system.scene.meshes
        self._system, self._samples = system, 0
        self._watched = [
            i for i, mesh in enumerate(meshes) if not system.ledger.adds(COAST_FLANKS, mesh.name)
        ]
        self._parted = np.zeros(len(meshes), dtype=np.int64)
        self._gap = np.zeros(len(meshes))
        self._first = np.full(len(meshes), -1, dtype=np.int64)

    def see(self, series: SeriesBlock, _states: States) -> None:
        position, deflection = series["position"], series["dynamic_transmission_error"]
        force, least = series["mesh_force"], series["least_mesh_force"]
        before = self._samples
        self._samples += position.shape[1]
        for index in self._watched:
            apart = least[index] <= 0.0
            if self._first[index] < 0 and np.any(apart):
                self._first[index] = before + int(np.argmax(apart))
            touch = np.empty(position.shape[1])
            table = self._system.arrays.elements.laws.flank.table
            static_deflections(table, index, position[index], 0.0, touch)
            self._parted[index] += np.count_nonzero(force[index] <= 0.0)
            gap = float(np.max((touch - deflection[index])[apart], initial=0.0))
            self._gap[index] = max(self._gap[index], gap)

    def checks(self) -> list[Check]:
        """Return one per mesh that ran without backlash.

        ``parted`` is the share of the samples out of contact, ``widest_gap`` in m how far flanks were apart
        along the line of action, ``holds`` whether leaving the coast flank out changed nothing: none parted,
        or the gap stayed below a backlash that is given. ``since`` is the time of the last sample before they
        parted first, s; None if they never did, or from the start: without effect on what came before.
        """
        return [self._check(index) for index in self._watched]

    def _check(self, index: int) -> Check:
        mesh, gap = self._system.scene.meshes[index], float(self._gap[index])
        first = int(self._first[index])
        room = mesh.coast.backlash if mesh.coast is not None else 0.0
        return Check(
            self._system.ledger.effect_adding(COAST_FLANKS),
            "coast flanks are not reached",
            mesh.name,
            bool(gap <= room),
            _contact_in_words(gap, mesh.coast is not None, room),
            {
                "parted": float(self._parted[index] / max(self._samples, 1)),
                "widest_gap": gap,
                "since": (first - 1) / self._system.sampling.rate if first > 0 else None,
            },
        )


def _contact_in_words(gap: float, known: bool, room: float) -> str:
    if gap == 0.0:
        return "the driving flanks stayed in contact"
    if known and gap <= room:
        return "the flanks lifted off by less than the backlash: the coast flank was not reached"
    if known:
        return "the flanks lifted off by more than the backlash: enable the effect"
    return "the flanks lifted off: valid only if the backlash is larger; give the mesh its coast flank"


# Whether linear bearings stayed loaded: a real one has clearance and lets an unloaded shaft float.


LIGHT = 1e-3
"""Part of the largest bearing force at the start below which a bearing counts as unloaded from the start."""


class _BearingLoadChecks:
    """Gathers, block by block, how long radial forces pointed away from the static load."""

    def __init__(self, system: System) -> None:
        scene = system.scene
        laws = {law.bushing for law in scene.bearing_laws}
        self._effect = system.ledger.effect_adding(BEARING_LAWS)
        off = scene.effects.get(self._effect) == "off"
        self._name = system.supports.name
        self._watched = [i for i, name in enumerate(self._name) if off or name not in laws]
        self._has_law = [self._name[i] in laws for i in self._watched]
        self._direction: FloatArray | None = None
        self._samples = 0
        self._unloaded = np.zeros(len(self._watched), dtype=np.int64)

    def see(self, series: SeriesBlock, _states: States) -> None:
        force = series["bearing_force"]  # (0, 3, T) where it is not stored
        if force.shape[0] != len(self._name) or force.shape[2] == 0:
            return
        radial = force[self._watched, :2]
        if self._direction is None:
            self._direction = _directions(radial[:, :, 0])
        along = np.einsum("bct,bc->bt", radial, self._direction)
        loaded = np.any(self._direction != 0.0, axis=1)
        self._unloaded += np.where(loaded, np.count_nonzero(along <= 0.0, axis=1), 0)
        self._samples += force.shape[2]

    def checks(self) -> list[Check]:
        """Return one per linear bearing that carries load at the start.

        ``unloaded`` is the share of the samples in which the force along the static load was not positive.
        """
        if self._direction is None:
            return []
        loaded = np.any(self._direction != 0.0, axis=1)
        return [self._check(row, index) for row, index in enumerate(self._watched) if loaded[row]]

    def _check(self, row: int, index: int) -> Check:
        share = float(self._unloaded[row] / max(self._samples, 1))
        reason = "the bearing stayed loaded"
        if share > 0.0:
            advice = "enable the effect" if self._has_law[row] else "give the bearing its clearance"
            reason = f"the load reversed in {100.0 * share:.3g} % of the run: {advice}"
        assumption, name = "linear bearing stays loaded", self._name[index]
        return Check(self._effect, assumption, name, share == 0.0, reason, {"unloaded": share})


def _directions(force: FloatArray) -> FloatArray:
    """Return unit vectors (b, 2) of the forces at the start, zero where a bearing hardly carries."""
    size = np.linalg.norm(force, axis=1)
    carries = size > LIGHT * np.max(size, initial=0.0)
    return np.asarray(np.where(carries[:, None], force / np.where(carries, size, 1.0)[:, None], 0.0))


class _RunCheck(Protocol):
    def see(self, series: SeriesBlock, states: States) -> None: ...

    def checks(self) -> list[Check]: ...


class RunChecks:
    """All checks of a run on its own model; `further` ones look at it too."""

    def __init__(self, system: System, further: Sequence[_RunCheck] = ()) -> None:
        own = (_ContactChecks, _AxisChecks, ForceChecks, _BearingLoadChecks, _HeldOperatingPointChecks)
        self._all: tuple[_RunCheck, ...] = (*(kind(system) for kind in own), *further)

    def see(self, series: SeriesBlock, states: States) -> None:
        """Take a block of unfiltered series, and the states they are of."""
        for each in self._all:
            each.see(series, states)

    def checks(self) -> list[Check]:
        """Return the checks of all that was seen."""
        return [check for each in self._all for check in each.checks()]
