"""From a scene to arrays: the main flow of this room."""

from __future__ import annotations

from dataclasses import dataclass, replace

from dynamics.system.arrays import SystemArrays
from dynamics.system.bearing_elements import BearingElement
from dynamics.system.bearing_rest import linear_scene
from dynamics.system.connections import forces_on_ground
from dynamics.system.coupling_rows import CouplingRows
from dynamics.system.effects.bearing_clearance import BearingClearance
from dynamics.system.effects.ledger import EffectLedger
from dynamics.system.elements import Element
from dynamics.system.flanks import Flanks
from dynamics.system.force_elements import force_elements
from dynamics.system.freedoms import Freedoms
from dynamics.system.kinematics import Kinematics
from dynamics.system.line_of_action import LineOfAction
from dynamics.system.mechanism import gather_mechanism
from dynamics.system.model import Model, decide_model
from dynamics.system.rotor import Rotor
from dynamics.system.scene import Scene
from dynamics.system.seats import Seats
from dynamics.system.supports import Supports
from dynamics.system.system_arrays import system_arrays
from dynamics.types import FloatArray, IntArray


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
        The bearings that are more than three springs to rigid ground or pin.
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
    return replace(_assemble(_with_linear_bearings(system)), ledger=system.ledger)


def _assemble(scene: Scene) -> System:
    """Assemble `scene` as it is."""
    model = decide_model(gather_mechanism(scene))
    elements, laws = force_elements(model)
    return _put_together(model, elements, system_arrays(model, elements, laws))


def _with_linear_bearings(system: System) -> Scene:
    """Return the scene with the tangents of its bearings where it rests under the load."""
    mesh_force = system.flanks.nominal_force @ system.arrays.direction[system.driving_rows]
    bearings = [(system.supports.name[at.support], at) for at in system.bearings]
    supports = {part.name: part for rotor in system.rotors for part in rotor.supports}
    return linear_scene(system.scene, system.arrays, bearings, supports, -mesh_force)


def _put_together(model: Model, elements: tuple[Element, ...], arrays: SystemArrays) -> System:
    """Gather all parts; bearings that hold tilt also exert moments."""
    mechanism, freedoms, joined = model.mechanism, model.freedoms, model.connections
    tilted = bool(joined.seats.name) or any(at.tilts for at in mechanism.bearings)
    stiffness, damping = forces_on_ground(joined, freedoms, tilted)
    return System(
        mechanism.scene,
        arrays,
        freedoms,
        mechanism.kinematics,
        mechanism.lines,
        model.flanks,
        elements,
        mechanism.rotors,
        joined.supports,
        joined.seats,
        mechanism.bearings,
        joined.couplings,
        stiffness,
        damping,
        model.ledger,
    )
