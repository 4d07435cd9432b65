"""A complaint about a scene or a pair: the order it is, per revolution of a shaft, and what passes beside."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from bounds import engineering
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
from lineofaction.gearbox.convert.case import boundary_errors
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
"""Harmonics that are listed beside a complaint, and that are named where none passes."""
EXCITATION, HARMONIC = "excitation", "harmonic number"
"""Ranks of what passes: by the force that excites; where that is not known, as if it fell with the number."""
_SURFACE = "Give a housing by step_file, mesh_file or modes_file, or leave the microphone out."
_SEVERAL = {MESH: "meshes", SIDEBAND: "meshes", SHAFT: "shafts", BEARING: "bearings"}


@dataclass(frozen=True)
class Complaint:
    """What is heard."""

    shaft: str
    """That orders are of."""
    order: float
    """Per revolution of it."""
    speed: float | None = field(metadata=in_unit("rad_per_s"))
    frequency: float | None = field(metadata=in_unit("hz"))
    """`speed`, `frequency`: Of the shaft, rad/s, and what is heard at it, Hz; None: an order at any speed."""
    tolerance: float
    """Relative."""
    passing: tuple[Passing, ...]
    """What is within the tolerance, and at least the `NEAREST` harmonics, the nearest first."""
    turns: Mapping[str, float]
    """Revolutions of every shaft per revolution of `shaft`."""
    per_pitch: float
    """Order by which results count, of the order: base pitches of the first mesh, without one revolutions of
    the leading shaft.
    """
    drivers: Mapping[str, tuple[str, float]]
    """Of every mesh the shaft of its driving gear, and how often it repeats per revolution of `shaft`."""
    levels: Mapping[str, tuple[float, ...]]
    """Forces, N, by which the harmonics of meshes excite at the loads of the scene; empty: not known."""
    bearing: str | None = None
    """Where it is measured; None: on the bearing that feels it most."""
    torques: Mapping[str, float] = field(default_factory=dict)
    """Of every mesh with a table the torque on its driving gear at which it is heard, N m."""

    @property
    def within(self) -> tuple[Passing, ...]:
        """What passes within the tolerance: meshes, the likeliest first, then what is nearer than all.

        A harmonic is as likely as its excitation is large (`ranked_by`), and less the farther off it is: at
        the tolerance, which counts as two standard deviations, by exp(-2).
        """
        near = [each for each in self.passing if each.within(self.tolerance)]
        meshes = [each for each in near if each.excitation.kind == MESH]
        closest = abs(meshes[0].distance) if meshes else math.inf
        others = [e for e in near if e.excitation.kind != MESH and abs(e.distance) < closest]
        known = self.ranked_by == EXCITATION
        return (*sorted(meshes, key=lambda each: -self._likelihood(each, known=known)), *others)

    @property
    def ranked_by(self) -> str:
        """What meshes within the tolerance are ranked by beside the distance: `EXCITATION` or `HARMONIC`."""
        near = [each for each in self.passing if each.within(self.tolerance)]
        meshes = [each for each in near if each.excitation.kind == MESH]
        known = all(math.isfinite(self.level(each)) for each in meshes)
        return EXCITATION if meshes and known else HARMONIC

    def _likelihood(self, each: Passing, *, known: bool) -> float:
        size = self.level(each) if known else 1.0 / each.harmonic
        return round(size * math.exp(-2.0 * (each.distance / self.tolerance) ** 2), 12)

    def level(self, each: Passing) -> float:
        """Return the force by which a harmonic of a mesh excites, N; NaN: not known."""
        levels = self.levels.get(each.excitation.name, ()) if each.excitation.kind == MESH else ()
        return levels[each.harmonic - 1] if each.harmonic <= len(levels) else math.nan

    def hertz(self, order: float) -> float | None:
        """Return the frequency of an order of the shaft, Hz; None: at any speed."""
        return None if self.speed is None else order * self.speed / (2.0 * math.pi)

    @property
    def marks(self) -> Json:
        """Return what plots mark: values by the labels of axes, and the order by which results count.

        `meshes` have it by which runs and tables count: by the pitches of a mesh, over speed and torque of
        its driving gear.
        """
        own = self.within[0].order
        marks: Json = {"order": own * self.per_pitch, "axes": {}, "bearing": self.bearing}
        marks |= {"words": sentence(self), "meshes": {}}
        for mesh, (shaft, rate) in self.drivers.items():
            speed = None if self.speed is None else self.turns[shaft] * self.speed / RPM
            at = {"driver_rpm": speed, "torque_n_m": self.torques.get(mesh)}
            marks["meshes"][mesh] = {"order": own / rate, **at}
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
    stated = scene.complaint
    assert stated is not None
    if stated.microphone_mm is not None and not any(part.has_surface for part in scene.housings):
        value, bound = list(stated.microphone_mm), "left out: no housing of the scene has a surface"
        raise BadInput.of("complaint.microphone_mm", value, bound, _SURFACE)
    kinematics, leading = solve_kinematics(moving), leading_shaft(moving)
    final = "" if stated.road_speed_km_h is None else _final_shaft(stated, scene)
    with boundary_errors("complaint"):
        own_turns = shaft_rates(moving, kinematics, stated.shaft or leading)
    shaft, speed = _shaft(stated, stated.shaft or leading, final, own_turns)
    with boundary_errors("complaint"):
        parts = excitations(moving, kinematics, shaft, _harmonics(stated))
    own, turns = _as_written(parts, scene), shaft_rates(moving, kinematics, shaft)
    if speed is not None:
        _refuse_beyond(scene, turns, speed)
    rate = next((each.rate for each in own if each.kind == MESH), turns[leading])
    return _complaint(
        stated,
        own,
        shaft,
        speed,
        turns={part.name: turns[part.name] for part in scene.shafts},
        drivers=_drivers(own, scene),
        per_pitch=1.0 / rate,
        levels=levels,
        torques=torques,
    )


def complaint_of_case(case: Case) -> Complaint:
    """Return the complaint of a case that has one, about its teeth and the turns of its gears.

    Raises `BadInput`: nothing passes within the tolerance.
    """
    stated = case.complaint
    assert stated is not None
    teeth = {"pinion": case.pair.pinion.teeth, "wheel": case.pair.wheel.teeth}
    final, own = stated.final_shaft or "wheel", stated.shaft or "pinion"
    shaft, speed = _shaft(stated, own, final, {name: teeth[own] / z for name, z in teeth.items()})
    turns = {name: teeth[shaft] / z for name, z in teeth.items()}
    mesh = Excitation(MESH, "pair", "", float(teeth[shaft]), _harmonics(stated))
    parts = [mesh, *(Excitation(SHAFT, name, "", turn, TURNS) for name, turn in turns.items())]
    highest = None if case.load.torque_n_m is None else case.load.torque_n_m[-1]
    torque = highest if stated.torque_n_m is None else stated.torque_n_m
    return _complaint(
        stated,
        parts,
        shaft,
        speed,
        turns=turns,
        drivers={"pair": ("pinion", mesh.rate)},
        per_pitch=1.0 / mesh.rate,
        levels={},
        torques={} if torque is None else {"pair": torque},
    )


def marks_of_case(case: Json) -> Json | None:
    """Return the marks in plots of the table of a case; None where it complains of nothing."""
    return complaint_of_case(validated(Case, case)).marks if case.get("complaint") else None


def _harmonics(stated: ComplaintInput) -> int:
    return HARMONICS if stated.orders is None else stated.orders


def _complaint(
    stated: ComplaintInput, own: Sequence[Excitation], shaft: str, speed: float | None, **known: Any
) -> Complaint:
    """Return the complaint at a speed of a shaft, rad/s, about what passes per revolution of it.

    `known` are attributes of it that follow from what the complaint is about.
    """
    order, hertz = _heard(stated, speed)
    tolerance = TOLERANCE if stated.tolerance_percent is None else stated.tolerance_percent / 100.0
    every = passing(own, order)
    reach = max(tolerance, *(abs(each.distance) + SAME for each in every[:NEAREST]))
    near = tuple(each for each in every if each.within(reach))
    complaint = Complaint(shaft, order, speed, hertz, tolerance, near, bearing=stated.bearing, **known)
    if not complaint.within:
        raise _nothing_passes(complaint, stated)
    return complaint


def _drivers(every: Iterable[Excitation], scene: SceneInput) -> dict[str, tuple[str, float]]:
    shafts = {gear.name: gear.shaft for gear in scene.gears}
    rates = {each.name: each.rate for each in every if each.kind == MESH}
    return {mesh.name: (shafts[mesh.driver], rates[mesh.name]) for mesh in scene.meshes if mesh.name in rates}


def leading_shaft(moving: Scene) -> str:
    """Return the first driven shaft, which speeds of studies are those of."""
    return next((part.shaft for part in moving.references if part.speed.extreme), moving.references[0].shaft)


def _heard(stated: ComplaintInput, speed: float | None) -> tuple[float, float | None]:
    """Return the order per revolution and the frequency, Hz; either follows from the other at a speed."""
    if stated.order is None:
        assert stated.frequency_hz is not None and speed is not None  # the schema has seen to it
        return 2.0 * math.pi * stated.frequency_hz / speed, stated.frequency_hz
    return stated.order, None if speed is None else stated.order * speed / (2.0 * math.pi)


def _shaft(
    stated: ComplaintInput, own: str, final: str, turns: Mapping[str, float]
) -> tuple[str, float | None]:
    """Return the shaft that orders are of, and its speed, rad/s; `turns` are those per revolution of `own`.

    An order at a road speed is of `own`, so that its speed follows from that of the wheels.
    """
    if stated.road_speed_km_h is None:
        return own, None if stated.speed_rpm is None else stated.speed_rpm * RPM
    assert stated.tire_radius_mm is not None  # the schema has seen to it
    wheel = stated.road_speed_km_h * KM_H / (stated.tire_radius_mm * MM)
    speed = wheel * (1.0 if stated.final_ratio is None else stated.final_ratio)
    if stated.order is None:
        return final, speed
    if not turns[final]:
        raise BadInput.of("complaint.final_shaft", final, "a shaft that turns", "Name the one of the wheels.")
    return own, speed / turns[final]


def _final_shaft(stated: ComplaintInput, scene: SceneInput) -> str:
    """Return the shaft that turns the wheels, or the only one with a load."""
    loaded = dict.fromkeys(part.shaft for part in scene.loads)
    loaded |= dict.fromkeys(part.shaft for part in scene.speed_torques)
    if stated.final_shaft is None and len(loaded) != 1:
        names = ", ".join(part.name for part in scene.shafts)
        bound = f"given, as {len(loaded) or 'no'} shafts have a load: one of {names}"
        raise BadInput.of("complaint.final_shaft", None, bound, "Name the one that turns the wheels.")
    return stated.final_shaft or next(iter(loaded))


def _refuse_beyond(scene: SceneInput, turns: Mapping[str, float], speed: float) -> None:
    """Refuse a speed (rad/s) at which a shaft is beyond its table of torques."""
    for index, part in enumerate(scene.speed_torques):
        own = turns[part.shaft] * speed / RPM
        if part.kind == "table" and not part.speed_rpm[0] <= own <= part.speed_rpm[-1]:
            bound = f"within speed_torques[{index}], {part.speed_rpm[0]:g} to {part.speed_rpm[-1]:g} rpm"
            advice = f"Extend the table of {part.name}, or check the speed of the complaint."
            value = f"{engineering(own, 4)} rpm of {part.shaft}"
            raise BadInput.of("complaint.speed_rpm", value, bound, advice)


def _as_written(every: Iterable[Excitation], scene: SceneInput) -> list[Excitation]:
    """Return the excitations of the parts that the scene names; copies of a planet pass where it does."""
    names = {
        MESH: {part.name for part in scene.meshes},
        SIDEBAND: {part.name for part in scene.meshes},
        SHAFT: {part.name for part in scene.shafts},
        BEARING: {part.name for part in scene.rolling_bearings},
    }
    return [each for each in every if each.name in names[each.kind]]


def _nothing_passes(complaint: Complaint, stated: ComplaintInput) -> BadInput:
    """Return the answer to a complaint that nothing passes: what is nearest, and how far it is."""
    name = "frequency_hz" if stated.order is None else "order"
    meshes = [each for each in complaint.passing if each.excitation.kind == MESH] or complaint.passing
    nearest = "; ".join(f"{words(alike)} {beside(complaint, alike[0])}" for alike in grouped(meshes)[:NAMED])
    share = engineering(100.0 * complaint.tolerance, 3)
    bound = f"within {share} % of what passes; nearest: {nearest}"
    advice = "Check speed, ratios and tire; or state tolerance_percent, or more orders."
    return BadInput.of(f"complaint.{name}", getattr(stated, name), bound, advice)


def sentence(complaint: Complaint) -> str:
    """Say what is heard and what it is."""
    first = grouped(complaint.within)[0]
    heard = f"order {engineering(complaint.order, 4)} of {complaint.shaft}"
    if complaint.speed is not None and complaint.frequency is not None:
        speed = f"{engineering(complaint.speed / RPM, 4)} rpm"
        heard = f"{engineering(complaint.frequency, 4)} Hz at {speed} of {complaint.shaft}"
    return f"{heard} is {words(first)} {beside(complaint, first[0])}"


def grouped(every: Iterable[Passing]) -> list[tuple[Passing, ...]]:
    """Return what passes, that of parts of a kind that pass alike at every speed together."""
    groups: dict[tuple[str, str, int, str], list[Passing]] = {}
    for each in every:
        of = each.excitation
        alike = of.kind, of.part, each.harmonic, f"{each.order:.9g}"
        groups.setdefault(alike, []).append(each)
    return [tuple(group) for group in groups.values()]


def words(alike: Sequence[Passing]) -> str:
    """Name a harmonic of one part, or of several as `grouped` returns them."""
    of = alike[0].excitation
    kind = _SEVERAL[of.kind]
    if len(alike) == 1:
        kind = MESH if of.kind == SIDEBAND else of.kind
    names = ", ".join(f'"{each.excitation.name}"' for each in alike)
    number = "order" if of.kind == SHAFT else "harmonic"
    if of.kind == SIDEBAND:
        return f"{of.part} sideband by the planets of harmonic {alike[0].harmonic} of {kind} {names}"
    return f"{number} {alike[0].harmonic} of {f'the {of.part} of ' if of.part else ''}{kind} {names}"


def beside(complaint: Complaint, each: Passing) -> str:
    """Say where a harmonic passes, and how far from the complaint."""
    hertz = complaint.hertz(each.order)
    if hertz is None or complaint.frequency is None:
        at, apart = f"order {engineering(each.order, 4)} of {complaint.shaft}", ""
    else:
        off = engineering(hertz - complaint.frequency, 2, "+")
        at, apart = f"{engineering(hertz, 4)} Hz", f" or {off} Hz"
    if abs(each.distance) < SAME:
        return f"at {at}, exactly"
    return f"at {at}, off by {engineering(100.0 * each.distance, 2, '+')} %{apart}"
