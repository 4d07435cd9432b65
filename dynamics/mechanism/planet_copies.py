"""Several planets from one: the same shaft, gears, bearings and meshes at other angles of the carrier."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeVar

from dynamics.bearings import PlanetBearing
from dynamics.checks import integer, one_of
from dynamics.errors import InputError
from dynamics.forces.laws import BEARING_PARTS
from dynamics.mechanism.kinematics import Kinematics, solve_kinematics
from dynamics.meshes import GearMesh
from dynamics.scene.scene import Scene, on_axis
from dynamics.shafts import DiscBody, GearBody, Shaft

TOOTH_FIT = 1e-6  # in teeth: largest misfit of a planet's teeth in all central gears by its angle

Turn = Fraction | float
Part = TypeVar("Part", GearBody, DiscBody, PlanetBearing)


def with_planets(
    scene: Scene,
    shaft: str,
    number: int,
    angles: Sequence[float] | None = None,
    pin_errors: Sequence[tuple[float, float]] | None = None,
) -> Scene:
    """Return `scene` with `number` copies of the planet on `shaft`; the phases of all meshes follow.

    Raises `InputError`: the shaft is no planet, or its teeth do not fit the central gears at an angle.

    Parameters
    ----------
    scene : Scene
        Scene with one planet.
    shaft : str
        Its shaft; it stays where it is. The others are called ``"<name> 2"``, ``"<name> 3"`` and so on, and
        likewise their gears, discs, bearings with their laws, and meshes.
    number : int
        Number of planets in all.
    angles : sequence of floats, optional
        Angles of all planets from the first about +z, rad, the first one 0. Left out: equally spaced.
    pin_errors : sequence of (radial, tangential), optional
        Errors of all pins, m, in place of those of the first planet's bearings.
    """
    integer("number", number, 1, 100)
    carrier = _carrier(scene, shaft)
    turns = _turns(number, angles)
    if pin_errors is not None and len(pin_errors) != number:
        raise InputError("pin_errors", len(pin_errors), f"one for each of the {number} planets")
    _check_teeth(scene, solve_kinematics(scene), shaft, turns)
    planet = scene.shaft(shaft)
    _, bearings = planet_parts(scene, shaft)
    copied = {name: [numbered(name, index) for index in range(1, number)] for name in bearings}
    error_by_planet = {numbered(shaft, index): error for index, error in enumerate(pin_errors or ())}
    laws: dict[str, Any] = {kind: _on_copies(getattr(scene, kind), copied) for kind in BEARING_PARTS}
    return replace(
        scene,
        shafts=(
            *scene.shafts,
            *(_turned_shaft(planet, carrier.origin, turns[i], i) for i in range(1, number)),
        ),
        gears=_with_copies(scene.gears, shaft, number),
        discs=_with_copies(scene.discs, shaft, number),
        planet_bearings=tuple(
            _with_error(bearing, error_by_planet.get(bearing.shaft))
            for bearing in _with_copies(scene.planet_bearings, shaft, number)
        ),
        meshes=(*scene.meshes, *_mesh_copies(scene, shaft, number)),
        **laws,
    )


def planet_parts(scene: Any, shaft: str) -> tuple[list[str], list[str]]:
    """Return the names of the meshes and of the bearings of a planet, which its copies have `numbered`.

    `scene` is a `Scene`, or one as it is written: with gears, meshes and planet bearings of these names.
    """
    gears = {gear.name for gear in scene.gears if gear.shaft == shaft}
    meshes = [mesh.name for mesh in scene.meshes if {mesh.driver, mesh.driven} & gears]
    return meshes, [bearing.name for bearing in scene.planet_bearings if bearing.shaft == shaft]


def _carrier(scene: Scene, shaft: str) -> Shaft:
    one_of("planet", shaft, [part.name for part in scene.shafts])
    carrier = scene.frame_index(scene.shaft_index(shaft))
    if carrier is None or on_axis(scene.shaft(shaft), scene.shafts[carrier]):
        bound = "a shaft in the frame of a carrier, off its axis"
        raise InputError("planet", shaft, bound, "Give the shaft its carrier as frame.")
    return scene.shafts[carrier]


def _with_copies(parts: Sequence[Part], shaft: str, number: int) -> tuple[Part, ...]:
    copies = [
        replace(part, name=numbered(part.name, index), shaft=numbered(part.shaft, index))
        for index in range(1, number)
        for part in parts
        if part.shaft == shaft
    ]
    return tuple(parts) + tuple(copies)


def _mesh_copies(scene: Scene, shaft: str, number: int) -> list[GearMesh]:
    of_shaft = {gear.name for gear in scene.gears if gear.shaft == shaft}
    meshes = [mesh for mesh in scene.meshes if {mesh.driver, mesh.driven} & of_shaft]
    return [_copied_mesh(mesh, of_shaft, index) for index in range(1, number) for mesh in meshes]


def _on_copies(laws: Sequence[Any], copied: Mapping[str, Sequence[str]]) -> tuple[Any, ...]:
    extended = list(laws)
    for law in laws:
        extended += [replace(law, bushing=name) for name in copied.get(law.bushing, ())]
    return tuple(extended)


def _turns(number: int, angles: Sequence[float] | None) -> list[Turn]:
    """Return the angles from the first planet in revolutions, exact where they are equally spaced."""
    if angles is None:
        return [Fraction(index, number) for index in range(number)]
    if len(angles) != number or angles[0] != 0.0:
        raise InputError("angles", list(angles), f"{number} angles, the first of them 0")
    return [angle / (2.0 * math.pi) for angle in angles]


def _check_teeth(scene: Scene, kinematics: Kinematics, shaft: str, turns: Sequence[Turn]) -> None:
    """Refuse planets whose teeth do not fit the central gears, exactly where they are equally spaced.

    The teeth of a central gear that turns against the carrier in the sense s come to a planet at the angle
    psi s z psi / (2 pi) pitches later. All central gears of a planet gear must require the same tooth, and
    the gears of a stepped planet, which are fixed on one shaft, the same angle of that shaft.
    """
    first: dict[str, list[Turn]] = {}
    teeth: dict[str, int] = {}
    for index, mesh in enumerate(scene.meshes):
        gears = scene.gear(mesh.driver), scene.gear(mesh.driven)
        if shaft not in (gears[0].shaft, gears[1].shaft):
            continue
        planet, central = gears if gears[0].shaft == shaft else gears[::-1]
        sense = kinematics.mesh_sense[index]
        if central is gears[1] and not central.internal:
            sense = -sense
        ahead: list[Turn] = [-sense * central.teeth * turn for turn in turns]
        _check_fit(ahead, first.setdefault(planet.name, ahead))
        teeth[planet.name] = planet.teeth
    _check_steps(first, teeth)


def _check_steps(offsets: Mapping[str, Sequence[Turn]], teeth: Mapping[str, int]) -> None:
    """Refuse a stepped planet whose copies would need another angle between their gears than the first one.

    A gear of z teeth that must be o teeth ahead lets the shaft stand at (o + k)/z turns, k = 0 to z - 1.
    """
    names = list(offsets)
    for name in names[1:]:
        gear = names[0]
        for index, (ahead, offset) in enumerate(zip(offsets[gear], offsets[name], strict=True)):
            angles = ((ahead + k) * Fraction(teeth[name], teeth[gear]) - offset for k in range(teeth[gear]))
            off = min((float(angle - round(angle)) for angle in angles), key=abs)
            if abs(off) > TOOTH_FIT:
                value = f'planet {index + 1}, off by {off:.6g} teeth of "{name}"'
                bound = f'where "{gear}" and "{name}" of a stepped planet fit at once, fixed as on the first'
                suggestion = "Change tooth numbers, the number of planets or their angles."
                raise InputError("number", value, bound, suggestion)


def _check_fit(turns: Sequence[Turn], other_turns: Sequence[Turn]) -> None:
    """Refuse a planet that would have to be at two angles at once."""
    for index, (a, b) in enumerate(zip(turns, other_turns, strict=True)):
        off = float(a - b)
        if abs(off - round(off)) > TOOTH_FIT:
            value = f"planet {index + 1}, off by {off - round(off):.6g} teeth"
            bound = "where its teeth fit all central gears: (z_sun + z_ring) angle / (2 pi) an integer"
            suggestion = "Change tooth numbers, the number of planets or their angles."
            raise InputError("number", value, bound, suggestion)


def numbered(name: str, index: int) -> str:
    """Return the name that a part has on a planet, by its number from 0."""
    return name if index == 0 else f"{name} {index + 1}"


def _turned_shaft(shaft: Shaft, axis: tuple[float, float, float], turn: Turn, index: int) -> Shaft:
    c, s = math.cos(2.0 * math.pi * float(turn)), math.sin(2.0 * math.pi * float(turn))
    x, y = shaft.origin[0] - axis[0], shaft.origin[1] - axis[1]
    origin = (axis[0] + c * x - s * y, axis[1] + s * x + c * y, shaft.origin[2])
    return replace(shaft, name=numbered(shaft.name, index), origin=origin)


def _copied_mesh(mesh: GearMesh, of_shaft: set[str], index: int) -> GearMesh:
    """Return the mesh of a copy; its position follows from the teeth, as for the first planet."""
    driver, driven = (numbered(g, index) if g in of_shaft else g for g in (mesh.driver, mesh.driven))
    return replace(mesh, name=numbered(mesh.name, index), driver=driver, driven=driven, position_offset=None)


def _with_error(bearing: PlanetBearing, error: tuple[float, float] | None) -> PlanetBearing:
    if error is None:
        return bearing
    return replace(bearing, radial_error=error[0], tangential_error=error[1])
