"""Static deflection of a scene under load cases."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bounds import inside
from dynamics.assembly.assemble import System, assemble
from dynamics.bearings import PlanetBearing, RollingBearing
from dynamics.bearings.rating_life import rating_life
from dynamics.bearings.row_law import row_law
from dynamics.checks import distinct, integer
from dynamics.deflection.loaded_scene import (
    ForceUnderCase,
    leader_of,
    leading_torque,
    loaded_scene,
)
from dynamics.deflection.mesh_alignment import (
    BearingStrain,
    MeshAlignment,
    Rest,
    bearing_strain,
    mesh_alignment,
    rest_over,
)
from dynamics.linearize.operating_speeds import common_period
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.shaft_axes import ShaftAxes, shaft_axes
from dynamics.scene.scene import Scene
from dynamics.settings.load_case import LoadCase, check_forces
from dynamics.types import FloatArray
from model_studies import in_unit
from model_studies.workers import InProcess, Workers, divided

# Basic reference rating life of rolling bearings under load cases, and over all of them.

LIFE_EXPONENT = 10.0 / 3.0
"""Of roller bearings; ball bearings have 3."""
MOST_POSITIONS = 512


def bearing_life(bearing: RollingBearing, displacement: FloatArray) -> float:
    """Return L_10r of a row in revolutions; NaN without a capacity, infinite where no element is loaded.

    The inner ring turns against a load that stands still. Loads of the elements are averaged over their
    passing. `displacement` (5,): of the inner ring against the outer, x, y, z, tilt_x, tilt_y, m and rad,
    without what makes the axial preload.
    """
    if bearing.dynamic_capacity is None:
        return math.nan
    law = row_law(bearing)
    moved = np.array(displacement, dtype=float)
    moved[2] += law.shift
    return rating_life(bearing.row, law.loaded.evaluate(moved).load, bearing.dynamic_capacity).revolutions


def life_duration(revolutions: Sequence[float], speed: Sequence[float], share: Sequence[float]) -> float:
    """Return the life under C load cases by linear damage, s: 1 / sum (q n / L) [2]_.

    Parameters
    ----------
    revolutions : (C,) sequence
        Life L under each case alone; may be infinite, NaN if not known.
    speed : (C,) sequence
        rad/s, >= 0.
    share : (C,) sequence
        Shares q of the duration, in any unit, not all 0.
    """
    part = np.asarray(share, dtype=float) / float(np.sum(share))
    turned = part * np.asarray(speed, dtype=float) / (2.0 * math.pi)  # revolutions per s
    damage = float(np.sum(turned / np.asarray(revolutions, dtype=float)))
    return math.inf if damage == 0.0 else 1.0 / damage


@dataclass(frozen=True)
class BearingLoad:
    """The load of a bearing under a load case, mean over the mesh cycle; x, y, z, tilt_x, tilt_y."""

    name: str
    shaft: str
    speed: float = field(metadata=in_unit("rad_s"))
    """Of the shaft against what holds the bearing, rad/s, >= 0."""
    force: FloatArray = field(metadata=in_unit("n", "direction"))
    """On the housing, of a planet bearing on the pin, N and N m. Shape (5,)."""
    largest_radial: float = field(metadata=in_unit("n"))
    """Over the cycle, N."""
    elastic: FloatArray = field(metadata=in_unit("m", "direction"))
    clearance: FloatArray = field(metadata=in_unit("m", "direction"))
    seat: FloatArray = field(metadata=in_unit("m", "direction"))
    """`elastic`, `clearance`, `seat`: Parts of the displacement of the shaft there, m and rad. Shape (5,)
    each.
    """
    rating_life: float = math.nan
    """Basic reference rating life L_10r at the mean displacement, revolutions; infinite where no element is
    loaded, NaN if the bearing has no dynamic capacity.
    """

    @property
    def radial(self) -> float:
        """Radial force, N."""
        return float(np.hypot(self.force[0], self.force[1]))

    @property
    def axial(self) -> float:
        """Axial force, N, positive towards +z."""
        return float(self.force[2])


def _bearing_loads(system: System, rest: Rest, strain: BearingStrain) -> tuple[BearingLoad, ...]:
    places, force = supports_by_name(system.rotors), rest.bearing_force
    speed = system.kinematics.float_ratio @ [drive.speed.extreme for drive in system.scene.drives]
    rows = {bearing.name: bearing for bearing in system.scene.rolling_bearings}
    loads = []
    for k, name in enumerate(system.supports.name):
        index, part = places[name]
        carrier = system.rotors[index].carrier if isinstance(part, PlanetBearing) else None
        held = 0.0 if carrier is None else speed[carrier]
        loads.append(
            BearingLoad(
                name=name,
                shaft=part.shaft,
                speed=abs(float(speed[index] - held)),
                force=force[:, k].mean(axis=0),
                largest_radial=float(np.max(np.hypot(force[:, k, 0], force[:, k, 1]))),
                elastic=strain.elastic[k],
                clearance=strain.clearance[k],
                seat=strain.seat[k],
                rating_life=bearing_life(rows[name], strain.elastic[k] + strain.clearance[k])
                if name in rows
                else math.nan,
            )
        )
    return tuple(loads)


def equivalent_load(
    load: Sequence[float],
    speed: Sequence[float],
    share: Sequence[float],
    exponent: float = LIFE_EXPONENT,
) -> float:
    """Return the constant load of the same life in revolutions as all load cases, N.

    P = (sum q n P^p / sum q n)^(1/p) with the shares q of the duration and the speeds n: linear damage, as in
    ISO 281. 0 where nothing turns.

    Parameters
    ----------
    load, speed, share : (C,) sequences
        N, rad/s, and any unit; >= 0.
    exponent : float
        p: 3 of ball bearings, 10/3 of roller bearings.
    """
    revolutions = np.asarray(share, dtype=float) * np.asarray(speed, dtype=float)
    total, largest = float(np.sum(revolutions)), float(np.max(load, initial=0.0))
    if total <= 0.0 or largest == 0.0:
        return 0.0
    relative = np.asarray(load, dtype=float) / largest
    mean = float(revolutions @ relative**exponent / total)
    return largest * float(mean ** (1.0 / exponent))


# Deflection lines of shafts.


@dataclass(frozen=True)
class _ShaftLines(ShaftAxes):
    """The axes of all shafts under a load case, mean over the mesh cycle."""

    motion: FloatArray = field(metadata=in_unit("m", "point", "freedom"))
    """x, y, z (m), tilt_x, tilt_y, rotation (rad): du_x/dz = tilt_y and du_y/dz = -tilt_x but for shear.
    Shape (P, 6).
    """


def _shaft_lines(system: System, motion: FloatArray) -> _ShaftLines:
    """Return the lines at `motion` (N,)."""
    axes = shaft_axes(system.scene, system.rotors)
    return _ShaftLines(axes.shaft, axes.position, axes.motion @ motion)


# Times at which all meshes of a system stand evenly spread over their cycles.


def cycle_times(system: System, positions: int) -> FloatArray:
    """Return the times (K,), s, at which every mesh takes K evenly spaced positions of its cycle, each once.

    K evenly spaced moments of the common period of all meshes are a lattice: a mesh of C base pitches in that
    period stands at k C / K, all different modulo 1 if C and K share no divisor. K is the least number of at
    least `positions` for which that is so of all meshes, so that their phases towards each other vary too.
    """
    period = common_period(system)
    cycles = [abs(pitches) for pitches in period.pitches if pitches]
    count = positions
    while any(math.gcd(cycle, count) > 1 for cycle in cycles):
        count += 1
    drive = system.scene.drives[period.law]
    return np.arange(count) / count * period.duration(drive.speed.extreme)


@dataclass(frozen=True)
class CaseDeflection:
    """The deflection of a scene under a load case."""

    name: str
    direction: str
    """`name`, `direction`: Of the load case."""
    share: float
    """Of the duration, relative to the other cases."""
    speed: float = field(metadata=in_unit("rad_s"))
    torque: float = field(metadata=in_unit("n_m"))
    """`speed`, `torque`: Of the leading shaft, rad/s and N m, both > 0."""
    status: str
    """Of the search for the rest positions, the worst of the cycle: "converged", "iteration_limit",
    "unbalanced". Only a converged case has figures to rely on.
    """
    residual: float
    """Largest unbalanced force over the largest mesh force."""
    meshes: tuple[MeshAlignment, ...]
    bearings: tuple[BearingLoad, ...]
    shafts: _ShaftLines
    forces: tuple[ForceUnderCase, ...] = ()
    """Of the scene; none in files of versions that did not keep them."""


@dataclass(frozen=True)
class Deflection:
    """The deflection of a scene under all its load cases."""

    leading_shaft: str
    cases: tuple[CaseDeflection, ...]

    @property
    def converged(self) -> bool:
        """Whether all cases were found."""
        return all(case.status == "converged" for case in self.cases)


def deflect(
    scene: Scene,
    cases: Sequence[LoadCase] = (LoadCase("load"),),
    positions: int = 16,
    progress: Callable[[float], None] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Deflection:
    """Return where the bodies of `scene` rest under each load case, mean over the mesh cycle.

    All effects of the scene that act at rest are on unless it switches them off: freedoms, elastic shafts,
    laws of bearings, and where tables have what it takes, the misalignment and the center distance at which
    they are read and the arm at which they press. Mesh and bodies are in balance at once. Raises
    `InputError`: by field name: a case that the scene cannot have, meshes that it does not press, no common
    period.

    Parameters
    ----------
    scene : Scene
    cases : sequence of LoadCase
        Their names differ. Default: the scene's own loads at t = 0.
    positions : int
        Least number of positions of the mesh cycle, see `cycle_times`.
    progress : callable, optional
        Called with the fraction done.
    workers : Workers
        They take a load case each.
    """
    distinct("load_cases", [case.name for case in cases])
    check_forces(cases, [force.name for force in scene.forces])
    integer("positions", positions, 1, MOST_POSITIONS)
    deflections = []
    for deflected in divided(workers, _deflected, (scene, positions), list(enumerate(cases))):
        deflections.append(deflected)
        if progress is not None:
            progress(len(deflections) / len(cases))
    return Deflection(leader_of(scene).shaft, tuple(deflections))


def _deflected(shared: tuple[Scene, int], numbered: tuple[int, LoadCase]) -> CaseDeflection:
    """Return the deflection of a scene under a load case: one task."""
    (scene, positions), (number, case) = shared, numbered
    with inside(f"load_cases[{number}]"):
        loaded = loaded_scene(scene, case)
    system = assemble(loaded)
    rest = rest_over(system, cycle_times(system, positions))
    motion = rest.motion.mean(axis=0)
    strain = bearing_strain(system, motion, rest.element.mean(axis=0))
    leader = leader_of(loaded)
    speed = abs(leader.speed)
    return CaseDeflection(
        name=case.name,
        direction=case.direction,
        share=case.share,
        speed=speed,
        torque=sum(leading_torque(loaded, leader, speed)),
        status=rest.status.name.lower(),
        residual=rest.residual,
        meshes=tuple(mesh_alignment(system, k, rest, strain) for k in range(len(loaded.meshes))),
        bearings=_bearing_loads(system, rest, strain),
        shafts=_shaft_lines(system, motion),
        forces=tuple(
            ForceUnderCase(part.name, part.shaft, np.array(part.force), np.array(part.moment))
            for part in loaded.forces
        ),
    )
