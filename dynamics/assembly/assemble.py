"""Assembly of a scene into a system: effects decided, bearings linear where they must be, arrays laid out.

A system is what integrators and linear theory solve: arrays for compiled loops with the names of their axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.bearing_force import BearingForce, bearing_force_map
from dynamics.assembly.bearing_rest import linear_scene
from dynamics.assembly.force_elements import force_elements
from dynamics.assembly.model import Model, decide_model
from dynamics.assembly.system_arrays import system_arrays
from dynamics.effects import EFFECTS, EffectLedger
from dynamics.forces.elements import Element
from dynamics.mechanism.additions import BEARING_LAWS, ELEMENT_PASSING, HOUSING_AMPLITUDES
from dynamics.mechanism.base_pitches import Corrections
from dynamics.mechanism.bearing_elements import BearingElement
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.connections import Seats
from dynamics.mechanism.coupling_rows import CouplingRows
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.housed_bearings import housed_bearings
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.mechanism.resting_housings import resting_housings, under_laws
from dynamics.mechanism.sampling import Sampling, choose_sampling
from dynamics.mechanism.supports import Supports
from dynamics.mechanism.train_phases import TrainPhases
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray, Json
from host import require
from host.optional_modules import linalg

MESH_SHARE = 0.01
"""Least share of a mode's strain energy in the meshes with which they excite it."""
_BEARING_ADDITIONS = frozenset((BEARING_LAWS, ELEMENT_PASSING))
"""Additions of effects that stand on the nonlinear laws of bearings."""


@dataclass(frozen=True)
class System:
    """An assembled scene."""

    scene: Scene
    arrays: SystemArrays
    """Arrays for the compiled loops."""
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
    """Points of action of the last elements, which are the bearings that are not linear."""
    housed: tuple[BearingElement, ...]
    """Points of action of the elements before these: linear bearings in housings that move."""
    couplings: CouplingRows
    bearing_stiffness: FloatArray
    bearing_damping: FloatArray
    """`bearing_stiffness`, `bearing_damping`: Force on the ground, or on the pin, at each support per freedom
    and per its rate; with moments where bearings may exert them. Shape (b, 3 or 6, n) each.
    """
    bearing_map: BearingForce
    """The whole force at the supports."""
    sampling: Sampling
    """Sample rate of the run and steps of its samples."""
    ledger: EffectLedger
    corrected: Corrections
    """Base radii of gears as given and as used, m, that were corrected to the base pitch of their train."""
    phases: TrainPhases
    """Positions of the meshes before anything turned."""

    @property
    def corrections(self) -> Json:
        """The base radii that were corrected, as given and as used; empty: none."""
        radii = {
            name: {"given": specified, "used": used} for name, (specified, used) in self.corrected.items()
        }
        return {"base_radius_corrected": radii} if radii else {}

    @property
    def driving_rows(self) -> IntArray:
        """Rows of the transmission errors among the local coordinates, (m,): driving flanks come first."""
        return self.arrays.elements.first[: len(self.scene.meshes)]

    def resolved(self, scene: Scene) -> Scene:
        """Return `scene`, from which the system is made, with its output rate and highest frequency."""
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
    """Return the system of `scene`.

    Bearings have their nonlinear laws, or the tangents of these at the load. They have tangents where no
    effect may add the laws, and where a housing without mass carries a bearing: no equation of motion says
    where its seats are between the bodies.

    Raises `InputError`: parts do not fit each other, or a free direction has no inertia.
    """
    require("analysis")
    massless, resting = under_laws(scene), scene
    if massless:
        # the tangents are found with such housings at rest
        off = {effect.name: "off" for effect in EFFECTS if not _BEARING_ADDITIONS.isdisjoint(effect.adds)}
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
        ledger = ledger.without(_BEARING_ADDITIONS, reason, scene.effects)
    return replace(linear, ledger=ledger, corrected=system.corrected)


def _assemble(model: Model) -> System:
    """Return the system of a model. Bearings that hold tilt also exert moments."""
    elements, laws = force_elements(model)
    arrays = system_arrays(model, elements, laws)
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
        bearing_map=bearing_force_map(
            stiffness, damping, joined, (*housed, *mechanism.bearings), arrays.elements
        ),
        sampling=choose_sampling(mechanism.scene, mechanism.kinematics, _highest_excited_mode(model, arrays)),
        ledger=model.ledger,
        corrected=mechanism.corrected,
        phases=mechanism.phases,
    )


def _highest_excited_mode(model: Model, arrays: SystemArrays) -> float:
    """Return the frequency of the highest mode that the meshes excite, Hz; 0: none.

    Modes beyond the frequency to which shafts are resolved do not count.
    """
    elements, meshes = arrays.elements, len(model.mechanism.scene.meshes)
    per_meter = 1.0 / arrays.scale
    bearings = arrays.direction.T @ (elements.stiffness[:, None] * arrays.direction)
    supports = per_meter[:, None] * (arrays.stiffness + bearings) * per_meter
    # springs take the place of the meshes
    mesh_rows = arrays.direction[elements.first[:meshes]] * per_meter
    mesh_stiffness = model.flanks.mean_stiffness
    springs = mesh_rows.T @ (mesh_stiffness[:, None] * mesh_rows)
    square, shape = linalg.eigh(springs + supports, per_meter[:, None] * arrays.mass * per_meter)
    strain = mesh_stiffness @ (mesh_rows @ shape) ** 2
    elastic = [rotor.elastic.highest for rotor in model.mechanism.rotors if rotor.elastic is not None]
    highest = max(elastic, default=np.inf)
    excited = strain >= MESH_SHARE * np.maximum(square, 0.0)
    frequency = np.sqrt(np.maximum(square, 0.0)) / (2.0 * math.pi)
    return float(np.max(frequency[excited & (frequency <= highest)], initial=0.0))
