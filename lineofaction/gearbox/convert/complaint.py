"""A complaint about a sound: its order per revolution of a shaft, and the excitations near that order."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from bounds import engineering, order_words, shaft_words
from bounds.types import Json
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.passing import (
    BEARING,
    MESH,
    SAME,
    SHAFT,
    SIDEBAND,
    TURNS,
    Excitation,
    Passing,
    excitations,
    passing,
    shaft_rates,
)
from dynamics.scene.scene import Scene
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.complaint import ComplaintInput
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import MM, RPM
from model_studies import in_unit

KM_H = 1.0 / 3.6
HARMONICS, TOLERANCE = 10, 0.05
NEAREST, NAMED = 6, 3
"""Number of harmonics listed around the order of a complaint, and number named if none passes."""
EXCITATION, HARMONIC = "excitation", "harmonic number"
"""Grounds on which harmonics near a complaint are ranked: by the force that excites, or, where no force is
known, as if the force fell with the number of the harmonic.
"""
PAIR = "pair"
"""Name of the mesh of a case, which has no other."""
_SURFACE = "Give a housing by step_file, mesh_file or modes_file, or leave the microphone out."
_SEVERAL = {MESH: "meshes", SIDEBAND: "meshes", SHAFT: "shafts", BEARING: "bearings"}


@dataclass(frozen=True)
class Complaint:
    """A disturbing sound, by its order and its shaft, with the excitations of the scene near that order."""

    shaft: str
    """Shaft to whose revolutions orders refer."""
    order: float
    """Order of the sound per revolution of `shaft`."""
    speed: float | None = field(metadata=in_unit("rad_per_s"))
    frequency: float | None = field(metadata=in_unit("hz"))
    """`speed`, `frequency`: Speed of the shaft, rad/s, and frequency of the sound at that speed, Hz; None: an
    order at any speed."""
    tolerance: float
    """Relative distance from the order within which an excitation passes."""
    passing: tuple[Passing, ...]
    """Excitations within the tolerance, and at least the `NEAREST` harmonics, the nearest first."""
    turns: Mapping[str, float]
    """Revolutions of every shaft per revolution of `shaft`."""
    per_pitch: float
    """Order by which results count, of the order: base pitches of the first mesh, without one revolutions of
    the leading shaft.
    """
    drivers: Mapping[str, tuple[str, float]]
    """Shaft of the driving gear of every mesh, and how often the mesh repeats per revolution of `shaft`."""
    levels: Mapping[str, tuple[float, ...]]
    """Forces, N, by which the harmonics of meshes excite at the loads of the scene; empty: not known."""
    bearing: str | None = None
    """Bearing where the vibration is measured; None: the bearing with the largest force."""
    torques: Mapping[str, float] = field(default_factory=dict)
    """Torque at which the complaint is made, on the driving gear of every mesh with a table, N m."""

    @property
    def within(self) -> tuple[Passing, ...]:
        """The excitations within the tolerance: meshes by likelihood, then others nearer than any mesh.

        A harmonic is as likely as its excitation is large (`ranked_by`), and less the farther off it is: at
        the tolerance, which counts as two standard deviations, by exp(-2).
        """
        near = [line for line in self.passing if line.within(self.tolerance)]
        meshes = [line for line in near if line.excitation.kind == MESH]
        closest = abs(meshes[0].distance) if meshes else math.inf
        others = [e for e in near if e.excitation.kind != MESH and abs(e.distance) < closest]
        known = self.ranked_by == EXCITATION
        return (*sorted(meshes, key=lambda line: -self._likelihood(line, known=known)), *others)

    @property
    def ranked_by(self) -> str:
        """The ground on which meshes within the tolerance are ranked: `EXCITATION` or `HARMONIC`."""
        near = [line for line in self.passing if line.within(self.tolerance)]
        meshes = [line for line in near if line.excitation.kind == MESH]
        known = all(math.isfinite(self.level(line)) for line in meshes)
        return EXCITATION if meshes and known else HARMONIC

    def _likelihood(self, line: Passing, *, known: bool) -> float:
        size = self.level(line) if known else 1.0 / line.harmonic
        return round(size * math.exp(-2.0 * (line.distance / self.tolerance) ** 2), 12)

    def level(self, line: Passing) -> float:
        """Return the force by which a harmonic of a mesh excites, N; NaN: not known."""
        levels = self.levels.get(line.excitation.name, ()) if line.excitation.kind == MESH else ()
        return levels[line.harmonic - 1] if line.harmonic <= len(levels) else math.nan

    def hertz(self, order: float) -> float | None:
        """Return the frequency of an order of the shaft, Hz; None: at any speed."""
        return None if self.speed is None else order * self.speed / (2.0 * math.pi)

    @property
    def marks(self) -> Json:
        """The marks of plots: values by the labels of axes, and the order by which results count.

        `meshes` have it by which runs and tables count: by the pitches of a mesh, over speed and torque of
        its driving gear.
        """
        order = self.within[0].order
        marks: Json = {"order": order * self.per_pitch, "axes": {}, "bearing": self.bearing}
        marks |= {"words": sentence(self), "meshes": {}}
        for mesh, (shaft, rate) in self.drivers.items():
            speed = None if self.speed is None else self.turns[shaft] * self.speed / RPM
            at = {"driver_rpm": speed, "torque_n_m": self.torques.get(mesh)}
            marks["meshes"][mesh] = {"order": order / rate, **at}
        if self.speed is not None:
            speeds = {f"speed of {name}, rpm": turn * self.speed / RPM for name, turn in self.turns.items()}
            marks["axes"] = speeds | {"frequency, Hz": self.frequency}
        return marks


def complaint_of(
    scene: SceneInput,
    moving: Scene,
    levels: Mapping[str, tuple[float, ...]] = MappingProxyType({}),
    torques: Mapping[str, float] = MappingProxyType({}),
) -> Complaint:
    """Return the complaint of a scene that has one, about the parts it has as written.

    `levels` and `torques` are those of the complaint.

    Raises `BadInput`: no such shaft turns, nothing passes within the tolerance, the speed is beyond a table
    of torques, or a microphone hears nothing.
    """
    fields = scene.complaint
    assert fields is not None
    if fields.microphone_mm is not None and not any(part.has_surface for part in scene.housings):
        value, bound = list(fields.microphone_mm), "left out: no housing of the scene has a surface"
        raise BadInput.of("complaint.microphone_mm", value, bound, _SURFACE)
    kinematics, leading = solve_kinematics(moving), leading_shaft(moving)
    final = "" if fields.road_speed_km_h is None else _final_shaft(fields, scene)
    with boundary_errors("complaint"):
        shaft_turns = shaft_rates(moving, kinematics, fields.shaft or leading)
    shaft, speed = _shaft(fields, fields.shaft or leading, final, shaft_turns)
    with boundary_errors("complaint"):
        parts = excitations(moving, kinematics, shaft, _harmonics(fields))
    parts_as_written, turns = _as_written(parts, scene), shaft_rates(moving, kinematics, shaft)
    if speed is not None:
        _refuse_beyond(scene, turns, speed)
    rate = next(
        (excitation.rate for excitation in parts_as_written if excitation.kind == MESH), turns[leading]
    )
    return _complaint(
        fields,
        parts_as_written,
        shaft,
        speed,
        turns={part.name: turns[part.name] for part in scene.shafts},
        drivers=_drivers(parts_as_written, scene),
        per_pitch=1.0 / rate,
        levels=levels,
        torques=torques,
    )


def complaint_of_case(case: Case) -> Complaint:
    """Return the complaint of a case that has one, about its teeth and the turns of its gears.

    Raises `BadInput`: nothing passes within the tolerance.
    """
    fields = case.complaint
    assert fields is not None
    teeth = {"pinion": case.pair.pinion.teeth, "wheel": case.pair.wheel.teeth}
    final, named_shaft = fields.final_shaft or "wheel", fields.shaft or "pinion"
    shaft, speed = _shaft(
        fields, named_shaft, final, {name: teeth[named_shaft] / z for name, z in teeth.items()}
    )
    turns = {name: teeth[shaft] / z for name, z in teeth.items()}
    mesh = Excitation(MESH, PAIR, "", float(teeth[shaft]), _harmonics(fields))
    parts = [mesh, *(Excitation(SHAFT, name, "", turn, TURNS) for name, turn in turns.items())]
    highest = None if case.load.torque_n_m is None else case.load.torque_n_m[-1]
    torque = highest if fields.torque_n_m is None else fields.torque_n_m
    return _complaint(
        fields,
        parts,
        shaft,
        speed,
        turns=turns,
        drivers={PAIR: ("pinion", mesh.rate)},
        per_pitch=1.0 / mesh.rate,
        levels={},
        torques={} if torque is None else {PAIR: torque},
    )


def marks_of_case(case: Json) -> Json | None:
    """Return the marks in plots of the table of a case; None where it complains of nothing."""
    return complaint_of_case(validated(Case, case)).marks if case.get("complaint") else None


def _harmonics(fields: ComplaintInput) -> int:
    return HARMONICS if fields.orders is None else fields.orders


def _complaint(
    fields: ComplaintInput, excitations: Sequence[Excitation], shaft: str, speed: float | None, **known: Any
) -> Complaint:
    """Return the complaint at a speed of a shaft, rad/s, with excitations per revolution of the shaft.

    `known` are attributes of it that follow from what the complaint is about.
    """
    order, hertz = _order_and_frequency(fields, speed)
    tolerance = TOLERANCE if fields.tolerance_percent is None else fields.tolerance_percent / 100.0
    passing_lines = passing(excitations, order)
    reach = max(tolerance, *(abs(line.distance) + SAME for line in passing_lines[:NEAREST]))
    near = tuple(line for line in passing_lines if line.within(reach))
    complaint = Complaint(shaft, order, speed, hertz, tolerance, near, bearing=fields.bearing, **known)
    if not complaint.within:
        raise _nothing_passes(complaint, fields)
    return complaint


def _drivers(every: Iterable[Excitation], scene: SceneInput) -> dict[str, tuple[str, float]]:
    shafts = {gear.name: gear.shaft for gear in scene.gears}
    rates = {excitation.name: excitation.rate for excitation in every if excitation.kind == MESH}
    return {mesh.name: (shafts[mesh.driver], rates[mesh.name]) for mesh in scene.meshes if mesh.name in rates}


def leading_shaft(moving: Scene) -> str:
    """Return the first driven shaft, to which speeds of studies refer."""
    return next((part.shaft for part in moving.references if part.speed.extreme), moving.references[0].shaft)


def _order_and_frequency(fields: ComplaintInput, speed: float | None) -> tuple[float, float | None]:
    """Return the order per revolution and the frequency, Hz; either follows from the other at a speed."""
    if fields.order is None:
        assert fields.frequency_hz is not None and speed is not None  # the schema has seen to it
        return 2.0 * math.pi * fields.frequency_hz / speed, fields.frequency_hz
    return fields.order, None if speed is None else fields.order * speed / (2.0 * math.pi)


def _shaft(
    fields: ComplaintInput, named_shaft: str, final: str, turns: Mapping[str, float]
) -> tuple[str, float | None]:
    """Return the shaft that orders are of, and its speed, rad/s.

    An order at a road speed is of `named_shaft`, so that its speed follows from that of the wheels; `turns`
    are those of the shafts in one revolution of it.
    """
    if fields.road_speed_km_h is None:
        return named_shaft, None if fields.speed_rpm is None else fields.speed_rpm * RPM
    assert fields.tire_radius_mm is not None  # the schema has seen to it
    wheel = fields.road_speed_km_h * KM_H / (fields.tire_radius_mm * MM)
    speed = wheel * (1.0 if fields.final_ratio is None else fields.final_ratio)
    if fields.order is None:
        return final, speed
    if not turns[final]:
        raise BadInput.of("complaint.final_shaft", final, "a shaft that turns", "Name the one of the wheels.")
    return named_shaft, speed / turns[final]


def _final_shaft(fields: ComplaintInput, scene: SceneInput) -> str:
    """Return the shaft that turns the wheels, or the only one with a load."""
    loaded = dict.fromkeys(part.shaft for part in scene.loads)
    loaded |= dict.fromkeys(part.shaft for part in scene.speed_torques)
    if fields.final_shaft is None and len(loaded) != 1:
        names = ", ".join(part.name for part in scene.shafts)
        bound = f"given, as {len(loaded) or 'no'} shafts have a load: one of {names}"
        raise BadInput.of("complaint.final_shaft", None, bound, "Name the one that turns the wheels.")
    return fields.final_shaft or next(iter(loaded))


def _refuse_beyond(scene: SceneInput, turns: Mapping[str, float], speed: float) -> None:
    """Refuse a speed (rad/s) at which a shaft is beyond its table of torques."""
    for index, part in enumerate(scene.speed_torques):
        turn_rate = turns[part.shaft] * speed / RPM
        if part.kind == "table" and not part.speed_rpm[0] <= turn_rate <= part.speed_rpm[-1]:
            bound = f"within speed_torques[{index}], {part.speed_rpm[0]:g} to {part.speed_rpm[-1]:g} rpm"
            remedy = f"Extend the table of {part.name}, or check the speed of the complaint."
            value = f"{engineering(turn_rate, 4)} rpm of {part.shaft}"
            raise BadInput.of("complaint.speed_rpm", value, bound, remedy)


def _as_written(every: Iterable[Excitation], scene: SceneInput) -> list[Excitation]:
    """Return the excitations of the parts that the scene names; copies of a planet pass where it does."""
    names = {
        MESH: {part.name for part in scene.meshes},
        SIDEBAND: {part.name for part in scene.meshes},
        SHAFT: {part.name for part in scene.shafts},
        BEARING: {part.name for part in scene.rolling_bearings},
    }
    return [excitation for excitation in every if excitation.name in names[excitation.kind]]


def _nothing_passes(complaint: Complaint, fields: ComplaintInput) -> BadInput:
    """Return the answer to a complaint without a cause: the nearest harmonics and their distances."""
    name = "frequency_hz" if fields.order is None else "order"
    meshes = [line for line in complaint.passing if line.excitation.kind == MESH] or complaint.passing
    nearest = "; ".join(
        f"{cause_words(complaint, alike)}, {offset_text(complaint, alike[0])}"
        for alike in grouped(meshes)[:NAMED]
    )
    share = engineering(100.0 * complaint.tolerance, 3)
    bound = f"within {share} % of what passes; nearest: {nearest}"
    remedy = "Check speed, ratios and tire; or state tolerance_percent, or more orders."
    return BadInput.of(f"complaint.{name}", getattr(fields, name), bound, remedy)


def sentence(complaint: Complaint) -> str:
    """Return a sentence on the sound and its likely cause."""
    first = grouped(complaint.within)[0]
    subject = order_words(complaint.order, complaint.shaft)
    if complaint.speed is not None and complaint.frequency is not None:
        speed = f"{engineering(complaint.speed / RPM, 4)} rpm"
        subject = f"{engineering(complaint.frequency, 4)} Hz at {speed} of {shaft_words(complaint.shaft)}"
    return f"{subject} is {cause_words(complaint, first)}, {offset_text(complaint, first[0])}"


def cause_words(complaint: Complaint, passings: Sequence[Passing]) -> str:
    """Return the order of the complaint's shaft and the harmonic together, of what `grouped` returns."""
    return order_words(passings[0].order, complaint.shaft, harmonic_label(passings))


def grouped(every: Iterable[Passing]) -> list[tuple[Passing, ...]]:
    """Return the excitations, grouped by parts of a kind that excite alike at every speed."""
    groups: dict[tuple[str, str, int, str], list[Passing]] = {}
    for line in every:
        of = line.excitation
        alike = of.kind, of.part, line.harmonic, f"{line.order:.9g}"
        groups.setdefault(alike, []).append(line)
    return [tuple(group) for group in groups.values()]


def harmonic_label(passings: Sequence[Passing]) -> str:
    """Name a harmonic of one part, or of several as `grouped` returns them."""
    of = passings[0].excitation
    if of.kind == MESH and of.name == PAIR:
        return f"harmonic {passings[0].harmonic}"
    kind = _SEVERAL[of.kind]
    if len(passings) == 1:
        kind = MESH if of.kind == SIDEBAND else of.kind
    names = ", ".join(f'"{line.excitation.name}"' for line in passings)
    number = "order" if of.kind == SHAFT else "harmonic"
    if of.kind == SIDEBAND:
        return f"{of.part} sideband by the planets of harmonic {passings[0].harmonic} of {kind} {names}"
    return f"{number} {passings[0].harmonic} of {f'the {of.part} of ' if of.part else ''}{kind} {names}"


def offset_text(complaint: Complaint, line: Passing) -> str:
    """Return the frequency of a harmonic, at any speed nothing, and its distance from the complaint."""
    hertz, at, offset = complaint.hertz(line.order), "", ""
    if hertz is not None and complaint.frequency is not None:
        off = engineering(hertz - complaint.frequency, 2, "+")
        at, offset = f"at {engineering(hertz, 4)} Hz, ", f" or {off} Hz"
    if abs(line.distance) < SAME:
        return f"{at}exactly"
    return f"{at}off by {engineering(100.0 * line.distance, 2, '+')} %{offset}"
