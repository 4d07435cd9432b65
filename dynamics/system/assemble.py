"""From a scene to arrays: the main flow of this room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import InputError
from dynamics.forces.element_laws import ElementLaws
from dynamics.joints.bushing import SEAT
from dynamics.system.arrays import SystemArrays
from dynamics.system.bearing_elements import (
    BearingElement,
    bearing_elements,
    bearing_loads,
    bearing_places,
)
from dynamics.system.bearing_rest import linear_scene
from dynamics.system.coupling_rows import CouplingRows, gather_couplings
from dynamics.system.effects import FREEDOMS
from dynamics.system.effects.bearing_clearance import BearingClearance
from dynamics.system.effects.ledger import EffectLedger, keep_ledger, with_mesh_effects
from dynamics.system.elements import Element, gradients, pack_elements
from dynamics.system.flank_elements import flank_elements
from dynamics.system.flanks import Flanks, flank_laws, with_coast_flanks
from dynamics.system.freedoms import (
    ROTATION,
    Freedoms,
    find_freedoms,
    mass_diagonal,
    shared_blocks,
)
from dynamics.system.kinematics import Kinematics, mesh_shafts, solve_kinematics
from dynamics.system.line_of_action import LineOfAction, line_of_action
from dynamics.system.loaded_meshes import loaded_meshes
from dynamics.system.mesh_axes import mesh_axes
from dynamics.system.nominal_forces import nominal_forces
from dynamics.system.planets import kinematic_vectors, turning_inertia
from dynamics.system.references import lay_out_drives, lay_out_loads, lay_out_reference
from dynamics.system.rotor import Rotor, build_rotor
from dynamics.system.scene import Scene
from dynamics.system.seats import Seats, gather_seats, seated
from dynamics.system.spatial_elements import spatial_elements
from dynamics.system.speed_elements import speed_elements
from dynamics.system.supported_rotors import supported_rotors
from dynamics.system.supports import Supports, gather_supports
from dynamics.system.turning_elements import turning_elements
from dynamics.system.turning_rotors import turning_rotors
from dynamics.types import FloatArray, IntArray

GIVE_INERTIA = "Give the shaft or its gears mass and inertia (see hollow_cylinder)."


@dataclass(frozen=True)
class System:
    """An assembled scene.

    Attributes
    ----------
    scene : Scene
    arrays : SystemArrays
        For the compiled loops.
    freedoms : Freedoms
    kinematics : Kinematics
    lines : tuple of LineOfAction
        One per mesh.
    flanks : Flanks
        Force laws as resolved: nominal forces, damping, tables.
    elements : tuple of Element
        The driving flanks of all meshes, then everything else.
    rotors : tuple of Rotor
        One per shaft.
    supports : Supports
        Bushings, then planet bearings.
    seats : Seats
        The bushings that are more than three springs to rigid ground.
    bearings : tuple of BearingElement
        Where the last elements act, those of bearings that are not linear.
    couplings : CouplingRows
    bearing_stiffness, bearing_damping : (b, 3 or 6, n) arrays
        Force on the ground, or on the pin, at each support per freedom and its rate; where bearings may
        exert moments, these too.
    ledger : EffectLedger
    """

    scene: Scene
    arrays: SystemArrays
    freedoms: Freedoms
    kinematics: Kinematics
    lines: tuple[LineOfAction, ...]
    flanks: Flanks
    elements: tuple[Element, ...]
    rotors: tuple[Rotor, ...]
    supports: Supports
    seats: Seats
    bearings: tuple[BearingElement, ...]
    couplings: CouplingRows
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    ledger: EffectLedger

    @property
    def driving_rows(self) -> IntArray:
        """Rows of the transmission errors among the local coordinates, (m,): driving flanks come first."""
        return self.arrays.elements.first[: len(self.scene.meshes)]


def assemble(scene: Scene) -> System:
    """Assemble `scene`; without the effect `bearing_clearance`, bearings by their tangents at the load.

    Raises
    ------
    InputError
        If parts do not fit each other, or a free direction has no inertia.
    """
    system = _assemble(scene)
    if not system.bearings or scene.effects.get(BearingClearance().name) != "off":
        return system
    mesh_force = system.flanks.nominal_force @ system.arrays.direction[system.driving_rows]
    bearings = [(system.supports.name[at.support], at) for at in system.bearings]
    bushings = {part.name: part for rotor in system.rotors for part in rotor.bushings}
    linear = linear_scene(scene, system.arrays, bearings, bushings, -mesh_force)
    return replace(_assemble(linear), ledger=system.ledger)


def _assemble(scene: Scene) -> System:
    """Assemble `scene` as it is."""
    kinematics = solve_kinematics(scene)
    rotors = tuple(build_rotor(scene, shaft) for shaft in scene.shafts)
    lines = tuple(line_of_action(scene, index, sense) for index, sense in enumerate(kinematics.mesh_sense))
    inertia = turning_inertia(rotors)
    forces = nominal_forces(scene, kinematics, inertia)
    loads = bearing_loads(scene, rotors, forces)
    bearings, rotors = _with_bearings(scene, rotors, loads)
    supports, couplings = gather_supports(rotors, seated(scene)), gather_couplings(scene, rotors)
    seats = gather_seats(scene, rotors, supports.name)
    _check_rotation(rotors, kinematics)
    polar = [rotor.inertia.polar for rotor in rotors]
    flanks = flank_laws(scene, kinematics, forces, polar)
    turns = turning_rotors(scene, kinematics, rotors)
    carried = supported_rotors(scene, rotors, lines, forces, loads, turns)
    on_rotors = keep_ledger(scene.effects, carried)
    freedoms = find_freedoms(rotors, kinematics, on_rotors)
    _check_mass(freedoms, rotors)
    senses = kinematics.mesh_sense
    axes = mesh_axes(scene, rotors, senses, lines, freedoms, supports, flanks)
    meshes = loaded_meshes(scene, kinematics, flanks, polar, inertia, axes)
    ledger = with_mesh_effects(on_rotors, scene.effects, meshes)
    coast = [index for index, mesh in enumerate(scene.meshes) if ledger.on("backlash", mesh.name)]
    flanks = with_coast_flanks(flanks, scene.meshes, coast)
    plain = flank_elements(scene, rotors, senses, lines, flanks)
    in_space, spatial_laws = spatial_elements(
        scene, rotors, senses, flanks, plain, ledger, kinematic_vectors(rotors, kinematics)
    )
    by_speed, speed_laws = speed_elements(scene, kinematics)
    vectors = kinematic_vectors(rotors, kinematics)
    by_turning, turning_laws = turning_elements(
        scene, rotors, kinematics, vectors, freedoms, supports, seats, ledger
    )
    on_bearings, contact_laws, curve_laws = bearing_elements(scene, rotors, bearings, loads)
    elements = (*in_space, *by_speed, *by_turning, *on_bearings)
    laws = ElementLaws(flanks.law, speed_laws, contact_laws, curve_laws, spatial_laws, turning_laws)
    arrays = _arrays(scene, rotors, kinematics, freedoms, flanks, elements, laws, supports, seats, couplings)
    tilted = bool(seats.name) or any(kind >= 3 for at in bearings for kind in at.direction)
    return System(
        scene,
        arrays,
        freedoms,
        kinematics,
        lines,
        flanks,
        elements,
        rotors,
        supports,
        seats,
        bearings,
        couplings,
        _on_ground(freedoms, supports, supports.stiffness, seats, seats.stiffness, tilted),
        _on_ground(freedoms, supports, supports.damping, seats, seats.damping, tilted),
        ledger,
    )


def _with_bearings(
    scene: Scene, rotors: tuple[Rotor, ...], loads: dict[str, float]
) -> tuple[tuple[BearingElement, ...], tuple[Rotor, ...]]:
    """Return where laws of bearings act, and the rotors with their typical stiffness."""
    names = [bushing.name for rotor in rotors for bushing in rotor.bushings]
    radius = max((gear.base_radius for gear in scene.gears), default=1.0)
    places = bearing_places(scene, names, loads, radius)
    known = {bushing.name: (i, bushing) for i, rotor in enumerate(rotors) for bushing in rotor.bushings}
    found = list(rotors)
    for at in places:
        index, bushing = known[names[at.support]]
        rotor = found[index]
        found[index] = replace(rotor, curved=(*rotor.curved, (at.seat, rotor.lever(bushing))))
    return places, tuple(found)


def _on_ground(
    freedoms: Freedoms,
    supports: Supports,
    springs: FloatArray,
    seats: Seats,
    matrix: FloatArray,
    tilted: bool,
) -> FloatArray:
    """Force on the ground per freedom (b, 3, n); with moments (`tilted`) both, (b, 6, n)."""
    plain = springs[:, :, None] * freedoms.keep(supports.motion)
    if not tilted:
        return plain
    full = np.concatenate([plain, np.zeros_like(plain)], axis=1)
    full[seats.place, :SEAT] += (matrix @ freedoms.keep(seats.motion)).reshape(-1, SEAT, plain.shape[2])
    return full


def _arrays(
    scene: Scene,
    rotors: Sequence[Rotor],
    kinematics: Kinematics,
    freedoms: Freedoms,
    flanks: Flanks,
    elements: Sequence[Element],
    laws: ElementLaws,
    supports: Supports,
    seats: Seats,
    couplings: CouplingRows,
) -> SystemArrays:
    """Reduce every six-freedom array to the free directions."""
    moves, vectors = freedoms.keep(supports.motion), kinematic_vectors(rotors, kinematics)
    stiffness = supports.matrix(supports.stiffness, moves, moves)
    damping = supports.matrix(supports.damping, moves, moves)
    if couplings.name:
        strains = freedoms.keep(couplings.motion)
        stiffness += couplings.matrix(couplings.stiffness, strains, strains)
        damping += couplings.matrix(couplings.damping, strains, strains)
    constant = np.einsum("bki,bk,bk->i", moves, supports.stiffness, supports.error)
    if seats.name:
        strains = freedoms.keep(seats.motion)
        stiffness += strains.T @ seats.stiffness @ strains
        damping += strains.T @ seats.damping @ strains
        constant += seats.preload @ strains
    _add_drive_springs(scene, kinematics, freedoms, stiffness, damping)
    full_mass = mass_diagonal(rotors)
    mass = freedoms.motion.T @ (full_mass[:, None] * freedoms.motion)
    gradient = gradients(elements, 6 * len(rotors))
    scale, direction = _scales(scene, rotors, freedoms), freedoms.keep(gradient)
    packed = pack_elements(elements, laws, len(scene.references))
    along = direction[packed.first[: len(scene.meshes)]]
    held = np.diag(stiffness) + flanks.mean_stiffness @ along**2
    held += packed.stiffness @ direction**2
    return SystemArrays(
        np.ascontiguousarray(mass),
        damping,
        stiffness,
        shared_blocks([mass, damping, stiffness]),
        direction,
        freedoms.keep(_turns(scene, rotors, kinematics)),
        constant,
        freedoms.keep(-full_mass * vectors),
        np.ascontiguousarray((vectors * full_mass) @ vectors.T),
        lay_out_drives(scene, rotors, kinematics, freedoms, supports, couplings, gradient, vectors),
        scale,
        scale * np.sqrt(np.diag(mass) / np.maximum(held, 1e-300)),
        packed,
        lay_out_reference(scene, kinematics, freedoms, vectors),
        lay_out_loads(scene, kinematics, freedoms),
    )


def _add_drive_springs(
    scene: Scene, kinematics: Kinematics, freedoms: Freedoms, stiffness: FloatArray, damping: FloatArray
) -> None:
    """Add the springs between drives and their shafts."""
    for shaft, drive in zip(kinematics.law_shaft, scene.drives, strict=False):
        if drive.stiffness is not None:
            place = freedoms.find(shaft, ROTATION)
            stiffness[place, place] += drive.stiffness
            damping[place, place] += drive.damping


def _check_rotation(rotors: Sequence[Rotor], kinematics: Kinematics) -> None:
    """Every shaft free to turn needs a moment of inertia."""
    for index, rotor in enumerate(rotors):
        if index not in kinematics.imposed and rotor.inertia.polar <= 0.0:
            raise InputError(f"inertia of {rotor.shaft.name}.rotation", 0.0, "above 0", GIVE_INERTIA)


def _check_mass(freedoms: Freedoms, rotors: Sequence[Rotor]) -> None:
    """Every free direction needs inertia."""
    for name, value in zip(freedoms.name, mass_diagonal(rotors)[freedoms.place], strict=True):
        if value <= 0.0:
            raise InputError(f"inertia of {name}", float(value), "above 0", GIVE_INERTIA)


def _turns(scene: Scene, rotors: Sequence[Rotor], kinematics: Kinematics) -> FloatArray:
    """Return the derivatives of each position, (m, 6 r): the driver's rotation against its carrier's."""
    turn = np.zeros((len(scene.meshes), len(rotors), 6))
    for row, mesh in enumerate(scene.meshes):
        driver, _, carrier = mesh_shafts(scene, row)
        rate = kinematics.mesh_sense[row] * scene.gear(mesh.driver).teeth / (2.0 * math.pi)
        turn[row, driver, ROTATION] = rate
        if carrier is not None:
            turn[row, carrier, ROTATION] -= rate
    return turn.reshape(len(scene.meshes), 6 * len(rotors))


def _scales(scene: Scene, rotors: Sequence[Rotor], freedoms: Freedoms) -> FloatArray:
    """Metres per unit of each freedom, (n,): for rotations the largest base or pin radius on the shaft."""
    largest = max((gear.base_radius for gear in scene.gears), default=1.0)
    radius = np.zeros(len(rotors))
    for gear in scene.gears:
        shaft = scene.shaft_index(gear.shaft)
        radius[shaft] = max(radius[shaft], gear.base_radius)
    for rotor in rotors:
        if rotor.carrier is not None:
            arm = rotor.center - rotors[rotor.carrier].center
            radius[rotor.carrier] = max(radius[rotor.carrier], float(np.hypot(arm[0], arm[1])))
    scale = np.ones((len(rotors), len(FREEDOMS)))
    scale[:, 3:] = np.where(radius > 0.0, radius, largest)[:, None]
    return np.ascontiguousarray(scale.ravel()[freedoms.place])
