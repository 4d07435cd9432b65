"""Exact speeds of all shafts: a linear system over fractions, from meshes, drives and free rotations.

A law is a given speed of a shaft over time: that of a drive, or that of a free rotation, whose shaft may
vibrate in rotation about it. The k laws are numbered drives first. All speeds are about +z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from dynamics.errors import InputError
from dynamics.identity_cache import cached_by
from dynamics.loads import TimeLaw
from dynamics.mechanism.train_speeds import TrainSpeeds
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

STANDSTILL = 1e-12  # speed over that of the fastest law, below which a part is at rest
STARTING_SPEED = 1e-6  # rad/s; the speed assumed of a free rotation that starts from rest, for its sense


@dataclass(frozen=True)
class Kinematics:
    """Motion of the shafts if all gears were conjugate: a speed is a sum of ratio times law over the laws."""

    law_shaft: tuple[int, ...]
    """Index of the shaft of each law: those of the drives, then those of the free rotations."""
    rigid: tuple[bool, ...]
    """Whether the rotation of the law's shaft follows the law exactly and is no freedom."""
    ratio: tuple[tuple[Fraction, ...], ...]
    """Exact speed of each shaft over the speed of each law, (shafts, laws)."""
    mesh_rate: tuple[tuple[Fraction, ...], ...]
    """Exact number of base pitches that a mesh advances per revolution of each law, (meshes, laws); positive
    in the sense of `mesh_sense`.
    """
    sense: tuple[int, ...]
    """Sense of each shaft when it turns fastest: +1 or -1 about +z, or 0 for a shaft at rest."""
    mesh_sense: tuple[int, ...]
    """Sense of the driver of each mesh when it turns fastest, +1 or -1 about +z; relative to the carrier if
    the driver runs on one.
    """

    @cached_property
    def imposed(self) -> frozenset[int]:
        """Indices of the shafts whose rotation is no freedom."""
        return frozenset(s for s, rigid in zip(self.law_shaft, self.rigid, strict=True) if rigid)

    @cached_property
    def float_ratio(self) -> FloatArray:
        """`ratio` as floats, (shafts, laws)."""
        return np.array([[float(value) for value in row] for row in self.ratio])

    @cached_property
    def float_mesh_rate(self) -> FloatArray:
        """`mesh_rate` as floats, (meshes, laws)."""
        rates = [[float(value) for value in row] for row in self.mesh_rate]
        return np.array(rates).reshape(len(rates), len(self.law_shaft))


def proportional_speeds(scene: Scene) -> FloatArray:
    """Return speeds (k,) of the laws in the proportion of their extremes; 1 each if all of them are 0."""
    extreme = np.array([part.speed.extreme for part in scene.references])
    return extreme if np.any(extreme) else np.ones(extreme.size)


def at_steady_speeds(scene: Scene, scale: float = 1.0) -> Scene:
    """Return a scene whose drives run at the constant speed of `scale` times their largest speeds."""
    drives = (
        replace(drive, speed=TimeLaw.constant(scale * float(drive.speed.extreme))) for drive in scene.drives
    )
    return replace(scene, drives=tuple(drives))


def _train(scene: Scene) -> tuple[object, ...]:
    """Return the parts of a scene that fix the kinematic motion; of a mesh these are its gears."""
    gears = (name for mesh in scene.meshes for name in (mesh.name, mesh.driver, mesh.driven))
    return (scene.shafts, scene.gears, scene.couplings, scene.drives, scene.free_rotations, *gears)


@cached_by(_train)
def solve_kinematics(scene: Scene) -> Kinematics:
    """Solve for the speeds of all shafts.

    A mesh of gears a and b on the carrier c (none: w_c = 0) requires (w_a - w_c) z_a = -(w_b - w_c) z_b, with
    + for a ring gear and its pinion. A coupling that joins rotations requires equal speeds. Drives and free
    rotations set the speeds that meshes and couplings leave open. Raises `InputError`: a mesh requires
    another ratio than the rest of the train, two drives set the same train, or nothing sets a shaft's speed.
    """
    speeds = TrainSpeeds(len(scene.shafts))
    for index in range(len(scene.meshes)):
        _add_mesh(scene, speeds, index)
    for index, coupling in enumerate(scene.couplings):
        if not coupling.joins_rotations:
            continue
        ends = scene.shaft_index(coupling.first), scene.shaft_index(coupling.second)
        known = speeds.ratio(*ends, None)
        if known is not None and known != 1:
            bound = f"a shaft of the same speed, not of {known} times it"
            raise InputError(f"couplings[{index}].second", coupling.second, bound)
        speeds.join(*ends, None, Fraction(1))
    for number, part in enumerate(scene.references):
        if not speeds.set_by_law(scene.shaft_index(part.shaft)):
            drives = len(scene.drives)
            field = f"drives[{number}]" if number < drives else f"free_rotations[{number - drives}]"
            bound = "a shaft whose speed no other drive sets"
            raise InputError(f"{field}.shaft", part.shaft, bound, "Leave out one of them.")
    open_shaft = speeds.open_shaft()
    if open_shaft is not None:
        suggestion = "Add a mesh, a drive or a free rotation, or leave the shaft out."
        name = scene.shafts[open_shaft].name
        raise InputError(f"shafts[{open_shaft}]", name, "geared to a drive or a free rotation", suggestion)
    return _resolved_kinematics(scene, speeds.ratios())


def mesh_shafts(scene: Scene, index: int) -> tuple[int, int, int | None]:
    """Return the shafts of driver and driven gear of a mesh, and the carrier they run on (None: ground)."""
    mesh = scene.meshes[index]
    a, b = (scene.shaft_index(scene.gear(name).shaft) for name in (mesh.driver, mesh.driven))
    return a, b, scene.frame_index(a)


def _add_mesh(scene: Scene, speeds: TrainSpeeds, index: int) -> None:
    mesh = scene.meshes[index]
    driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
    a, b, carrier = mesh_shafts(scene, index)
    field = f"meshes[{index}].driven"
    if a == b:
        raise InputError(field, mesh.driven, "on another shaft than the driver")
    if scene.frame_index(b) != carrier:
        shaft = scene.shafts[a if carrier is not None else b].name
        suggestion = (
            "Describe both shafts in the frame of the same carrier, or neither. Where shaft "
            f"{shaft} carries gears inside and outside of a planetary set, split it in two and join them by "
            "a coupling with its stiffness matrix."
        )
        raise InputError(field, mesh.driven, "on a shaft in the same frame as the driver's", suggestion)
    ratio = Fraction(driver.teeth, driven.teeth) * (1 if driver.internal or driven.internal else -1)
    known = speeds.ratio(a, b, carrier)
    if known is not None and known != ratio:
        raise InputError(f"meshes[{index}]", str(ratio), f"of ratio {known}, as other meshes require")
    speeds.join(a, b, carrier, ratio)
    # the new equation may leave a former mesh, or this one, no motion but rest
    for other in range(index + 1):
        first, _, frame = mesh_shafts(scene, other)
        if speeds.at_rest(first, frame):
            bound = "of a ratio that lets the train turn"
            raise InputError(
                f"meshes[{index}]", str(ratio), bound, f'It locks mesh "{scene.meshes[other].name}".'
            )


def _resolved_kinematics(scene: Scene, ratio: tuple[tuple[Fraction, ...], ...]) -> Kinematics:
    """Return the kinematics by the ratios of the shafts; refuse a mesh whose driver never turns."""
    law_shaft = tuple(scene.shaft_index(part.shaft) for part in scene.references)
    course = _speeds_over_time(scene)
    limit = STANDSTILL * float(np.max(np.abs(course), initial=0.0))
    rates, mesh_senses = [], []
    for index, mesh in enumerate(scene.meshes):
        a, _, carrier = mesh_shafts(scene, index)
        row = ratio[a]
        if carrier is not None:  # the driver turns relative to the carrier
            row = tuple(driver - frame for driver, frame in zip(row, ratio[carrier], strict=True))
        sense = _sense(row, course, limit)
        if sense == 0:
            bound = "a gear that turns" if carrier is None else "a gear that turns against its carrier"
            raise InputError(
                f"meshes[{index}].driver", mesh.driver, bound, "Its sense sets the driving flank."
            )
        mesh_senses.append(sense)
        rates.append(tuple(sense * scene.gear(mesh.driver).teeth * value for value in row))
    return Kinematics(
        law_shaft=law_shaft,
        rigid=tuple(part.rigid for part in scene.references),
        ratio=ratio,
        mesh_rate=tuple(rates),
        sense=tuple(_sense(row, course, limit) for row in ratio),
        mesh_sense=tuple(mesh_senses),
    )


def _speeds_over_time(scene: Scene) -> FloatArray:
    """Return the speeds of all laws at each time at which one of them has a knot, (laws, times), rad/s.

    A free rotation has its initial speed throughout.
    """
    times = sorted({time for part in scene.references for time in part.speed.time})
    rows = [drive.speed(np.array(times)) for drive in scene.drives]
    for free in scene.free_rotations:
        speed = free.initial_speed or STARTING_SPEED * free.forward
        rows.append(np.full(len(times), speed))
    return np.array(rows)


def _sense(row: tuple[Fraction, ...], course: FloatArray, limit: float) -> int:
    """Return the sign of the fastest speed of a part that turns at `row` times the laws; 0: it is at rest.

    `course` are speeds of the laws (laws, times); a part slower than `limit`, rad/s, is at rest.
    """
    speed = np.array([float(value) for value in row]) @ course
    fastest = float(speed[np.argmax(np.abs(speed))])
    return 0 if abs(fastest) <= limit else (1 if fastest > 0.0 else -1)
