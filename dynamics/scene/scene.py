"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Protocol

import numpy as np

from bounds import Quantity, Text, at_most, from_to
from dynamics.bearings import Bushing, PlanetBearing, RollingBearing
from dynamics.bearings.bearing_law import BearingLaw
from dynamics.bearings.matrix import least_share
from dynamics.bearings.row_law import row_law
from dynamics.bearings.seat import SEAT
from dynamics.checks import distinct, finite, not_negative, one_of, positive, within
from dynamics.errors import InputError, SolveError
from dynamics.forces import RollingContact, SpeedTorque, SpringCurve
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.joints.housing import DEFINITE
from dynamics.loads import AngleLaw, AppliedForce, LoadTorque, TimeLaw, Unbalance
from dynamics.meshes import GearMesh
from dynamics.parts import KINDS, LAWS_OF_BEARINGS, ON_A_SHAFT
from dynamics.settings import Integration, Outputs
from dynamics.shafts import DiscBody, GearBody, Shaft
from dynamics.shafts.shaft import OnShaft, on_length
from dynamics.types import FloatArray

# Housings and bushings with matrices: what they can carry, and where.


ISOTROPY = 1e-9  # relative
SEAT_AGREEMENT = 1e-3  # m; a bearing acts at its middle, which need not be that of its bore
IRRATIONAL = 1.0  # rad; what this turn leaves alone any turn does


def _check_housings(
    shafts: tuple[Shaft, ...],
    bushings: tuple[Bushing, ...],
    housings: tuple[Housing, ...],
    lawful: frozenset[str],
) -> None:
    """Each bushing sits in one housing at most; what a rotating frame holds is alike in all directions.

    A housing under a bearing that is not linear, of those named in `lawful`, is held in all directions.
    """
    by_name = {bushing.name: bushing for bushing in bushings}
    frames = {shaft.name: shaft.frame for shaft in shafts}
    taken: dict[str, str] = {}
    for index, housing in enumerate(housings):
        for position, name in enumerate(housing.bushings):
            field = f"housings[{index}].bushings[{position}]"
            one_of(field, name, list(by_name))
            if name in taken:
                raise InputError(field, name, f'in one housing only; "{taken[name]}" has it')
            if frames[by_name[name].shaft] is not None:
                bound = "a bushing of a shaft described in the fixed frame"
                raise InputError(field, name, bound, "A planetary set's frame turns against the housing.")
            taken[name] = housing.name
        _check_seat_positions(index, housing, shafts, by_name)
        if not lawful.isdisjoint(housing.bushings) and least_share(housing.matrices()[0]) <= DEFINITE:
            bound = "positive definite under bearings that are not linear"
            advice = "Hold the housing at its feet, or on mounts, in every direction that has a row."
            raise InputError(f"housings[{index}].stiffness", housing.name, bound, advice)
    for index, bushing in enumerate(bushings):
        if frames[bushing.shaft] is not None:
            _check_isotropic(f"bushings[{index}]", bushing)


def _check_seat_positions(
    index: int, housing: Housing, shafts: tuple[Shaft, ...], bushings: dict[str, Bushing]
) -> None:
    origins = {shaft.name: shaft.origin for shaft in shafts}
    for seat, (name, at) in enumerate(zip(housing.bushings, housing.seat_positions or (), strict=False)):
        bearing = bushings[name]
        expected = np.add(origins[bearing.shaft], (0.0, 0.0, bearing.position))
        off = np.subtract(at, expected)
        if float(np.max(np.abs(off))) > SEAT_AGREEMENT:
            x, y, z = (Quantity(float(value), "m", digits=3) for value in off)
            limit = Quantity(SEAT_AGREEMENT, "m")
            bound = Text.of("within ", limit, f' of "{name}"; it is off by ', x, ", ", y, ", ", z)
            advice = "Move and turn the mesh so that it stands as the scene does, z along the shafts."
            raise InputError(f"housings[{index}].seat_positions[{seat}]", at, bound, advice)


def _check_isotropic(field: str, bushing: Bushing) -> None:
    """Refuse a bushing seen from a rotating frame unless all directions across the axis are alike."""
    for name, matrix in (("stiffness", bushing.seat_stiffness), ("damping", bushing.seat_damping)):
        if not _alike_across(matrix):
            bound = "the same in all directions across the axis"
            raise InputError(f"{field}.{name}", bushing.name, bound, "The carrier's frame turns against it.")
    preload = np.zeros(SEAT) if bushing.preload is None else np.abs(bushing.preload)
    if np.any(preload[[0, 1, 3, 4]] > ISOTROPY * np.max(preload)):
        bound = "zero across the axis: the carrier's frame turns against it"
        raise InputError(f"{field}.preload", bushing.preload, bound)


def _alike_across(matrix: FloatArray) -> bool:
    """Whether a matrix in x, y, z, tilt_x, tilt_y (and rotation) is the same turned by any angle about z."""
    turn = np.eye(matrix.shape[0])
    c, s = np.cos(IRRATIONAL), np.sin(IRRATIONAL)
    turn[:2, :2] = turn[3:5, 3:5] = [[c, -s], [s, c]]
    off = np.abs(turn @ matrix @ turn.T - matrix)
    return bool(np.all(off <= ISOTROPY * np.max(np.abs(matrix), initial=0.0)))


# Shafts of different frames: which lie on one axis, and what may join them.


AXIS_AGREEMENT = 1e-9  # of a shaft's length: shafts nearer than this share an axis


def _check_frames(shafts: tuple[Shaft, ...], planet_bearings: tuple[PlanetBearing, ...]) -> None:
    """Frames are those of carriers, pins turn with the planet's own carrier."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, shaft in enumerate(shafts):
        if shaft.frame is None:
            continue
        one_of(f"shafts[{index}].frame", shaft.frame, list(by_name))
        if by_name[shaft.frame].frame != shaft.frame:
            bound = "a carrier: a shaft described in its own frame"
            raise InputError(f"shafts[{index}].frame", shaft.frame, bound, "Let the carrier name itself.")
    for index, bearing in enumerate(planet_bearings):
        field = f"planet_bearings[{index}].carrier"
        one_of(
            field, bearing.carrier, [by_name[bearing.shaft].frame or ""], "The frame of its planet's shaft."
        )
        if bearing.carrier == bearing.shaft:
            raise InputError(field, bearing.carrier, "another shaft than the planet's")


def _check_on_axis(
    shafts: tuple[Shaft, ...], kind: str, bearings: Sequence[Bushing | RollingBearing]
) -> None:
    """Planets have no bearings to the ground; `kind` is what a scene calls these."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, bearing in enumerate(bearings):
        shaft = by_name[bearing.shaft]
        if shaft.frame is not None and not on_axis(shaft, by_name[shaft.frame]):
            bound = "a shaft on the carrier's axis"
            raise InputError(f"{kind}[{index}].shaft", shaft.name, bound, "Planets rest on planet bearings.")


def _check_gravity(shafts: tuple[Shaft, ...], gravity: tuple[float, float, float]) -> None:
    """Gravity turns against rotating frames, unless it lies along the axis."""
    for axis, value in zip("xyz", gravity, strict=True):
        finite(f"gravity.{axis}", value)
    if any(gravity[:2]) and any(shaft.frame is not None for shaft in shafts):
        bound = "zero in x and y where shafts are described in a carrier's frame, which turns against it"
        raise InputError("gravity", gravity, bound)


def _check_couplings(shafts: tuple[Shaft, ...], couplings: tuple[Coupling, ...]) -> None:
    """Couplings with matrices join coaxial shafts, those across frames alike in all directions."""
    by_name = {shaft.name: shaft for shaft in shafts}
    for index, coupling in enumerate(couplings):
        first, second = by_name[coupling.first], by_name[coupling.second]
        if coupling.stiffness is None and coupling.damping is None:
            continue
        if not on_axis(first, second):
            suggestion = "Leave the matrices out: torsion alone joins any two shafts."
            raise InputError(f"couplings[{index}].second", second.name, "coaxial with the first", suggestion)
        if not crosses_frames(first, second, coupling):
            continue
        for side, shaft in (("first", first), ("second", second)):
            if shaft.frame is not None and not on_axis(shaft, by_name[shaft.frame]):
                bound = f"on the axis of its carrier {shaft.frame}, as it joins shafts of different frames"
                raise InputError(f"couplings[{index}].{side}", shaft.name, bound)
        for name, matrix in (("stiffness", coupling.stiffness), ("damping", coupling.damping)):
            if matrix is not None and not _alike_across(np.asarray(matrix, dtype=float)):
                bound = "the same in all directions across the axis, without terms between these and the axis"
                suggestion = "The frames of its shafts turn against each other."
                raise InputError(f"couplings[{index}].{name}", coupling.name, bound, suggestion)


def crosses_frames(first: Shaft, second: Shaft, coupling: Coupling) -> bool:
    """Whether a coupling has matrices and joins shafts of different frames."""
    return first.frame != second.frame and (coupling.stiffness is not None or coupling.damping is not None)


def on_axis(shaft: Shaft, carrier: Shaft) -> bool:
    """Whether `shaft` lies on the axis of `carrier`."""
    apart = math.dist(shaft.origin[:2], carrier.origin[:2])
    return apart <= AXIS_AGREEMENT * max(shaft.length, carrier.length)


# Laws of bearings that are not linear: what they can act on.


def _check_bearing_laws(
    bearings: Sequence[str],
    laws: Mapping[str, Sequence[BearingLaw]],
    rolling: Sequence[RollingBearing],
    rotating: frozenset[str],
) -> None:
    """Every law, by kind, has its own direction of one of `bearings`.

    `rotating` names the bearings of shafts described in a rotating frame.
    """
    for kind, parts in laws.items():
        for index, part in enumerate(parts):
            one_of(f"{kind}[{index}].bushing", part.bushing, bearings)
    for kind, parts in laws.items():
        distinct(kind, [part.acts_at for part in parts])
    for index, curve in enumerate(laws["spring_curves"]):
        if isinstance(curve, SpringCurve) and curve.bushing in rotating and curve.direction != "z":
            bound = '"z" on a shaft described in a carrier\'s frame, which turns against the bushing'
            raise InputError(f"spring_curves[{index}].direction", curve.direction, bound)
    for index, bearing in enumerate(rolling):
        _check_preload(f"rolling_bearings[{index}].axial_preload", bearing)


def _check_preload(field: str, bearing: RollingBearing) -> None:
    """Refuse an axial preload that no displacement of the rings makes."""
    try:
        row_law(bearing).shift  # noqa: B018 (computed and kept)
    except SolveError as error:
        raise InputError(field, bearing.axial_preload, "a force that the row carries", "Lower it.") from error


# Check of the positions of gears and bearings on their shafts.


def _check_positions(shafts: Sequence[Shaft], kind: str, parts: Sequence[OnShaft]) -> None:
    """Refuse a part of a `kind` ("gears", "bushings", "planet_bearings") that is off its shaft.

    Raises
    ------
    InputError
    """
    length = {shaft.name: shaft.length for shaft in shafts}
    for index, part in enumerate(parts):
        if not on_length(part.position, length[part.shaft]):
            ends = from_to(0.0, length[part.shaft], "m")
            bound = Text.of(f'on the shaft "{part.shaft}", ', ends, " from its left end")
            advice = "Lengthen the shaft, or move what sits on it."
            raise InputError(f"{kind}[{index}].position", part.position, bound, advice)


def _check_force_shafts(forces: Sequence[AppliedForce], shafts: Sequence[str]) -> None:
    for index, force in enumerate(forces):
        if force.turns_with is not None:
            one_of(f"forces[{index}].turns_with", force.turns_with, shafts)
        if not isinstance(force.course, TimeLaw):
            one_of(f"forces[{index}].course.shaft", force.course.shaft, shafts)


ON_VIOLATION = ("repeat", "fail", "report")
TOLERANCES = (1e-6, 0.5)
SAMPLE_LIMIT = 2e7  # a run's states are held in memory
LEAST_RATE = 1000.0  # Hz, of an output whose rate is chosen


class _Named(Protocol):
    @property
    def name(self) -> str: ...


class _MotionLaw(Protocol):
    """The law that sets the speed of one shaft in the kinematic motion."""

    @property
    def shaft(self) -> str: ...
    @property
    def speed(self) -> TimeLaw | AngleLaw: ...
    @property
    def rigid(self) -> bool: ...


@dataclass(frozen=True)
class Scene:
    """A geared system and its run.

    Attributes
    ----------
    shafts, gears, bushings, planet_bearings, couplings, meshes, drives, free_rotations, loads : tuples
    speed_torques, housings, discs, rolling_bearings, forces, unbalances : tuples
        Parts, each with a name unique among its kind. Drives and free rotations together set the kinematic
        motion of all shafts: one for each independent speed of the gearing.
    rolling_contacts, spring_curves : tuples
        Nonlinear laws of bearings; each names its bushing or planet bearing, which sits in no housing without
        mass.
    duration : float
        s.
    gravity : tuple of three floats
        Its acceleration in the fixed frame, m/s^2. Across the axis only without rotating frames.
    effects : mapping of str to str
        Effect name to ``"auto"``, ``"on"`` or ``"off"``; effects that are not named are ``"auto"``.
    outputs : Outputs
    integration : Integration
    on_violation : str
        If a run or a study violates an assumption: ``"repeat"`` runs again with the automatic effect that it
        needs, and raises if the result is invalid and no effect corrects it; ``"fail"`` raises at any
        violation, ``"report"`` reports it in the ledger's checks.
    tolerance : float or None
        Relative change of mean and peak-to-peak transmission error and of bearing forces that neglected
        automatic effects may cause in a run; None: effects are as the scene calls for them.
    highest_frequency : float or None
        Hz to which flexible shafts are resolved; None: half the output rate.
    """

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    meshes: tuple[GearMesh, ...]
    drives: tuple[ImposedRotation, ...]
    duration: float
    bushings: tuple[Bushing, ...] = ()
    loads: tuple[LoadTorque, ...] = ()
    planet_bearings: tuple[PlanetBearing, ...] = ()
    free_rotations: tuple[FreeRotation, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    speed_torques: tuple[SpeedTorque, ...] = ()
    housings: tuple[Housing, ...] = ()
    rolling_contacts: tuple[RollingContact, ...] = ()
    spring_curves: tuple[SpringCurve, ...] = ()
    discs: tuple[DiscBody, ...] = ()
    rolling_bearings: tuple[RollingBearing, ...] = ()
    forces: tuple[AppliedForce, ...] = ()
    unbalances: tuple[Unbalance, ...] = ()
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    effects: Mapping[str, str] = field(default_factory=dict)
    outputs: Outputs = field(default_factory=Outputs)
    integration: Integration = field(default_factory=Integration)
    on_violation: str = "repeat"
    tolerance: float | None = None
    highest_frequency: float | None = None

    def __post_init__(self) -> None:
        not_negative("duration", self.duration)
        one_of("on_violation", self.on_violation, ON_VIOLATION)
        if self.tolerance is not None:
            within("tolerance", self.tolerance, *TOLERANCES)
        if self.highest_frequency is not None:
            positive("highest_frequency", self.highest_frequency)
        check_samples(self.duration, self.outputs.sample_rate or LEAST_RATE)
        for kind in KINDS:
            distinct(kind, [part.name for part in getattr(self, kind)])
        shafts, gears = _names(self.shafts), _names(self.gears)
        distinct("planet_bearings", _names((*self.ground_bearings, *self.planet_bearings)))
        for kind in ON_A_SHAFT:
            for index, part in enumerate(getattr(self, kind)):
                one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
        _check_force_shafts(self.forces, shafts)
        placed = ("gears", "discs", "bushings", "rolling_bearings", "planet_bearings")
        for kind in (*placed, "forces", "unbalances"):
            _check_positions(self.shafts, kind, getattr(self, kind))
        for index, mesh in enumerate(self.meshes):
            one_of(f"meshes[{index}].driver", mesh.driver, gears)
            one_of(f"meshes[{index}].driven", mesh.driven, gears)
        for index, coupling in enumerate(self.couplings):
            for side in ("first", "second"):
                one_of(f"couplings[{index}].{side}", getattr(coupling, side), shafts)
        self._check_references()
        _check_frames(self.shafts, self.planet_bearings)
        for kind in ("bushings", "rolling_bearings"):
            _check_on_axis(self.shafts, kind, getattr(self, kind))
        _check_gravity(self.shafts, self.gravity)
        _check_couplings(self.shafts, self.couplings)
        _check_housings(
            self.shafts,
            self.ground_bearings,
            self.housings,
            frozenset(law.bushing for law in self.bearing_laws),
        )
        rotating = {shaft.name for shaft in self.shafts if shaft.frame is not None}
        _check_bearing_laws(
            [bearing.name for bearing in (*self.bushings, *self.planet_bearings)],
            {kind: getattr(self, kind) for kind in LAWS_OF_BEARINGS},
            self.rolling_bearings,
            frozenset(bushing.name for bushing in self.bushings if bushing.shaft in rotating),
        )

    def _check_references(self) -> None:
        """Something turns."""
        if not self.references:
            suggestion = "Add a drive, or a free rotation where only torques move the train."
            raise InputError("drives", 0, "at least one drive or free rotation", suggestion)
        if not self.free_rotations and all(drive.speed.extreme == 0.0 for drive in self.drives):
            suggestion = "Its sign sets the driving flank. If torques move it, add a free rotation."
            raise InputError("drives[0].speed", 0.0, "not zero all the time", suggestion)

    @property
    def references(self) -> tuple[_MotionLaw, ...]:
        """The laws of the kinematic motion: the drives, then the free rotations."""
        return (*self.drives, *self.free_rotations)

    @property
    def ground_bearings(self) -> tuple[Bushing, ...]:
        """All bearings between shafts and the ground: bushings, and those that rolling bearings act at."""
        return (*self.bushings, *(bearing.support for bearing in self.rolling_bearings))

    @property
    def bearing_laws(self) -> tuple[BearingLaw, ...]:
        """All that bearings do which is not linear, rolling elements averaged."""
        return self.laws_with(frozenset())

    def laws_with(self, passing: frozenset[str]) -> tuple[BearingLaw, ...]:
        """Return all that bearings do which is not linear; the elements of those `passing` one by one."""
        rows = (row_law(bearing, bearing.name in passing) for bearing in self.rolling_bearings)
        return (*chain.from_iterable(getattr(self, kind) for kind in LAWS_OF_BEARINGS), *rows)

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

    def mounted(self, shaft: str) -> tuple[GearBody | DiscBody, ...]:
        """Return the rigid bodies on the shaft called `shaft`: gears, then discs."""
        bodies: tuple[GearBody | DiscBody, ...] = (*self.gears, *self.discs)
        return tuple(body for body in bodies if body.shaft == shaft)

    def frame_index(self, shaft: int) -> int | None:
        """Return the index of the carrier in whose frame the shaft `shaft` is described, or None."""
        name = self.shafts[shaft].frame
        return None if name is None else self.shaft_index(name)

    def shaft_index(self, name: str) -> int:
        """Return the index of the shaft called `name`."""
        return _names(self.shafts).index(name)


def check_samples(duration: float, rate: float) -> None:
    """Refuse a run of too many samples.

    Raises
    ------
    InputError
        Naming its duration.
    """
    if duration * rate > SAMPLE_LIMIT:
        bound = at_most(SAMPLE_LIMIT / rate, "s", note=f", {SAMPLE_LIMIT:g} samples at {rate:g} Hz")
        suggestion = "Shorten the run, or lower outputs.mesh_orders or outputs.sample_rate."
        raise InputError("duration", duration, bound, suggestion)


def _names(parts: Iterable[_Named]) -> list[str]:
    return [part.name for part in parts]
