"""Checks that the parts of a scene fit each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bounds import Quantity, Text, from_to
from dynamics.bearings import Bushing
from dynamics.bearings.matrix import least_share
from dynamics.bearings.row_law import row_law
from dynamics.bearings.seat import SEAT
from dynamics.checks import distinct, finite, one_of
from dynamics.errors import InputError, SolveError
from dynamics.forces.laws import BEARING_PARTS
from dynamics.identity_cache import cached_by
from dynamics.joints.housing import DEFINITE
from dynamics.loads import TimeLaw
from dynamics.shafts import Shaft
from dynamics.shafts.shaft import PLACED, on_axis, on_length
from dynamics.types import FloatArray

if TYPE_CHECKING:
    from dynamics.scene.scene import Scene

ISOTROPY = 1e-9
"""Difference of directions over the largest stiffness, below which a bearing is isotropic."""
SEAT_AGREEMENT = 1e-3
"""Distance of a bearing from its seat, m, that is accepted: it acts at its middle, which need not be that of
its bore.
"""
IRRATIONAL = 1.0
"""Angle, rad, by which no symmetry but isotropy turns a matrix into itself."""


@cached_by(lambda scene: (*scene.parts.values(), scene.gravity, scene.temperatures))
def check_parts(scene: Scene) -> None:
    """Refuse a scene whose parts do not fit each other; once for scenes that differ by their run alone.

    Raises `InputError` naming the part, its field and the bound.
    """
    for check in (
        _check_names,
        _check_positions,
        _check_tooth_angles,
        _check_references,
        _check_temperatures,
        _check_frames,
        _check_gravity,
        _check_couplings,
        _check_housings,
        _check_bearing_laws,
    ):
        check(scene)


def _check_names(scene: Scene) -> None:
    """Check that parts have unique names, and name shafts and gears of the scene."""
    for kind, parts in scene.parts.items():
        distinct(kind, [part.name for part in parts if hasattr(part, "name")])
    bearings = (*scene.ground_bearings, *scene.planet_bearings)
    distinct("planet_bearings", [bearing.name for bearing in bearings])
    shafts = [shaft.name for shaft in scene.shafts]
    gears = [gear.name for gear in scene.gears]
    for kind, parts in scene.parts.items():
        for index, part in enumerate(parts):
            if hasattr(part, "shaft"):
                one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
    for index, force in enumerate(scene.forces):
        if force.turns_with is not None:
            one_of(f"forces[{index}].turns_with", force.turns_with, shafts)
        if not isinstance(force.course, TimeLaw):
            one_of(f"forces[{index}].course.shaft", force.course.shaft, shafts)
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


def _is_on_carrier_axis(scene: Scene, shaft: Shaft) -> bool:
    """Whether a shaft lies on the axis of its carrier, if it has one."""
    return shaft.frame is None or on_axis(shaft, scene.shaft(shaft.frame))
