"""Levels of a scene by the flanks of one of its meshes: transfer functions once, then a table each.

L: load cases, K: lines of orders, S: speeds, H: harmonics of the common period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from dynamics.acoustics import ElementalRadiators
from dynamics.assembly.assemble import System, assemble
from dynamics.deflection.loaded_scene import with_loads
from dynamics.errors import DynamicsError
from dynamics.linearize import FlankTransfer, OtherFlanks, flank_transfer
from dynamics.linearize.common_period import common_period
from dynamics.linearize.transfer import FlankExcitation, parting_share, transfer_seconds
from dynamics.noise import (
    BearingForce,
    Quantity,
    QuantityForm,
    SoundModel,
    SoundPower,
    SoundPressure,
    SurfaceVelocity,
    Together,
    estimated_radiation,
)
from dynamics.scene import Scene
from dynamics.settings.load_case import LoadCase
from dynamics.types import FloatArray
from fe_contact.analysis.estimates.excitation_errors import excitation_errors
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.evaluator import deviating
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.change import (
    BEARING_FORCE,
    SOUND_POWER,
    SOUND_PRESSURE,
    SURFACE_VELOCITY,
    HeardInput,
)
from lineofaction.gearbox.studies.change.question import HeardQuestion, housing_of
from lineofaction.gearbox.studies.change.result import ALL
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.deflect.cases import load_cases
from lineofaction.gearbox.studies.housings import radiation_of
from lineofaction.gearbox.studies.scene_before_tables import scene_before_tables, sized
from lineofaction.gearbox.units import MM, RPM, UM

CANCELED = 0.1
"""Least part of an amplitude that errors in opposite phase leave: 20 dB."""
UNITS = {
    BEARING_FORCE: "dB re 1 N",
    SOUND_POWER: "dB(A) re 1 pW",
    SURFACE_VELOCITY: "dB re 1 nm/s",
    SOUND_PRESSURE: "dB(A) re 20 uPa",
}
_AT_REST, _PER_FREEDOM_2, _LEVEL = 6e-3, 1.2e-6, 0.01
"""Cost of a table in a load case: CPU seconds at rest, the same by freedoms squared, and the cost of a level
over that of its transfer functions. Measured within a factor of 2 from 5 to 170 freedoms."""


class FlankLevels(NamedTuple):
    """Levels (L, K), dB, and the share of the mesh force by which flanks part (L,), 0 if they do not."""

    level: FloatArray
    parting: FloatArray


@dataclass(frozen=True)
class HeardLoad:
    """A load case: transfer functions, quantity of sound or vibration, and lines of the harmonics."""

    load: LoadCase
    others: OtherFlanks = field(repr=False)
    """Scene at rest with other flanks of the mesh, linear about the flanks of the transfer functions."""
    transfer: FlankTransfer
    form: QuantityForm
    lines: FloatArray
    """1 where a harmonic of the common period belongs to a line. Shape (K, H)."""

    def with_table(self, table: SteDatabase) -> OtherFlanks:
        """Return the scene at rest with the flanks of a table."""
        return self.others.with_table(table.force_table())

    def power(self, flanks: FlankExcitation) -> FloatArray:
        """Return the power of the quantity with these flanks at each speed and harmonic (S, H)."""
        return self.form.weighted(self.transfer.inputs(flanks))

    def parting(self, flanks: FlankExcitation) -> float:
        """Return the largest share of the static mesh force by which flanks part; 0: they do not."""
        minimum = self.transfer.response(flanks).least_mesh_force.min(axis=1)
        return parting_share(minimum, flanks.mean_force)

    def levels(self, power: FloatArray, worst_speed: bool) -> FloatArray:
        """Return the levels (K,) of a weighted power (S, H), dB."""
        lines = power @ self.lines.T
        return self.form.decibels(lines.max(axis=0) if worst_speed else lines.mean(axis=0))

    def errors(self, table: SteDatabase, worst_speed: bool) -> FloatArray:
        """Return the errors of the levels below and above by the errors of a table, (2, K) dB.

        Those of transmission error, load arm and friction are independent; each adds in phase at worst. A
        stiffness that varies with position, which the levels leave out, comes on top.
        """
        scene = self.with_table(table)
        flanks = scene.excitation
        torque = abs(float(flanks.mean_force[scene.mesh])) * table.geometry.base_radius[0]
        errors = excitation_errors(table, table.geometry.normal_force(torque))
        known = np.minimum(np.arange(len(self.lines) - 1), errors.load_arm.size - 1)
        of_table = errors.transmission_error, errors.load_arm, errors.friction
        parts = tuple(level[known] @ self.lines[1:] for level in of_table)
        changes = self.transfer.excitation_errors(scene.at.system, flanks, scene.mesh, parts)
        inputs = self.transfer.inputs(flanks)
        added = np.moveaxis(self.transfer.input_changes(flanks, inputs, changes), 3, 0)
        off = np.sqrt(sum(self.form.weighted(amplitude) for amplitude in added))
        size = np.sqrt(self.form.weighted(inputs))
        low = self.levels(np.maximum(size - off, CANCELED * size) ** 2, worst_speed)
        level = self.levels(size**2, worst_speed)
        high = self.levels((size + off) ** 2, worst_speed)
        varied, _ = self.transfer.varied_inputs(scene.at, flanks)
        omitted = self.levels(self.form.weighted(varied), worst_speed) - level
        return np.stack([level - low - np.minimum(omitted, 0.0), high - level + np.maximum(omitted, 0.0)])


@dataclass(frozen=True)
class HeardFlanks:
    """A scene prepared to compute levels for other flanks of one mesh."""

    known: SteDatabase = field(repr=False)
    """Table of the mesh in the scene: flanks are solved at its forces, misalignment and center distance."""
    bodies: CondensedPair
    """Condensed gears of the mesh, on which the flanks of both designs are solved."""
    worst_speed: bool
    load_cases: tuple[HeardLoad, ...] = ()

    @property
    def torque(self) -> FloatArray:
        """The torque on the driving gear of the mesh (L,), N m."""
        force = [case.others.excitation.mean_force[case.others.mesh] for case in self.load_cases]
        return np.array(force) * self.known.geometry.base_radius[0]

    def table(self, pair: ParallelAxes, misalignment: float = 0.0) -> SteDatabase:
        """Return the table of flanks, at a misalignment in addition to that of the scene, m."""
        known = self.known
        force = np.union1d(known.force, known.support_force)
        torques = np.asarray(pair.torque(force[force <= self.bodies.largest_load * (1.0 + 1e-9)]))
        skew, change = float(known.misalignment[0]), float(known.center_distance_change[0])
        return self.bodies.table(pair, torques, skew + misalignment, change)

    def levels(self, table: SteDatabase) -> FlankLevels:
        """Return the levels with a table of the mesh."""
        level, parting = [], []
        for case in self.load_cases:
            flanks = case.with_table(table).excitation
            level.append(case.levels(case.power(flanks), self.worst_speed))
            parting.append(case.parting(flanks))
        return FlankLevels(np.stack(level), np.array(parting))

    def errors(self, table: SteDatabase) -> FloatArray:
        """Return the errors of the levels below and above by the errors of a table, (2, L, K) dB."""
        return np.stack([case.errors(table, self.worst_speed) for case in self.load_cases], axis=1)

    def of_pair(self, pair: ParallelAxes, names: Sequence[str], deviation: FloatArray) -> FlankLevels:
        """Return the levels of a design that deviates by (d,), m; no material is removed below zero."""
        by_name = dict(zip(names, deviation.tolist(), strict=True))
        misalignment = by_name.pop(MISALIGNMENT, 0.0)
        return self.levels(self.table(deviating(pair, by_name), misalignment))


def sound_loads(
    subject: TabledScene, mesh: str, question: HeardQuestion, tables: Sequence[SteDatabase], means: Means
) -> tuple[HeardLoad, ...]:
    """Solve the transfer functions under every load case, each about the flanks of its own table."""
    loads = load_cases(question.load_cases)
    systems = [system_with(subject, mesh, table, load) for table, load in zip(tables, loads, strict=True)]
    index = mesh_index(subject.scene, mesh)
    speed = np.array(question.speed_rpm) * RPM
    transfers = []
    for done, system in enumerate(systems):
        orders = period_orders(system, mesh, question.orders)
        transfers.append(flank_transfer(system, speed, orders, cache=means.home / FOLDER))
        means.report("transfer functions", (done + 1) / len(systems))
    quantity = quantity_of(subject, question.heard)
    model = _sound_model(subject, systems[0].scene, transfers[0].frequency, quantity, means)
    cases = []
    for load, system, transfer in zip(loads, systems, transfers, strict=True):
        step = abs(common_period(system).pitches[index])
        of_order = (step * np.arange(1, question.orders + 1))[:, None] == transfer.harmonics
        lines = np.vstack([of_order.any(axis=0), of_order]).astype(float)
        form = _form(subject, transfer, model, question.heard)
        cases.append(HeardLoad(load, OtherFlanks.of(system, index, transfer), transfer, form, lines))
    return tuple(cases)


class LevelsCost(NamedTuple):
    """CPU seconds of the transfer functions of all load cases, and of the levels of a table; the scene."""

    transfer: float
    per_table: float
    scene: Scene


def levels_cost(scene: SceneInput, mesh: str, question: HeardQuestion) -> LevelsCost | None:
    """Return the cost of levels by the flanks of a mesh; None: nothing predicts it.

    Neither modes nor the radiation of a solid housing are known before; they do not count. Raises `BadInput`.
    """
    before = scene_before_tables(scene)
    if before is None:
        return None
    cases = len(question.load_cases)
    speed = np.array(question.speed_rpm) * RPM
    try:
        system = sized(scene)
        transfer = cases * transfer_seconds(system, speed, period_orders(system, mesh, question.orders))
    except (DynamicsError, InputError):
        return None  # the study says it, on its own tables
    at_rest = _AT_REST + _PER_FREEDOM_2 * system.freedoms.column.size**2
    return LevelsCost(transfer, cases * at_rest + _LEVEL * transfer, before)


def period_orders(system: System, mesh: str, orders: int) -> int:
    """Return the number of orders of the first turning mesh that reach as far as orders of a mesh."""
    period = common_period(system)
    pitches = period.pitches[mesh_index(system.scene, mesh)]
    if not pitches:
        raise InputError("mesh", mesh, "one that turns")
    return math.ceil(orders * abs(pitches) / period.counted)


def mesh_index(scene: Scene, mesh: str) -> int:
    """Return the index of a mesh by its name."""
    return [part.name for part in scene.meshes].index(mesh)


def line_names(orders: int) -> tuple[str, ...]:
    """Return the names of the lines: all orders of the mesh together, then each."""
    return (ALL, *map(str, range(1, orders + 1)))


def quantity_of(subject: TabledScene, receiver: HeardInput) -> str:
    """Return the stated quantity, else sound pressure at a microphone, sound power or bearing force."""
    if receiver.quantity is not None:
        return receiver.quantity
    if receiver.microphone_mm is not None:
        return SOUND_PRESSURE
    sounds = any(body.surface is not None for body in subject.housings.values())
    return SOUND_POWER if sounds and receiver.bearing is None else BEARING_FORCE


def system_with(subject: TabledScene, mesh: str, table: SteDatabase, load: LoadCase) -> System:
    """Return the scene under a load case with another table of a mesh, run at the table's misalignment."""
    aligned = {"misalignment_um": float(table.misalignment[0]) / UM}
    meshes = tuple(
        part.model_copy(update=aligned) if part.name == mesh else part for part in subject.inputs.meshes
    )
    inputs = subject.inputs.model_copy(update={"meshes": meshes})
    scene = dynamic_scene(inputs, {**subject.databases, mesh: table}, subject.housings)
    return assemble(with_loads(scene, load))


def _sound_model(
    subject: TabledScene, scene: Scene, hertz: FloatArray, quantity: str, means: Means
) -> SoundModel:
    """Return the model of motion and radiation; for sound power with the estimate of its radiation."""
    bodies = {name: body for name, body in subject.housings.items() if body.surface is not None}
    sounding = bodies if quantity == SOUND_POWER else {}
    radiation = {
        name: estimated_radiation(body, radiation_of(body, ElementalRadiators(), hertz, means))
        for name, body in sounding.items()
    }
    return SoundModel(scene, bodies, radiation)


def _form(
    subject: TabledScene, transfer: FlankTransfer, model: SoundModel, receiver: HeardInput
) -> QuantityForm:
    of_bearings = transfer.bearing if receiver.bearing is None else (receiver.bearing,)
    x, y, z = receiver.microphone_mm or (0.0, 0.0, 0.0)
    microphone = x * MM, y * MM, z * MM
    parts: dict[str, Callable[[], tuple[Quantity, ...]]] = {
        SOUND_POWER: lambda: (SoundPower(),),
        SURFACE_VELOCITY: lambda: (SurfaceVelocity(housing_of(subject.inputs, receiver)),),
        SOUND_PRESSURE: lambda: (SoundPressure(housing_of(subject.inputs, receiver), microphone),),
        BEARING_FORCE: lambda: tuple(map(BearingForce, of_bearings)),
    }
    return Together(parts[quantity_of(subject, receiver)]()).form(transfer, model)
