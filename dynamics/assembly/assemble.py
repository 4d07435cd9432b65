"""Assembly of a scene into arrays: the main flow of this package."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import NO_ENTRIES
from dynamics.assembly.bearing_rest import linear_scene
from dynamics.assembly.force_elements import force_elements
from dynamics.assembly.model import Model, decide_model
from dynamics.assembly.references import drive_springs, lay_out_drives, lay_out_loads, lay_out_reference
from dynamics.bearings.seat import SEAT
from dynamics.effects import EFFECTS, EffectLedger
from dynamics.forces.elements import Element, Elements
from dynamics.forces.laws import ElementLaws
from dynamics.kernels.by_address import by_address
from dynamics.mechanism.additions import BEARING_LAWS, ELEMENT_PASSING, HOUSING_AMPLITUDES
from dynamics.mechanism.base_pitches import Corrections
from dynamics.mechanism.bearing_elements import BearingElement, housed_bearings, tilt_lever
from dynamics.mechanism.bodies import Bodies, resting_housings, under_laws
from dynamics.mechanism.columns import column_count, times_mass, turn_row
from dynamics.mechanism.connections import (
    Connections,
    CouplingRows,
    Seats,
    elastic_matrices,
)
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.freedoms import FREEDOMS, ROTATION, Freedoms
from dynamics.mechanism.kinematics import Kinematics, mesh_shafts
from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.phases import phases
from dynamics.mechanism.sampling import Sampling, choose_sampling
from dynamics.mechanism.supports import Supports
from dynamics.mechanism.train_phases import TrainPhases
from dynamics.scene.scene import LEAST_RATE, Scene
from dynamics.types import FloatArray, IntArray, Json

# Forces of the shafts on the ground or on pins at every support, linear in state and local forces.

_NO_INDEX = np.zeros(0, dtype=np.int64)
LEAST_SEAT = 0.1
"""Least scale of an amplitude, of the largest."""
MESH_SHARE = 0.01
"""Share of a mode's strain energy in the meshes from which on they excite it."""
LAWS = frozenset((BEARING_LAWS, ELEMENT_PASSING))
"""What effects add to bearings that are not linear."""


class BearingForce(NamedTuple):
    """The sparse linear map from local forces (R), displacements (n) and rates (n) to forces at supports."""

    first: IntArray
    """Where the entries of each signal begin: 3 or 6 (with moments) signals per support, in its own frame.
    Shape (S + 1,).
    """
    column: IntArray
    """Local force, R + freedom, or R + n + freedom. Shape (E,)."""
    weight: FloatArray
    """N or N m per unit. Shape (E,)."""
    constant: FloatArray
    """N or N m. Shape (S,)."""
    freedoms: int
    """n."""

    def of(self, local: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return the signals (S, T) of the local forces (R, T), `q` and `v` (T, n).

        Freedoms that move no support may be missing at the end of `q` and `v`.
        """
        missing = [None] * (self.freedoms - q.shape[1])
        state = [*local, *q.T, *missing, *v.T]
        signals, part = np.empty((self.constant.size, q.shape[0])), np.empty(q.shape[0])
        signals[:] = self.constant[:, None]
        for signal, (start, end) in enumerate(zip(self.first[:-1], self.first[1:], strict=True)):
            for entry in range(start, end):
                signals[signal] += np.multiply(self.weight[entry], state[self.column[entry]], out=part)
        return signals


NO_SIGNALS = BearingForce(np.zeros(1, dtype=np.int64), _NO_INDEX, np.zeros(0), np.zeros(0), 0)
"""Of no support."""


def _bearing_force_map(
    stiffness: FloatArray,
    damping: FloatArray,
    joined: Connections,
    bearings: Sequence[BearingElement],
    elements: Elements,
) -> BearingForce:
    """Gather the map from `stiffness` and `damping` (b, 3 or 6, n) and the laws of the bearings.

    Springs of supports press against their errors, seats have preloads, and bearings that are not linear or
    sit in a housing that moves give their own forces: the last elements.
    """
    supports, seats, (count, rows, n) = joined.supports, joined.seats, stiffness.shape
    total = elements.offset.size
    weight = np.zeros((count, rows, total + 2 * n))
    weight[:, :, total : total + n], weight[:, :, total + n :] = stiffness, damping
    constant = np.zeros((count, rows))
    constant[:, :3] -= supports.stiffness * supports.error
    if seats.name:
        constant[seats.support, :SEAT] -= seats.preload.reshape(-1, SEAT)
    first = elements.first[len(elements.law) - len(bearings) :]
    for start, at in zip(first, bearings, strict=False):
        for local, way in enumerate(at.way, start=start):
            moved = np.flatnonzero(np.any(at.way != 0.0, axis=0))
            weight[at.support, moved, local] += way[moved]
    flat = weight.reshape(count * rows, total + 2 * n)
    signal, column = np.nonzero(flat)
    starts = np.searchsorted(signal, np.arange(count * rows + 1))
    return BearingForce(
        starts.astype(np.int64), column.astype(np.int64), flat[signal, column], constant.ravel(), n
    )


# A model laid out as the plain arrays that the compiled loops see.


def _system_arrays(model: Model, elements: Sequence[Element], laws: ElementLaws) -> SystemArrays:
    """Reduce every array over all freedoms to the free directions."""
    mechanism, freedoms, joined = model.mechanism, model.freedoms, model.connections
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    vectors = mechanism.vectors
    stiffness, damping, constant = joined.matrices(freedoms)
    constant = constant + freedoms.keep(_weight(scene, rotors))
    own_stiffness, own_damping = elastic_matrices(rotors, freedoms)
    stiffness, damping = stiffness + own_stiffness, damping + own_damping
    for _, drive, row in drive_springs(scene, kinematics, rotors, freedoms):
        stiffness += (drive.stiffness or 0.0) * np.outer(row, row)
        damping += drive.damping * np.outer(row, row)
    mass = freedoms.motion.T @ np.ascontiguousarray(times_mass(rotors, freedoms.motion.T).T)
    gradient = np.concatenate([np.empty((0, column_count(rotors))), *(each.gradient for each in elements)])
    scale, direction = _scales(scene, rotors, freedoms), freedoms.keep(gradient)
    turn = freedoms.keep(_turns(mechanism))
    packed = Elements.packed(elements, laws, len(scene.references))
    along = direction[packed.first[: len(scene.meshes)]]
    held = np.diag(stiffness) + model.flanks.mean_stiffness @ along**2
    held += packed.stiffness @ direction**2
    arrays = SystemArrays(
        mass=np.ascontiguousarray(mass),
        damping=damping,
        stiffness=stiffness,
        direction=direction,
        turn=turn,
        sparse=NO_ENTRIES,
        constant=constant,
        inertial=freedoms.keep(-times_mass(rotors, vectors)),
        total_inertia=np.ascontiguousarray(times_mass(rotors, vectors) @ vectors.T),
        drive=lay_out_drives(mechanism, freedoms, joined, gradient),
        scale=scale,
        rate_scale=scale * _reach(np.diag(mass), held),
        elements=packed,
        reference=lay_out_reference(mechanism, freedoms),
        load=lay_out_loads(mechanism, freedoms),
    )
    return by_address(arrays.with_matrices())


def _weight(scene: Scene, rotors: Bodies) -> FloatArray:
    """Return the force of gravity per freedom of all rotors, (N,) in N.

    It acts at the centers of mass: elastic coordinates share no momentum with the rigid motion, so gravity
    does no work on them. Shafts sag by what their bearings do to them.
    """
    acceleration = np.zeros(column_count(rotors))
    for axis, value in enumerate(scene.gravity):
        acceleration[axis : 6 * len(rotors) : 6] = value
    return np.asarray(times_mass(rotors, acceleration[None])[0])


def _turns(mechanism: Mechanism) -> FloatArray:
    """Return the derivatives of each position, (m + f, N): the driver's rotation against its carrier's.

    Frames and cages turn with the kinematic motion alone, angles of loads with their shafts.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    further = phases(mechanism)
    turn = np.zeros((len(scene.meshes) + len(further), column_count(rotors)))
    for row, phase in enumerate(further, start=len(scene.meshes)):
        if phase.shaft is not None:
            turn[row] += turn_row(rotors, phase.shaft, phase.position) / (2.0 * math.pi)
    for row, mesh in enumerate(scene.meshes):
        driver, _, carrier = mesh_shafts(scene, row)
        gear = scene.gear(mesh.driver)
        rate = kinematics.mesh_sense[row] * gear.teeth / (2.0 * math.pi)
        turn[row] += rate * turn_row(rotors, driver, gear.position)
        if carrier is not None:
            turn[row, 6 * carrier + ROTATION] -= rate
    return turn


def _reach(mass: FloatArray, held: FloatArray) -> FloatArray:
    """Return how long an error of each rate moves the freedom on, (n,) s: 1/natural circular frequency.

    What nothing holds, a rotor that torques alone turn, takes that of the slowest freedom that is held.
    """
    bound = held > 0.0
    own = np.sqrt(mass / np.where(bound, held, 1.0))
    return np.where(bound, own, np.max(own[bound], initial=1.0 / LEAST_RATE))


def _scales(scene: Scene, rotors: Bodies, freedoms: Freedoms) -> FloatArray:
    """Meters per unit of each freedom, (n,): for rotations the largest base or pin radius on the shaft.

    For an amplitude of a housing what it moves a seat by, at least a tenth of what any of them does: modes
    that hardly move a seat do not matter to the shafts.
    """
    largest = tilt_lever(scene)
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
    elastic = [
        np.where(rotor.elastic.twists, own[ROTATION], 1.0)
        for rotor, own in zip(rotors, scale, strict=True)
        if rotor.elastic is not None
    ]
    per_strain = np.array([1.0, 1.0, 1.0, largest, largest])[:, None]
    moved = [np.max(np.abs(housing.shape) * per_strain, axis=(0, 1)) for housing in rotors.housings]
    seats = [np.maximum(own, LEAST_SEAT * np.max(own)) for own in moved]
    return np.ascontiguousarray(np.concatenate([scale.ravel(), *elastic, *seats])[freedoms.column])


@dataclass(frozen=True)
class System:
    """An assembled scene."""

    scene: Scene
    arrays: SystemArrays
    """For the compiled loops."""
    freedoms: Freedoms
    kinematics: Kinematics
    lines: tuple[LineOfAction, ...]
    """One per mesh."""
    flanks: Flanks
    """Force laws as resolved: nominal forces, damping, tables."""
    elements: tuple[Element, ...]
    """The driving flanks of all meshes, then everything else."""
    rotors: Bodies
    """A rotor per shaft."""
    supports: Supports
    """Bushings, then planet bearings."""
    seats: Seats
    """The bearings that are more than three springs to rigid ground or pin."""
    bearings: tuple[BearingElement, ...]
    """Where the last elements act, those of bearings that are not linear."""
    housed: tuple[BearingElement, ...]
    """Where those before them act: linear bearings in housings that move."""
    couplings: CouplingRows
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    """`bearing_stiffness`, `bearing_damping`: Force on the ground, or on the pin, at each support per freedom
    and its rate; where bearings may exert moments, these too. Shape (b, 3 or 6, n) each.
    """
    bearing_map: BearingForce
    """The whole force there."""
    sampling: Sampling
    """How the run is sampled."""
    ledger: EffectLedger
    corrected: Corrections
    """Base radii of gears as given and as used, m, that were corrected to the base pitch of their train."""
    phases: TrainPhases
    """Positions of the meshes before anything turned."""

    @property
    def corrections(self) -> Json:
        """Say what of the scene was corrected; nothing where nothing was."""
        radii = {name: {"given": stated, "used": used} for name, (stated, used) in self.corrected.items()}
        return {"base_radius_corrected": radii} if radii else {}

    @property
    def driving_rows(self) -> IntArray:
        """Rows of the transmission errors among the local coordinates, (m,): driving flanks come first."""
        return self.arrays.elements.first[: len(self.scene.meshes)]

    def resolved(self, scene: Scene) -> Scene:
        """Return `scene`, of which it is made, with output rate and highest frequency spelled out."""
        outputs = replace(scene.outputs, sample_rate=self.sampling.rate)
        elastic = [rotor.elastic.highest for rotor in self.rotors if rotor.elastic is not None]
        highest = elastic[0] if elastic else scene.highest_frequency
        return replace(scene, outputs=outputs, highest_frequency=highest)

    def bearing_force(self, local: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return the force (N) on the ground or the pin at each support in its own frame, (b, 3, T).

        With seats or bearings that hold tilt (b, 6, T): force and moment (N m), the one about the axis 0.
        `local` (R, T) in N are the forces of the elements, `q` and `v` (T, n) the state.
        """
        return self.bearing_map.of(local, q, v).reshape(*self.bearing_stiffness.shape[:2], q.shape[0])


def assemble(scene: Scene) -> System:
    """Assemble `scene`; where it cannot have the laws of bearings, by their tangents at the load.

    That is where no effect may add them, and where a housing without mass carries one: no equation of motion
    says where its seats are between the bodies. Raises `InputError`: parts do not fit each other, or a free
    direction has no inertia.
    """
    massless, resting = under_laws(scene), scene
    if massless:
        off = {effect.name: "off" for effect in EFFECTS if not LAWS.isdisjoint(effect.adds)}
        resting = replace(scene, housings=resting_housings(scene), effects={**scene.effects, **off})
    model = decide_model(resting, EFFECTS)
    system = _assemble(model)
    if not system.bearings or BEARING_LAWS in model.mechanism.additions.possible:
        return system
    mesh_force = system.flanks.nominal_force @ system.arrays.direction[system.driving_rows]
    bearings = [(system.supports.name[at.support], at) for at in system.bearings]
    supports = {part.name: part for rotor in system.rotors for part in rotor.supports}
    tangents = linear_scene(system.scene, system.arrays, bearings, supports, -mesh_force)
    tangents = replace(tangents, housings=scene.housings, effects=scene.effects)
    linear = _assemble(decide_model(tangents, EFFECTS))
    ledger = system.ledger.with_entries_of(linear.ledger, HOUSING_AMPLITUDES)
    if massless:
        reason = f'the housing "{massless[0].name}" has no mass: bearings have their tangents at the load'
        ledger = ledger.without(LAWS, reason, scene.effects)
    return replace(linear, ledger=ledger, corrected=system.corrected)


def _assemble(model: Model) -> System:
    """Lay out a model; bearings that hold tilt also exert moments."""
    elements, laws = force_elements(model)
    arrays = _system_arrays(model, elements, laws)
    mechanism, freedoms, joined = model.mechanism, model.freedoms, model.connections
    housed = housed_bearings(mechanism.scene, mechanism.rotors)
    tilted = bool(joined.seats.name) or any(at.tilts for at in mechanism.bearings)
    stiffness, damping = joined.on_ground(freedoms, tilted)
    return System(
        scene=mechanism.scene,
        arrays=arrays,
        freedoms=freedoms,
        kinematics=mechanism.kinematics,
        lines=mechanism.lines,
        flanks=model.flanks,
        elements=elements,
        rotors=mechanism.rotors,
        supports=joined.supports,
        seats=joined.seats,
        bearings=mechanism.bearings,
        housed=housed,
        couplings=joined.couplings,
        bearing_stiffness=stiffness,
        bearing_damping=damping,
        bearing_map=_bearing_force_map(
            stiffness, damping, joined, (*housed, *mechanism.bearings), arrays.elements
        ),
        sampling=choose_sampling(mechanism.scene, mechanism.kinematics, _top_mode(model, arrays)),
        ledger=model.ledger,
        corrected=mechanism.corrected,
        phases=mechanism.phases,
    )


def _top_mode(model: Model, arrays: SystemArrays) -> float:
    """Return the highest mode that the meshes excite, as far as shafts are resolved, Hz; 0: none."""
    elements, meshes = arrays.elements, len(model.mechanism.scene.meshes)
    rows = arrays.direction[elements.first[:meshes]]
    other = arrays.direction.T @ (elements.stiffness[:, None] * arrays.direction)
    elastic = [rotor.elastic.highest for rotor in model.mechanism.rotors if rotor.elastic is not None]
    highest, mesh_stiffness = max(elastic, default=np.inf), model.flanks.mean_stiffness
    per_meter = 1.0 / arrays.scale
    rows = rows * per_meter  # springs in place of the meshes
    springs = rows.T @ (mesh_stiffness[:, None] * rows)
    mass, rest = (per_meter[:, None] * a * per_meter for a in (arrays.mass, arrays.stiffness + other))
    square, shape = eigh(springs + rest, mass)
    strain = mesh_stiffness @ (rows @ shape) ** 2
    excited = strain >= MESH_SHARE * np.maximum(square, 0.0)
    frequency = np.sqrt(np.maximum(square, 0.0)) / (2.0 * math.pi)
    return float(np.max(frequency[excited & (frequency <= highest)], initial=0.0))
