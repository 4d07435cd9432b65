"""Static deflection of a scene under load cases: where its bodies rest, mean over the mesh cycle.

Axes of arrays: N coordinates of the scene, P points of the shafts, K positions of the mesh cycle. The strain
of a bearing splits its displacement into an elastic part, its clearance and the motion of its seat.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bounds import inside
from dynamics.assembly.assemble import System, assemble
from dynamics.checks import distinct, integer
from dynamics.deflection.bearing_loads import BearingLoad, bearing_loads
from dynamics.deflection.bearing_strain import bearing_strain
from dynamics.deflection.loaded_scene import ForceUnderCase, leader_of, leading_torque, loaded_scene
from dynamics.deflection.mesh_alignment import MeshAlignment, mesh_alignment
from dynamics.deflection.rest_positions import rest_over
from dynamics.linearize.common_period import common_period
from dynamics.mechanism.shaft_axes import ShaftAxes, shaft_axes
from dynamics.scene.scene import Scene
from dynamics.settings.load_case import LoadCase, check_forces
from dynamics.types import FloatArray
from model_studies import in_unit
from model_studies.workers import InProcess, Workers, divided

MAX_POSITIONS = 512
"""Most positions of the mesh cycle that a caller may request: each one is a static equilibrium."""


@dataclass(frozen=True)
class _ShaftLines(ShaftAxes):
    """The displaced axes of all shafts under a load case, mean over the mesh cycle."""

    motion: FloatArray = field(metadata=in_unit("m", "point", "freedom"))
    """x, y, z (m), tilt_x, tilt_y, rotation (rad). Without shear du_x/dz = tilt_y and du_y/dz = -tilt_x.
    Shape (P, 6).
    """


def _shaft_lines(system: System, motion: FloatArray) -> _ShaftLines:
    """Return the shaft axes at the displacements `motion` (N,) of the scene."""
    axes = shaft_axes(system.scene, system.rotors)
    return _ShaftLines(axes.shaft, axes.position, axes.motion @ motion)


def cycle_times(system: System, positions: int) -> FloatArray:
    """Return the times (K,), s, at which every mesh takes K evenly spaced positions of its cycle, each once.

    The times are evenly spaced over the common period of all meshes. A mesh that passes C base pitches in
    this period is at position k C / K at time k; the positions are all different modulo 1 if C and K have no
    common divisor. K is the least number from `positions` on that has no common divisor with C of any mesh.
    The phases between meshes vary over the times, too.
    """
    period = common_period(system)
    cycles = [abs(pitches) for pitches in period.pitches if pitches]  # 0: the mesh is at rest
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
    """`name`, `direction`: Name and direction of the load case."""
    share: float
    """Share of the duration, relative to the other cases."""
    speed: float = field(metadata=in_unit("rad_s"))
    torque: float = field(metadata=in_unit("n_m"))
    """`speed`, `torque`: Speed and torque of the leading shaft, rad/s and N m, both > 0."""
    status: str
    """Worst status over the cycle of the search for the rest positions: "converged", "iteration_limit" or
    "unbalanced". The values of a case that did not converge are unreliable.
    """
    residual: float
    """Largest unbalanced force over the largest mesh force."""
    meshes: tuple[MeshAlignment, ...]
    bearings: tuple[BearingLoad, ...]
    shafts: _ShaftLines
    forces: tuple[ForceUnderCase, ...] = ()
    """Forces of the scene under the case. Files of older versions have none."""


@dataclass(frozen=True)
class Deflection:
    """The deflection of a scene under all its load cases."""

    leading_shaft: str
    cases: tuple[CaseDeflection, ...]

    @property
    def converged(self) -> bool:
        """Whether the rest positions of all cases converged."""
        return all(case.status == "converged" for case in self.cases)


def deflect(
    scene: Scene,
    cases: Sequence[LoadCase] = (LoadCase("load"),),
    positions: int = 16,
    progress: Callable[[float], None] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Deflection:
    """Return where the bodies of `scene` rest under each load case, mean over the mesh cycle.

    All effects that act at rest are on unless the scene switches them off: freedoms, elastic shafts and laws
    of bearings. If the mesh tables have these axes, they are read at the misalignment and the center distance
    of the bodies, and the mesh force acts at the arm of the table. Meshes and bodies are solved together.

    Raises `InputError`, by field name: the scene cannot have a case, a case leaves a mesh unloaded, or the
    meshes have no common period.

    Parameters
    ----------
    scene : Scene
    cases : sequence of LoadCase
        Load cases with different names. Default: the loads of the scene at t = 0.
    positions : int
        Least number of positions of the mesh cycle, see `cycle_times`.
    progress : callable, optional
        Called with the fraction done.
    workers : Workers
        Run the load cases, one a task.
    """
    distinct("load_cases", [case.name for case in cases])
    check_forces(cases, [force.name for force in scene.forces])
    integer("positions", positions, 1, MAX_POSITIONS)
    deflections = []
    for deflected in divided(workers, _case_deflection, (scene, positions), list(enumerate(cases))):
        deflections.append(deflected)
        if progress is not None:
            progress(len(deflections) / len(cases))
    return Deflection(leader_of(scene).shaft, tuple(deflections))


def _case_deflection(shared: tuple[Scene, int], numbered: tuple[int, LoadCase]) -> CaseDeflection:
    """Return the deflection of a scene under a load case: one task.

    All tasks share the scene and the number of positions; each has the number of its case and the case.
    """
    scene, positions = shared
    number, case = numbered
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
        torque=sum(leading_torque(loaded, leader, speed)),  # by loads at t = 0, and by all other torques
        status=rest.status.name.lower(),
        residual=rest.residual,
        meshes=tuple(mesh_alignment(system, k, rest, strain) for k in range(len(loaded.meshes))),
        bearings=bearing_loads(system, rest, strain),
        shafts=_shaft_lines(system, motion),
        forces=tuple(
            ForceUnderCase(part.name, part.shaft, np.array(part.force), np.array(part.moment))
            for part in loaded.forces
        ),
    )
