"""All force elements of a model: flanks, loads, rotating frames, couplings, bearings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.frame_couplings import frame_coupling_elements
from dynamics.assembly.housed_bearings import housed_bearing_elements, housed_bearings
from dynamics.assembly.load_elements import force_course_elements, unbalance_elements
from dynamics.assembly.model import Model
from dynamics.assembly.phases import repeating_phases
from dynamics.effects.force_terms import (
    CENTER_DISTANCE,
    MISALIGNMENT,
    SLIDING,
    FlankInSpace,
    FlankTerms,
    FrameTerm,
    frame_laws,
    frame_lever,
)
from dynamics.errors import InputError
from dynamics.forces.elements import ElementLaws
from dynamics.forces.rotating_frame import RotatingFrameLaws
from dynamics.kernels.law import Law
from dynamics.loads.speed_torque import SpeedTorqueLaws, pack_speed_torques
from dynamics.mechanism.bearing_elements import bearing_elements, tilt_lever
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, turn_row
from dynamics.mechanism.flank_gradients import approach, middle_from_driver
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.freedoms import ROTATION, Freedoms
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.line_of_action import LineOfAction, line_of_action
from dynamics.mechanism.mechanism import Mechanism
from dynamics.meshes.grid_tables import pack_grids
from dynamics.meshes.spatial_flank import SpatialFlankLaws
from dynamics.scene.scene import Scene
from dynamics.types import BoolArray, FloatArray, IntArray

# The flank elements of meshes to whose forces effects contribute.


@dataclass(frozen=True)
class SpatialFlank:
    """One flank with what effects add, laid out: its rows after that of the deflection, and how it uses them.

    Attributes
    ----------
    entry : int
        Its index among all flanks.
    terms : FlankTerms
    fixed : (float, float)
        Misalignment and center-distance change of the mesh, m, as the flank sees them.
    mid_face, radius : float
        As in `SpatialFlankLaws`, m.
    row : (3,) int array
        First row of each kind; -1: none.
    gradient : (p, N) array
    offset : (p,) array
    slides : (p,) bool array
    """

    entry: int
    terms: FlankTerms
    fixed: tuple[float, float]
    mid_face: float
    radius: float
    row: IntArray
    gradient: FloatArray
    offset: FloatArray
    slides: BoolArray


def _spatial_elements(model: Model, plain: Sequence[Element]) -> tuple[tuple[Element, ...], SpatialFlankLaws]:
    """Return the elements `plain` with those of such meshes replaced, each at its index, and their laws.

    Flanks slide along the kinematic motion but keep their deflection.
    """
    vectors = model.mechanism.vectors
    elements: list[Element] = []
    flanks: list[SpatialFlank] = []
    for entry, element in enumerate(plain):
        flank = FlankInSpace(model.mechanism, element.mesh, coast=entry >= len(model.mechanism.lines))
        in_plane = FlankTerms(model.flanks.tables[entry])
        terms = in_plane
        for effect in model.ledger.on_mesh(model.mechanism.scene.meshes[element.mesh].name):
            terms = effect.contribute(terms, flank)
        if terms is in_plane:
            elements.append(element)
            continue
        laid_out = _lay_out(entry, element, flank, terms)
        drift = np.where(laid_out.slides[:, None], laid_out.gradient @ vectors.T, 0.0)
        law, rows = Law.SPATIAL_FLANK, (laid_out.gradient, laid_out.offset)
        elements.append(Element(law, len(flanks), element.mesh, *rows, drift))
        flanks.append(laid_out)
    return tuple(elements), _pack(model, flanks)


def _lay_out(entry: int, element: Element, flank: FlankInSpace, terms: FlankTerms) -> SpatialFlank:
    """Lay out the rows of a flank after that of its deflection, which `element` has in the plane."""
    scene = flank.mechanism.scene
    mesh = scene.meshes[flank.index]
    fixed = (-mesh.misalignment if flank.coast else mesh.misalignment, mesh.center_distance_change)
    at = {MISALIGNMENT: fixed[0], CENTER_DISTANCE: fixed[1], SLIDING: 0.0}
    gradient, offset, slides, first = [element.gradient], [float(element.offset[0])], [False], []
    for kind, rows in enumerate(terms.rows):
        first.append(-1 if rows is None else len(offset))
        if rows is not None:
            gradient.append(rows)
            offset += [at[kind]] * len(rows)
            slides += [kind == SLIDING] * len(rows)
    return SpatialFlank(
        entry,
        terms,
        fixed,
        middle_from_driver(scene, flank.index, flank.line, flank.sense),
        scene.gear(mesh.driver).base_radius,
        np.array(first),
        np.concatenate(gradient),
        np.array(offset),
        np.array(slides),
    )


def _pack(model: Model, flanks: Sequence[SpatialFlank]) -> SpatialFlankLaws:
    """Lay out the laws."""
    law = model.flanks.law
    return SpatialFlankLaws(
        pack_grids([flank.terms.table for flank in flanks]),
        np.array([law.damping[flank.entry] for flank in flanks], dtype=float),
        np.array([law.reach[flank.entry] for flank in flanks], dtype=float),
        np.array([flank.row for flank in flanks], dtype=np.int64).reshape(-1, 3),
        np.array([flank.fixed for flank in flanks], dtype=float).reshape(-1, 2),
        np.array([flank.terms.follows for flank in flanks], dtype=np.int64).reshape(-1, 2),
        np.array([flank.terms.per_face for flank in flanks], dtype=float),
        np.array([flank.mid_face for flank in flanks], dtype=float),
        np.array([flank.terms.friction for flank in flanks], dtype=float),
        np.array([flank.radius for flank in flanks], dtype=float),
        np.zeros(len(flanks), dtype=np.bool_),
    )


# Rotating-frame elements: what effects add to rotors because these, or their frames, rotate.


def _rotating_frame_elements(model: Model) -> tuple[tuple[Element, ...], RotatingFrameLaws]:
    """Return the elements of all rotors on which such effects are on, and their laws.

    A radius makes lengths of angles. Where nothing moves there is no element.
    """
    mechanism, freedoms = model.mechanism, model.freedoms
    lever, free, vectors = frame_lever(mechanism.scene), mechanism.freely_turned, mechanism.vectors
    terms: list[tuple[int, FrameTerm]] = []
    for index, rotor in enumerate(mechanism.rotors):
        own = [
            term
            for effect in model.ledger.on_rotor(rotor.shaft.name)
            for term in effect.frame_terms(mechanism, model.connections, index)
        ]
        moving = [term for term in own if np.any(freedoms.keep(term.rows))]
        terms += [(index, term) for term in _merged(moving, freedoms)]
    elements = tuple(
        _element(mechanism, vectors, entry, index, term.rows, lever if free[index] else 0.0)
        for entry, (index, term) in enumerate(terms)
    )
    return elements, frame_laws([term for _, term in terms], lever, [bool(free[index]) for index, _ in terms])


def _merged(terms: Sequence[FrameTerm], freedoms: Freedoms) -> list[FrameTerm]:
    """Return the terms of a rotor with those that move alike made one: each costs two unknowns a stage."""
    merged: list[FrameTerm] = []
    for term in terms:
        for entry, other in enumerate(merged):
            if np.array_equal(freedoms.keep(term.rows), freedoms.keep(other.rows)):
                merged[entry] = other.plus(term)
                break
        else:
            merged.append(term)
    return merged


def _element(
    mechanism: Mechanism, vectors: FloatArray, entry: int, index: int, across: FloatArray, lever: float
) -> Element:
    """Return an element with its rows `across` (2, N), and with a `lever` a row of the shaft's rotation.

    `vectors` (k, N) are the laws' kinematic vectors.
    """
    ratio, frame = mechanism.kinematics.float_ratio, mechanism.rotors[index].frame
    rows, drift = across, across @ vectors.T
    if lever > 0.0:
        spin = np.zeros((1, across.shape[1]))
        spin[0, 6 * index + ROTATION] = lever
        rows, drift = np.concatenate([rows, spin]), np.concatenate([drift, np.zeros((1, drift.shape[1]))])
    turns = np.zeros(ratio.shape[1]) if frame is None else ratio[frame]
    speed = np.array([ratio[index], turns])
    return Element(Law.ROTATING_FRAME, entry, -1, rows, np.zeros(len(rows)), drift, speed=speed)


# The force elements of the flanks: driving flanks of all meshes, coast flanks where backlash is on.


def _flank_elements(
    scene: Scene,
    rotors: Bodies,
    senses: Sequence[int],
    lines: Sequence[LineOfAction],
    flanks: Flanks,
) -> tuple[Element, ...]:
    """Return one element per entry of ``flanks.law``, in its order.

    A driving flank's coordinate is the transmission error. A coast flank pushes along the line of action of
    the opposite sense, and its coordinate is the approach along that less the backlash: a smaller center
    distance closes both.
    """
    driving = [
        Element(Law.FLANK, index, index, approach(scene, rotors, index, line)[None, :], np.zeros(1))
        for index, line in enumerate(lines)
    ]
    coasting = []
    for entry, index in enumerate(flanks.coast, start=len(lines)):
        line, back = line_of_action(scene, index, -senses[index]), scene.meshes[index].coast
        gap = back.backlash if back is not None else 0.0
        gradient = approach(scene, rotors, index, line)[None, :]
        coasting.append(Element(Law.FLANK, entry, index, gradient, np.array([-gap])))
    return (*driving, *coasting)


# The force elements of torques that depend on speed.


def _speed_elements(
    scene: Scene, rotors: Bodies, kinematics: Kinematics
) -> tuple[tuple[Element, ...], SpeedTorqueLaws]:
    """Return one element per speed torque, and their laws.

    Its coordinate is the rotation in the shaft's sense times a radius, and its rate in the kinematic motion
    is the shaft's speed times that radius.
    """
    radius = max((gear.base_radius for gear in scene.gears), default=1.0)
    elements = []
    for entry, part in enumerate(scene.speed_torques):
        shaft = scene.shaft_index(part.shaft)
        sense = kinematics.sense[shaft]
        if sense == 0:
            field = f"speed_torques[{entry}].shaft"
            raise InputError(field, part.shaft, "a shaft that turns", "A held shaft needs no load.")
        gradient = np.zeros((1, column_count(rotors)))
        gradient[0] += sense * radius * turn_row(rotors, shaft, part.position)
        drift = sense * radius * kinematics.float_ratio[shaft][None, :]
        elements.append(Element(Law.SPEED_TORQUE, entry, -1, gradient, np.zeros(1), drift))
    return tuple(elements), pack_speed_torques(scene.speed_torques, radius)


def force_elements(model: Model) -> tuple[tuple[Element, ...], ElementLaws]:
    """Return the driving flanks of all meshes, everything else, bearings last, and their laws."""
    mechanism, flanks = model.mechanism, model.flanks
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    plain = _flank_elements(scene, rotors, kinematics.mesh_sense, mechanism.lines, flanks)
    in_space, spatial = _spatial_elements(model, plain)
    by_speed, speed = _speed_elements(scene, rotors, kinematics)
    in_frames, rotating_frame = _rotating_frame_elements(model)
    phase = len(scene.meshes) + len(repeating_phases(scene, kinematics))
    passing = [part.name for part in scene.rolling_bearings if part.name in mechanism.passing]
    on_bearings, bearing_laws = bearing_elements(
        scene.laws_with(mechanism.passing),
        rotors,
        mechanism.bearings,
        mechanism.bearing_duty,
        {name: phase + index for index, name in enumerate(passing)},
    )
    across, frame = frame_coupling_elements(scene, rotors, tilt_lever(scene))
    applied, course = force_course_elements(mechanism)
    eccentric, unbalance = unbalance_elements(mechanism)
    housed, linear_bearing = housed_bearing_elements(mechanism, housed_bearings(mechanism))
    laws = ElementLaws(
        flank=flanks.law,
        speed_torque=speed,
        spatial_flank=spatial,
        rotating_frame=rotating_frame,
        frame_coupling=frame,
        applied_force=course,
        unbalance=unbalance,
        linear_bearing=linear_bearing,
        **bearing_laws,
    )
    others = (*by_speed, *applied, *eccentric, *in_frames, *across, *housed)
    return (*in_space, *others, *on_bearings), laws
