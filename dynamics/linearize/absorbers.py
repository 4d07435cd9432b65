"""The parts of a linearized system that take power from its vibration, each assembled by itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.assembly.motion_and_loads import drive_springs
from dynamics.bearings.seat import SEAT
from dynamics.forces.laws import Law
from dynamics.linearize.flank_cycles import FlankCycle
from dynamics.linearize.linear_system import LinearSystem
from dynamics.mechanism.columns import elastic_columns, elastic_terms, housing_columns
from dynamics.mechanism.frame_couplings import frame_couplings
from dynamics.motion.force_balance import swept_by_frames
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray

FLANKS = (Law.FLANK, Law.SPATIAL_FLANK)


@dataclass(frozen=True)
class _Absorber:
    """A part with k coordinates y = rows q, whose force against its motion is stiffness y + damping y'."""

    name: str
    kind: str
    """`name`, `kind`: Name of the part, and its kind, one of `KINDS`."""
    rows: FloatArray
    """Gradient of the coordinates in the freedoms. Shape (k, n)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Stiffness and damping of the part, N/m, N s/m. A symmetric stiffness takes no
    power over a cycle; where it is known to be symmetric, it is 0 here. Shape (k, k) each.
    """


def element_absorbers(
    system: System, linear: LinearSystem, cycles: tuple[FlankCycle, ...], time: float
) -> Iterator[_Absorber]:
    """Yield the force elements except those of rotating frames.

    `cycles` are the tangents of the flanks over a cycle; the flanks are the first elements.
    """
    arrays, elements = system.arrays, system.arrays.elements
    at_rest = np.zeros(arrays.mass.shape[0])
    local = local_state(arrays, time, q=linear.equilibrium.displacement, v=at_rest)
    tangents = local.tangent - swept_by_frames(elements, local, local.pace)  # elastic parts alone
    for e, (first, end) in enumerate(zip(elements.first[:-1], elements.first[1:], strict=True)):
        if elements.law[e] == Law.ROTATING_FRAME:
            continue
        element_rows = slice(first, end)
        tangent = cycles[e].tangent if e < len(cycles) else tangents[element_rows, : end - first]
        damping = local.viscous[element_rows, : end - first]
        yield _Absorber(*_element_part(system, e), arrays.direction[element_rows], tangent, damping)


def _element_part(system: System, element: int) -> tuple[str, str]:
    """Return the name of the part that a force element belongs to, and its kind."""
    scene, elements = system.scene, system.arrays.elements
    law, entry, count = elements.law[element], int(elements.entry[element]), elements.law.size
    bearings = (*system.housed, *system.bearings)  # in the order of the last elements
    if element >= count - len(bearings):
        return bearings[element - count].name, "bearing"
    if law in FLANKS:
        return scene.meshes[int(elements.mesh[element])].name, "mesh"
    if law == Law.FRAME_COUPLING:
        return system.couplings.name[frame_couplings(scene)[entry].coupling], "coupling"
    if law == Law.SPEED_TORQUE:
        return scene.speed_torques[entry].name, "load"
    loads = scene.forces if law == Law.APPLIED_FORCE else scene.unbalances
    return loads[entry].name, "load"


def bearing_absorbers(system: System) -> Iterator[_Absorber]:
    """Yield the linear bearings on the ground: single ones with springs, groups with matrices."""
    supports, seats, keep = system.supports, system.seats, system.freedoms.keep
    grounded = ~supports.carried
    for index in np.flatnonzero(grounded):
        damping = np.diag(supports.damping[index])
        yield _damper(supports.name[index], "bearing", keep(supports.motion[index]), damping)
    grounded_rows = np.repeat(grounded[seats.support], SEAT)
    for name, rows in seats.group:
        damping = seats.damping[rows, rows] * grounded_rows[rows]
        yield _damper(name, "bearing", keep(seats.motion[rows]), damping)


def coupling_absorbers(system: System) -> Iterator[_Absorber]:
    """Yield the couplings that are no force elements, and the elastic drives."""
    couplings, keep = system.couplings, system.freedoms.keep
    for name, motion, damping in zip(couplings.name, couplings.motion, couplings.damping, strict=True):
        yield _damper(name, "coupling", keep(motion), damping)
    for _, drive, row in drive_springs(system.scene, system.kinematics, system.rotors, system.freedoms):
        yield _damper(drive.name, "drive", row[None, :], np.array([[drive.damping]]))


def body_absorbers(system: System) -> Iterator[_Absorber]:
    """Yield the shafts that bend and the housings that move."""
    rotors, (_, dampers) = system.rotors, elastic_terms(system.rotors)
    columns = [(rotor.shaft.name, "shaft", elastic_columns(rotors, i)) for i, rotor in enumerate(rotors)]
    columns += [(part.name, "housing", housing_columns(rotors, i)) for i, part in enumerate(rotors.housings)]
    for name, kind, body_columns in columns:
        yield _damper(name, kind, system.freedoms.motion[body_columns], dampers[body_columns, body_columns])


def _damper(name: str, kind: str, rows: FloatArray, damping: FloatArray) -> _Absorber:
    return _Absorber(name, kind, rows, np.zeros_like(damping), damping)
