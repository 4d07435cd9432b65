"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import chain
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from bounds import Quantity, Text, at_most, from_to
from dynamics.bearings import Bushing, PlanetBearing, RollingBearing
from dynamics.bearings.bearing_law import BearingLaw
from dynamics.bearings.matrix import least_share
from dynamics.bearings.row_law import row_law
from dynamics.bearings.seat import SEAT
from dynamics.checks import distinct, finite, not_negative, one_of, positive, within
from dynamics.errors import InputError, SolveError
from dynamics.forces import SpeedTorque
from dynamics.forces.laws import BEARING_PARTS, BearingLawParts
from dynamics.identity_cache import cached_by
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.joints.housing import DEFINITE
from dynamics.loads import AppliedForce, LoadTorque, TimeLaw, Unbalance
from dynamics.meshes import GearMesh
from dynamics.settings import Integration, Outputs
from dynamics.settings.level_quantity import LevelQuantity
from dynamics.shafts import DiscBody, GearBody, Shaft
from dynamics.shafts.shaft import PLACED, on_length
from dynamics.temperatures import Temperatures
from dynamics.types import FloatArray

ISOTROPY = 1e-9  # relative
SEAT_AGREEMENT = 1e-3  # m; a bearing acts at its middle, which need not be that of its bore
IRRATIONAL = 1.0  # rad; a matrix that this turn leaves unchanged is isotropic
AXIS_AGREEMENT = 1e-9  # distance over a shaft's length, below which shafts share an axis
ON_VIOLATION = ("repeat", "fail", "report")
TOLERANCES = (1e-6, 0.5)  # least and largest relative tolerance of a scene
LEVEL_TOLERANCES = (1e-9, 3.0)  # dB
SAMPLE_LIMIT = 2e7  # a run's states are held in memory
MIN_RATE = 1000.0  # Hz, of an output whose rate is chosen


@dataclass(frozen=True)
class Scene(BearingLawParts):
    """A geared system and its run."""

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    meshes: tuple[GearMesh, ...]
    drives: tuple[ImposedRotation, ...]
    duration: float
    """Duration of the run, s."""
    bushings: tuple[Bushing, ...] = ()
    loads: tuple[LoadTorque, ...] = ()
    planet_bearings: tuple[PlanetBearing, ...] = ()
    free_rotations: tuple[FreeRotation, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    speed_torques: tuple[SpeedTorque, ...] = ()
    housings: tuple[Housing, ...] = ()
    discs: tuple[DiscBody, ...] = ()
    rolling_bearings: tuple[RollingBearing, ...] = ()
    forces: tuple[AppliedForce, ...] = ()
    unbalances: tuple[Unbalance, ...] = ()
    """`speed_torques`, `housings`, `discs`, `rolling_bearings`, `forces`, `unbalances`: Parts, each with a
    name unique among its kind. Drives and free rotations together set the kinematic motion of all shafts: one
    for each independent speed of the gearing.
    """
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Acceleration of gravity in the fixed frame, m/s^2. A component across the axis needs a scene without
    rotating frames.
    """
    effects: Mapping[str, str] = field(default_factory=dict)
    """Effect name to ``"auto"``, ``"on"`` or ``"off"``; effects that are not named are ``"auto"``."""
    outputs: Outputs = field(default_factory=Outputs)
    integration: Integration = field(default_factory=Integration)
    on_violation: str = "repeat"
    """Reaction to a violated assumption of a run or a study. ``"repeat"`` runs again with the automatic
    effect that is needed, and raises if the result is invalid and no effect corrects it; ``"fail"`` raises at
    any violation, ``"report"`` reports it in the ledger's checks.
    """
    tolerance: float | None = None
    """Relative change of mean and peak-to-peak transmission error and of bearing forces that neglected
    automatic effects may cause in a run; None: effects are as the scene calls for them.
    """
    highest_frequency: float | None = None
    """Frequency to which flexible shafts are resolved, Hz; None: half the rate that all wanted orders need,
    up to 2.56 times the band of the output.
    """
    temperatures: Temperatures | None = None
    """Temperatures of the housing and, as far as stated, of shafts, gears and rings of rolling bearings.
    None: all parts as drawn.
    """
    quantity: LevelQuantity | None = None
    """Quantity for which the scene is computed. The change of its level sizes effects, and with a tolerance
    decides on them. None: bearing forces; transmission errors then decide too.
    """
    level_tolerance: float | None = None
    """Change of levels, dB, that neglected automatic effects may cause in a run, where `tolerance` is None.
    It is the level of `quantity`, by default of bearing forces and transmission errors.
    """

    def __post_init__(self) -> None:
        not_negative("duration", self.duration)
        one_of("on_violation", self.on_violation, ON_VIOLATION)
        if self.tolerance is not None:
            within("tolerance", self.tolerance, *TOLERANCES)
        if self.level_tolerance is not None:
            within("level_tolerance", self.level_tolerance, *LEVEL_TOLERANCES)
        if self.highest_frequency is not None:
            positive("highest_frequency", self.highest_frequency)
        check_samples(self.duration, self.outputs.sample_rate or MIN_RATE)
        _check_parts(self)

    @property
    def parts(self) -> dict[str, tuple[Any, ...]]:
        """All parts, by the names of the fields that hold them."""
        return {kind: getattr(self, kind) for kind in KINDS}

    @property
    def references(self) -> tuple[ImposedRotation | FreeRotation, ...]:
        """The laws of the kinematic motion: the drives, then the free rotations."""
        return (*self.drives, *self.free_rotations)

    @property
    def ground_bearings(self) -> tuple[Bushing, ...]:
        """All bearings between shafts and the ground: bushings, and the places of rolling bearings."""
        return (*self.bushings, *(bearing.support for bearing in self.rolling_bearings))

    @property
    def bearing_laws(self) -> tuple[BearingLaw, ...]:
        """Nonlinear laws of all bearings, rolling elements averaged."""
        return self.laws_with(frozenset())

    def laws_with(self, passing: frozenset[str]) -> tuple[BearingLaw, ...]:
        """Return the nonlinear laws of all bearings; the elements of those in `passing` pass one by one."""
        rows = (row_law(bearing, bearing.name in passing) for bearing in self.rolling_bearings)
        return (*self.scene_bearing_laws, *rows)

    @property
    def scene_bearing_laws(self) -> tuple[Any, ...]:
        """The nonlinear laws of bearings that are parts of the scene, each a `SceneBearingLaw`."""
        return tuple(chain.from_iterable(getattr(self, kind) for kind in BEARING_PARTS))

    def with_bearing_laws(self, change: Callable[[Any], BearingLaw]) -> Scene:
        """Return the scene with `change` of each of its `scene_bearing_laws` in its place."""
        laws: dict[str, Any] = {
            kind: tuple(change(law) for law in getattr(self, kind)) for kind in BEARING_PARTS
        }
        return replace(self, **laws)

    def require_meshes(self) -> None:
        """Refuse a scene without meshes to a study that compares transmission errors."""
        if not self.meshes:
            raise InputError("meshes", 0, "at least one: transmission errors are compared")

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

    def shaft(self, name: str) -> Shaft:
        """Return the shaft called `name`."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def crosses_frames(self, coupling: Coupling) -> bool:
        """Whether a coupling has matrices and joins shafts of different frames."""
        different_frames = self.shaft(coupling.first).frame != self.shaft(coupling.second).frame
        return different_frames and (coupling.stiffness is not None or coupling.damping is not None)

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
        return [shaft.name for shaft in self.shafts].index(name)


_KIND_OF = {
    kind: get_args(hint)[0]
    for kind, hint in get_type_hints(Scene).items()
    if get_origin(hint) is tuple and is_dataclass(get_args(hint)[0])
}
KINDS = tuple(_KIND_OF)
"""Kinds of parts: the fields of `Scene` that hold them."""
NAMED, ON_A_SHAFT = (
    tuple(kind for kind, part in _KIND_OF.items() if name in {field.name for field in fields(part)})
    for name in ("name", "shaft")
)
"""Kinds whose parts have a name, and those whose parts name the shaft that they are on."""


def check_samples(duration: float, rate: float) -> None:
    """Refuse a run of too many samples; raises `InputError` naming its duration."""
    if duration * rate > SAMPLE_LIMIT:
        bound = at_most(SAMPLE_LIMIT / rate, "s", note=f", {SAMPLE_LIMIT:g} samples at {rate:g} Hz")
        suggestion = "Shorten the run, or lower outputs.mesh_orders or outputs.sample_rate."
        raise InputError("duration", duration, bound, suggestion)


@cached_by(lambda scene: (*scene.parts.values(), scene.gravity, scene.temperatures))
def _check_parts(scene: Scene) -> None:
    """All parts fit each other; once for scenes that differ by their run alone."""
    _check_names(scene)
    _check_references(scene)
    _check_temperatures(scene)
    for check in (_check_frames, _check_gravity, _check_couplings, _check_housings, _check_bearing_laws):
        check(scene)


def _check_names(scene: Scene) -> None:
    """Check that parts have unique names, and name shafts and gears of the scene."""
    for kind in NAMED:
        distinct(kind, [part.name for part in getattr(scene, kind)])
    bearings = (*scene.ground_bearings, *scene.planet_bearings)
    distinct("planet_bearings", [bearing.name for bearing in bearings])
    shafts = [shaft.name for shaft in scene.shafts]
    gears = [gear.name for gear in scene.gears]
    for kind in ON_A_SHAFT:
        for index, part in enumerate(getattr(scene, kind)):
            one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
    for index, force in enumerate(scene.forces):
        if force.turns_with is not None:
            one_of(f"forces[{index}].turns_with", force.turns_with, shafts)
        if not isinstance(force.course, TimeLaw):
            one_of(f"forces[{index}].course.shaft", force.course.shaft, shafts)
    _check_positions(scene)
    _check_tooth_angles(scene)
    for kind, sides, names in (
        ("meshes", ("driver", "driven"), gears),
        ("couplings", ("first", "second"), shafts),
    ):
        for index, part in enumerate(getattr(scene, kind)):
            for side in sides:
                one_of(f"{kind}[{index}].{side}", getattr(part, side), names)


def _check_positions(scene: Scene) -> None:
    """Refuse a part that is off its shaft."""
    for kind in PLACED:
        for index, part in enumerate(getattr(scene, kind)):
            length = scene.shaft(part.shaft).length
            if not on_length(part.position, length):
                ends = from_to(0.0, length, "m")
                bound = Text.of(f'on the shaft "{part.shaft}", ', ends, " from its left end")
                remedy = "Lengthen the shaft, or move what sits on it."
                raise InputError(f"{kind}[{index}].position", part.position, bound, remedy)


def _check_tooth_angles(scene: Scene) -> None:
    """Shafts that state angles of teeth state one for each of their gears."""
    for index, shaft in enumerate(scene.shafts):
        gears = [gear.name for gear in scene.gears if gear.shaft == shaft.name]
        if shaft.tooth_angles is not None and len(shaft.tooth_angles) != len(gears):
            bound = f"{len(gears)} angles, one for each of its gears in their order: {', '.join(gears)}"
            raise InputError(f"shafts[{index}].tooth_angles", len(shaft.tooth_angles), bound)


def _check_references(scene: Scene) -> None:
    """Something turns."""
    if not scene.references:
        suggestion = "Add a drive, or a free rotation where only torques move the train."
        raise InputError("drives", 0, "at least one drive or free rotation", suggestion)
    if not scene.free_rotations and all(drive.speed.extreme == 0.0 for drive in scene.drives):
        suggestion = "Its sign sets the driving flank. If torques move it, add a free rotation."
        raise InputError("drives[0].speed", 0.0, "not zero all the time", suggestion)


def _check_temperatures(scene: Scene) -> None:
    """Every part that expands has a temperature where the housing has one, and none otherwise."""
    for path, value, needed in _temperatures(scene):
        if scene.temperatures is None and value is not None:
            raise InputError(path, value, "left out without [temperatures]", "Give that of the housing.")
        if scene.temperatures is not None and needed and value is None:
            remedy = "With [temperatures] shafts, gears and rings of rolling bearings have one each."
            raise InputError(path, None, "given", remedy)


def _temperatures(scene: Scene) -> Iterator[tuple[str, Any, bool]]:
    """Yield field and value of every temperature of a part, and whether it has to be given."""
    rings = ("inner_temperature", "outer_temperature")
    of_kinds = {"shafts": ("temperature",), "gears": ("temperature",), "rolling_bearings": rings}
    for kind, names in of_kinds.items():
        for index, part in enumerate(getattr(scene, kind)):
            yield from ((f"{kind}[{index}].{name}", getattr(part, name), True) for name in names)
    for kind in ("bushings", "rolling_bearings"):
        for index, part in enumerate(getattr(scene, kind)):
            yield f"{kind}[{index}].seat_temperature", part.seat_temperature, False


def _check_frames(scene: Scene) -> None:
    """Check that frames belong to carriers, pins to the planet's carrier, planets to pins alone."""
    shafts = [shaft.name for shaft in scene.shafts]
    for index, shaft in enumerate(scene.shafts):
        if shaft.frame is None:
            continue
        one_of(f"shafts[{index}].frame", shaft.frame, shafts)
        if scene.shaft(shaft.frame).frame != shaft.frame:
            bound = "a carrier: a shaft described in its own frame"
            raise InputError(f"shafts[{index}].frame", shaft.frame, bound, "Let the carrier name itself.")
    for index, bearing in enumerate(scene.planet_bearings):
        field, frame = f"planet_bearings[{index}].carrier", scene.shaft(bearing.shaft).frame
        one_of(field, bearing.carrier, [frame or ""], "The frame of its planet's shaft.")
        if bearing.carrier == bearing.shaft:
            raise InputError(field, bearing.carrier, "another shaft than the planet's")
    for kind in ("bushings", "rolling_bearings"):
        for index, part in enumerate(getattr(scene, kind)):
            if not _is_on_carrier_axis(scene, scene.shaft(part.shaft)):
                bound, remedy = "a shaft on the carrier's axis", "Planets rest on planet bearings."
                raise InputError(f"{kind}[{index}].shaft", part.shaft, bound, remedy)


def _is_on_carrier_axis(scene: Scene, shaft: Shaft) -> bool:
    """Whether a shaft lies on the axis of its carrier, if it has one."""
    return shaft.frame is None or on_axis(shaft, scene.shaft(shaft.frame))


def on_axis(shaft: Shaft, carrier: Shaft) -> bool:
    """Whether `shaft` lies on the axis of `carrier`."""
    distance = math.dist(shaft.origin[:2], carrier.origin[:2])
    return distance <= AXIS_AGREEMENT * max(shaft.length, carrier.length)


def _check_gravity(scene: Scene) -> None:
    """Gravity turns against rotating frames, unless it lies along the axis."""
    for axis, value in zip("xyz", scene.gravity, strict=True):
        finite(f"gravity.{axis}", value)
    if any(scene.gravity[:2]) and any(shaft.frame is not None for shaft in scene.shafts):
        bound = "zero in x and y where shafts are described in a carrier's frame, which turns against it"
        raise InputError("gravity", scene.gravity, bound)


def _check_couplings(scene: Scene) -> None:
    """Check that couplings with matrices join coaxial shafts; across frames they have to be isotropic."""
    for index, coupling in enumerate(scene.couplings):
        first, second = scene.shaft(coupling.first), scene.shaft(coupling.second)
        if coupling.stiffness is None and coupling.damping is None:
            continue
        if not on_axis(first, second):
            suggestion = "Leave the matrices out: torsion alone joins any two shafts."
            raise InputError(f"couplings[{index}].second", second.name, "coaxial with the first", suggestion)
        if not scene.crosses_frames(coupling):
            continue
        for side, shaft in (("first", first), ("second", second)):
            if not _is_on_carrier_axis(scene, shaft):
                bound = f"on the axis of its carrier {shaft.frame}, as it joins shafts of different frames"
                raise InputError(f"couplings[{index}].{side}", shaft.name, bound)
        for name, matrix in (("stiffness", coupling.stiffness), ("damping", coupling.damping)):
            if matrix is not None and not _alike_across(np.asarray(matrix, dtype=float)):
                bound = "the same in all directions across the axis, without terms between these and the axis"
                suggestion = "The frames of its shafts turn against each other."
                raise InputError(f"couplings[{index}].{name}", coupling.name, bound, suggestion)


def _check_housings(scene: Scene) -> None:
    """Check that each bushing sits in one housing at most, and that parts in rotating frames are isotropic.

    A housing under a bearing that is not linear is held in all directions.
    """
    bushings = {bushing.name: bushing for bushing in scene.ground_bearings}
    lawful = {law.bushing for law in scene.bearing_laws}
    housing_of_bushing: dict[str, str] = {}
    for index, housing in enumerate(scene.housings):
        for position, name in enumerate(housing.bushings):
            field = f"housings[{index}].bushings[{position}]"
            one_of(field, name, list(bushings))
            if name in housing_of_bushing:
                raise InputError(field, name, f'in one housing only; "{housing_of_bushing[name]}" has it')
            if scene.shaft(bushings[name].shaft).frame is not None:
                bound = "a bushing of a shaft described in the fixed frame"
                raise InputError(field, name, bound, "A planetary set's frame turns against the housing.")
            housing_of_bushing[name] = housing.name
        for seat, (name, at) in enumerate(zip(housing.bushings, housing.seat_positions or (), strict=False)):
            bearing = bushings[name]
            origin = scene.shaft(bearing.shaft).origin
            _check_seat_position(f"housings[{index}].seat_positions[{seat}]", at, bearing, origin)
        if not lawful.isdisjoint(housing.bushings) and least_share(housing.matrices()[0]) <= DEFINITE:
            bound = "positive definite under bearings that are not linear"
            remedy = "Hold the housing at its feet, or on mounts, in every direction that has a row."
            raise InputError(f"housings[{index}].stiffness", housing.name, bound, remedy)
    for index, bushing in enumerate(scene.ground_bearings):
        if scene.shaft(bushing.shaft).frame is not None:
            _check_isotropic(f"bushings[{index}]", bushing)


def _check_seat_position(
    field: str, at: Sequence[float], bearing: Bushing, origin: tuple[float, float, float]
) -> None:
    off = np.subtract(at, np.add(origin, (0.0, 0.0, bearing.position)))
    if float(np.max(np.abs(off))) > SEAT_AGREEMENT:
        x, y, z = (Quantity(float(value), "m", digits=3) for value in off)
        limit = Quantity(SEAT_AGREEMENT, "m")
        bound = Text.of("within ", limit, f' of "{bearing.name}"; it is off by ', x, ", ", y, ", ", z)
        remedy = "Move and turn the mesh so that it stands as the scene does, z along the shafts."
        raise InputError(field, at, bound, remedy)


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
    rotation_matrix = np.eye(matrix.shape[0])
    c, s = np.cos(IRRATIONAL), np.sin(IRRATIONAL)
    rotation_matrix[:2, :2] = [[c, -s], [s, c]]
    rotation_matrix[3:5, 3:5] = rotation_matrix[:2, :2]
    off = np.abs(rotation_matrix @ matrix @ rotation_matrix.T - matrix)
    return bool(np.all(off <= ISOTROPY * np.max(np.abs(matrix), initial=0.0)))


def _check_bearing_laws(scene: Scene) -> None:
    """Every law, by kind, has its own direction of a bearing that can have it."""
    bearings = {bearing.name: bearing for bearing in (*scene.bushings, *scene.planet_bearings)}
    laws = {kind: getattr(scene, kind) for kind in BEARING_PARTS}
    for kind, parts in laws.items():
        for index, part in enumerate(parts):
            one_of(f"{kind}[{index}].bushing", part.bushing, list(bearings))
    for kind, parts in laws.items():
        distinct(kind, [part.acts_at for part in parts])
    for kind, parts in laws.items():
        for index, law in enumerate(parts):
            bearing, field = bearings[law.bushing], law.fixed_direction
            turns = isinstance(bearing, Bushing) and scene.shaft(bearing.shaft).frame is not None
            if turns and field is not None:
                bound = '"z" on a shaft described in a carrier\'s frame, which turns against the bushing'
                raise InputError(f"{kind}[{index}].{field}", getattr(law, field), bound)
    for index, row in enumerate(scene.rolling_bearings):
        try:
            row_law(row).shift  # noqa: B018 (computed and kept)
        except SolveError as error:
            field, bound = f"rolling_bearings[{index}].axial_preload", "a force that the row carries"
            raise InputError(field, row.axial_preload, bound, "Lower it.") from error
