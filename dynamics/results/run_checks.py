"""Checks of a run on its own model, gathered from its series block by block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.errors import SolveError
from dynamics.mechanism.additions import BEARING_LAWS, COAST_FLANKS, MISALIGNMENT
from dynamics.mechanism.line_of_action import distance_gradient, misalignment_gradient
from dynamics.meshes import GearMesh
from dynamics.meshes.technique import table_at_operating_point
from dynamics.motion.observation import static_deflections
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock, ending
from dynamics.results.histories import FIELDS, axis_rows
from dynamics.results.small_motion import SmallMotionCheck
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, Json

WHAT = ("tilt", "center distance")
USUAL_TOLERANCE = 0.01
"""Relative change of the mean transmission error that may pass where no tolerance was requested."""
LIGHT = 1e-3
"""Part of the largest bearing force at the start below which a bearing counts as unloaded from the start."""
STRAIGHT_ON = 1.2
"""Times the highest load of a table: up to here it may go on straight, with its last stiffness.

The result is then reported as extrapolated. Beyond it is wrong: tooth pairs that would share the load, and
corner contact that would set in, are not in the table. A table of two levels is a closed form and holds
everywhere."""


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


class _HeldOperatingPointChecks:
    """Gathers, block by block, how far bodies moved along axes of tables that did not follow them."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._watched = [  # axes that are not followed, and the derivative of each in the freedoms (n,)
            (axis, index, _gradient(system, axis, index))
            for axis, field in enumerate(FIELDS)
            for index, mesh in enumerate(system.scene.meshes)
            if any(
                row.possible and not row.on for row in system.ledger.adding(field) if row.part == mesh.name
            )
        ]
        self._range = [(0.0, 0.0)] * len(self._watched)

    def see(self, _series: SeriesBlock, states: States) -> None:
        for k, (_, _, gradient) in enumerate(self._watched):
            moved = states.q @ gradient[: states.q.shape[1]]
            low, high = self._range[k]
            self._range[k] = (float(np.min(moved, initial=low)), float(np.max(moved, initial=high)))

    def checks(self) -> list[Check]:
        """Return one per mesh and axis.

        ``farthest`` is how far the bodies moved in m, ``change`` how much that changes the mean transmission
        error of the nominal force, of its value.
        """
        pairs = zip(self._watched, self._range, strict=True)
        return [self._check(axis, mesh, max(span, key=abs)) for (axis, mesh, _), span in pairs]

    def _check(self, axis: int, index: int, farthest: float) -> Check:
        system, quantity = self._system, WHAT[axis]
        mesh, force = system.scene.meshes[index], float(system.flanks.nominal_force[index])
        change = _change(mesh, force, axis, farthest)
        reported = (
            f"bodies moved by up to {farthest:.3g} m, which "
            f"changes the mean by {engineering(100.0 * change, 2)} %"
        )
        return Check(
            system.ledger.effect_adding(FIELDS[axis]),
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
        if self._direction is None:  # unit vectors of the forces at the start, zero where a bearing is light
            size = np.linalg.norm(radial[:, :, 0], axis=1)
            carries = size > LIGHT * np.max(size, initial=0.0)
            unit = radial[:, :, 0] / np.where(carries, size, 1.0)[:, None]
            self._direction = np.where(carries[:, None], unit, 0.0)
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


class _ForceChecks:
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

    Raises `SolveError`: a force is beyond its table and the scene's ``on_violation`` does not let that pass.
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
        mesh = scene.meshes[index]
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        radius = driven.base_radius if driver.internal else driver.base_radius  # whose torques it counts
        most = largest * radius
        digit = 10.0 ** (np.floor(np.log10(most)) - 1.0)
        rounded = float(np.ceil(most / digit) * digit)
        reason = (
            f"forces up to {largest:.4g} N, {times:.3g} times the table's highest load of {highest:.4g} N; "
            f"above it the table is extrapolated linearly, up to {STRAIGHT_ON:g} times. Compute it with "
            f"torques up to {rounded:g} N m, it ends at {highest * radius:.4g} N m"
        )
    figures = {**share, "largest": largest}
    name, valid = scene.meshes[index].name, times <= STRAIGHT_ON
    return Check("", "force inside the table", name, times <= 1.0, reason, figures, valid)


def _highest(scene: Scene, index: int) -> float:
    """Highest load of a mesh's table, N; of the lower one where the coast flank has its own."""
    coast = scene.meshes[index].coast
    tables = [scene.meshes[index].table, *([coast.table] if coast is not None and coast.table else [])]
    return min(float(table.level[-1]) for table in tables)


class _RunCheck(Protocol):
    def see(self, series: SeriesBlock, states: States) -> None: ...

    def checks(self) -> list[Check]: ...


class RunChecks:
    """All checks of a run on its own model; `further` ones look at it too."""

    def __init__(self, system: System, further: Sequence[_RunCheck] = ()) -> None:
        own = (_ContactChecks, _AxisChecks, _ForceChecks, _BearingLoadChecks, _HeldOperatingPointChecks)
        small = SmallMotionCheck(system)
        self._all: tuple[_RunCheck, ...] = (*(kind(system) for kind in own), small, *further)

    def see(self, series: SeriesBlock, states: States) -> None:
        """Take a block of unfiltered series, and the states they are of."""
        for each in self._all:
            each.see(series, states)

    def checks(self) -> list[Check]:
        """Return the checks of all that was seen."""
        return [check for each in self._all for check in each.checks()]
