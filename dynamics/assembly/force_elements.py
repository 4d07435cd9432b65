"""All force elements of a model: flanks, loads, rotating frames, couplings, bearings."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from dynamics.assembly.model import Model
from dynamics.bearings.linear_bearing import LinearBearingLaws
from dynamics.effects.force_terms import (
    CENTER_DISTANCE,
    MISALIGNMENT,
    SLIDING,
    FlankInSpace,
    FlankTerms,
)
from dynamics.errors import InputError
from dynamics.forces.elements import Element
from dynamics.forces.frames import FrameCouplingLaws, FrameTerm, RotatingFrameLaws
from dynamics.forces.laws import LAW_BY_ARRAYS, ElementLaws, Law
from dynamics.kernels.by_address import by_address
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.load_course import BySpeed, Orders
from dynamics.loads.load_laws import ForceCourseLaws, SpeedTorqueLaws, UnbalanceLaws
from dynamics.mechanism.bearing_elements import (
    housed_bearing_elements,
    housed_bearings,
    supports_by_name,
    tilt_lever,
)
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, section_rows, turn_row
from dynamics.mechanism.connections import ACROSS, frame_couplings, full_matrix
from dynamics.mechanism.freedoms import ROTATION, Freedoms
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.line_of_action import approach, line_of_action, middle_from_driver
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.phases import LoadPhase, angle_phase, frame_phase, repeating_phases, unbalance_phase
from dynamics.mechanism.supports import seat_error, seat_motion
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.spatial_flank import SpatialFlankLaws
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

# The force elements of applied forces and of unbalances.


def _force_course_elements(model: Model) -> tuple[tuple[Element, ...], ForceCourseLaws]:
    """Return one element per applied force, and their laws.

    The rows are those of the force and moment as one generalized force per newton, the moment by a lever.
    """
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, known, vectors = tilt_lever(scene), repeating_phases(scene, kinematics), mechanism.vectors
    elements, size, carrying, read, turned, senses = [], [], [], [], [], []
    for entry, force in enumerate(scene.forces):
        frame = frame_phase(scene, kinematics, force)
        rows = _wrench_rows(scene, rotors, force, frame is not None)
        size.append(math.hypot(*force.force, *(moment / lever for moment in force.moment)) or 1.0)
        carrying.append(len(rows))
        rows = rows / size[-1]
        sense = 1
        if isinstance(force.course, BySpeed):
            shaft = scene.shaft_index(force.course.shaft)
            sense = _sense(kinematics, shaft, f"forces[{entry}].course.shaft", force.course.shaft)
            rows = np.concatenate([rows, lever * turn_row(rotors, shaft, 0.0)[None]])
        senses.append(sense)
        course = force.course
        angle = angle_phase(scene, kinematics, force, course) if isinstance(course, Orders) else None
        read.append(_index(scene, known, angle))
        turned.append(_index(scene, known, frame))
        elements.append(Element(Law.APPLIED_FORCE, entry, -1, rows, np.zeros(len(rows)), rows @ vectors.T))
    laws = ForceCourseLaws.packed(
        [force.course for force in scene.forces],
        size=np.array(size, dtype=float),
        lever=np.full(len(size), lever),
        sense=np.array(senses, dtype=float),
        rows=np.array(carrying, dtype=np.int64),
        phase=np.array(read, dtype=np.int64),
        frame=np.array(turned, dtype=np.int64),
        mean=np.array([_mean(scene, kinematics, force) for force in scene.forces]).reshape(-1, 2),
    )
    return tuple(elements), laws


def _unbalance_elements(model: Model) -> tuple[tuple[Element, ...], UnbalanceLaws]:
    """Return one element per unbalance, and their laws."""
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, known, vectors = tilt_lever(scene), repeating_phases(scene, kinematics), mechanism.vectors
    elements, read = [], []
    for entry, part in enumerate(scene.unbalances):
        shaft = scene.shaft_index(part.shaft)
        if rotors[shaft].frame is not None:
            bound = "a shaft described in the fixed frame"
            advice = "On a member of a planetary set use a force by speed that turns with it."
            raise InputError(f"unbalances[{entry}].shaft", part.shaft, bound, advice)
        moves = section_rows(rotors, shaft, rotors[shaft].shaft.origin[2] + part.position)
        rows = np.array([moves[0], moves[1], lever * moves[ROTATION]])
        elements.append(Element(Law.UNBALANCE, entry, -1, rows, np.zeros(3), rows @ vectors.T))
        read.append(_index(scene, known, unbalance_phase(scene, kinematics, part)))
    laws = UnbalanceLaws(
        np.array([part.amount for part in scene.unbalances], dtype=float),
        np.array([part.angle for part in scene.unbalances], dtype=float),
        np.full(len(read), lever),
        np.array(read, dtype=np.int64),
        np.array(scene.gravity[:2], dtype=float),
        np.zeros(1, dtype=np.bool_),
    )
    return tuple(elements), laws


def _wrench_rows(scene: Scene, rotors: Bodies, force: AppliedForce, turning: bool) -> FloatArray:
    """Return the generalized force of the whole, or where it turns of its part across and along, (p, N)."""
    index = scene.shaft_index(force.shaft)
    moves = section_rows(rotors, index, rotors[index].shaft.origin[2] + force.position)
    wrench = np.array([*force.force, *force.moment])
    if not turning:
        return np.asarray((wrench @ moves)[None])
    fx, fy, fz, mx, my, mz = wrench
    rows = [[fx, fy, 0.0, mx, my, 0.0], [-fy, fx, 0.0, -my, mx, 0.0]]
    if fz or mz:
        rows.append([0.0, 0.0, fz, 0.0, 0.0, mz])
    return np.asarray(np.array(rows) @ moves)


def _mean(scene: Scene, kinematics: Kinematics, force: AppliedForce) -> tuple[float, float]:
    """Return the means of s cos a and s sin a for a factor s by the angle and the frame's angle a.

    A first order of the very angle that the frame turns by stands still in part.
    """
    frame, course = frame_phase(scene, kinematics, force), force.course
    if frame is None or not isinstance(course, Orders):
        return 0.0, 0.0
    angle = angle_phase(scene, kinematics, force, course)
    along, across = 0.0, 0.0
    for order, amplitude, phase in zip(course.multiple, course.amplitude, course.phase, strict=True):
        for sense in (1, -1):
            if all(sense * order * a == b for a, b in zip(angle.rate, frame.rate, strict=True)):
                along += 0.5 * amplitude * math.cos(phase)
                across -= 0.5 * amplitude * sense * math.sin(phase)
    return along, across


def _sense(kinematics: Kinematics, shaft: int, field: str, name: str) -> int:
    sense = kinematics.sense[shaft]
    if sense == 0:
        raise InputError(field, name, "a shaft that turns", "Give a held shaft's force by time.")
    return sense


def _index(scene: Scene, known: tuple[LoadPhase, ...], phase: LoadPhase | None) -> int:
    """Return where a phase is among the positions; -1: there is none."""
    return -1 if phase is None else len(scene.meshes) + known.index(phase)


# The flank elements of meshes to whose forces effects contribute.


def _spatial_elements(model: Model) -> tuple[tuple[Element, ...], SpatialFlankLaws]:
    """Return the elements of all flanks, those of such meshes in space, and the laws of these.

    Flanks slide along the kinematic motion but keep their deflection.
    """
    mechanism, law, plain = model.mechanism, model.flanks.law, _flank_elements(model)
    elements: list[Element] = []
    grids: list[MeshTable] = []
    figures: dict[str, list[Any]] = {name: [] for name in SpatialFlankLaws._fields[1:]}
    for entry, element in enumerate(plain):
        flank = FlankInSpace(mechanism, element.mesh, coast=entry >= len(mechanism.lines))
        in_plane = FlankTerms(model.flanks.tables[entry])
        mesh, terms = mechanism.scene.meshes[element.mesh], in_plane
        for effect in model.ledger.on_mesh(mesh.name):
            terms = effect.contribute(terms, flank)
        if terms is in_plane:
            elements.append(element)
            continue
        fixed = (-mesh.misalignment if flank.coast else mesh.misalignment, mesh.center_distance_change)
        rows, first = _rows_in_space(element, terms, fixed, mechanism.vectors)
        elements.append(Element(Law.SPATIAL_FLANK, len(grids), element.mesh, *rows))
        grids.append(terms.table)
        own = {
            "damping": law.damping[entry],
            "reach": law.reach[entry],
            "row": first,
            "fixed": fixed,
            "follows": terms.follows,
            "per_face": terms.per_face,
            "mid_face": middle_from_driver(mechanism.scene, flank.index, flank.line, flank.sense),
            "friction": terms.friction,
            "radius": mechanism.scene.gear(mesh.driver).base_radius,
            "running": False,
        }
        for name, value in own.items():
            figures[name].append(value)
    return tuple(elements), SpatialFlankLaws.packed(grids, figures)


def _rows_in_space(
    element: Element, terms: FlankTerms, fixed: tuple[float, float], vectors: FloatArray
) -> tuple[tuple[FloatArray, FloatArray, FloatArray], list[int]]:
    """Return gradient, offset and drift of a flank's rows, and the first row of each kind, -1: none.

    The first row is that of the deflection, which `element` has in the plane; `fixed` are misalignment and
    center-distance change of the mesh, m, as the flank sees them.
    """
    at = {MISALIGNMENT: fixed[0], CENTER_DISTANCE: fixed[1], SLIDING: 0.0}
    gradient, offset, slides, first = [element.gradient], [float(element.offset[0])], [False], []
    for kind, rows in enumerate(terms.rows):
        first.append(-1 if rows is None else len(offset))
        if rows is not None:
            gradient.append(rows)
            offset += [at[kind]] * len(rows)
            slides += [kind == SLIDING] * len(rows)
    whole = np.concatenate(gradient)
    drift = np.where(np.array(slides)[:, None], whole @ vectors.T, 0.0)
    return (whole, np.array(offset), drift), first


# Rotating-frame elements: what effects add to rotors because these, or their frames, rotate.


def _rotating_frame_elements(model: Model) -> tuple[tuple[Element, ...], RotatingFrameLaws]:
    """Return the elements of all rotors on which such effects are on, and their laws.

    A radius makes lengths of angles. Where nothing moves there is no element.
    """
    mechanism, freedoms = model.mechanism, model.freedoms
    lever, free, vectors = tilt_lever(mechanism.scene), mechanism.freely_turned, mechanism.vectors
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
    spinning = [bool(free[index]) for index, _ in terms]
    return elements, RotatingFrameLaws.packed([term for _, term in terms], lever, spinning)


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


# Couplings between shafts described in different frames.


def _frame_coupling_elements(model: Model) -> tuple[tuple[Element, ...], FrameCouplingLaws]:
    """Return the elements of all couplings across frames, and their laws; a lever makes lengths of tilts.

    Each reads a phase of its own behind those of the meshes: how far its second frame has turned against its
    first.
    """
    scene, rotors = model.mechanism.scene, model.mechanism.rotors
    parts, lever = frame_couplings(scene), tilt_lever(scene)
    elements = []
    size = np.array([1.0, 1.0, lever, lever])
    laws = [np.zeros((len(parts), 4, 4)) for _ in range(2)]
    for entry, part in enumerate(parts):
        coupling, n = scene.couplings[part.coupling], part.directions
        for law, matrix in zip(laws, (coupling.stiffness, coupling.damping), strict=True):
            law[entry] = full_matrix(matrix, 0.0)[np.ix_(ACROSS, ACROSS)] / np.outer(size, size)
        ends = (section_rows(rotors, rotor, part.height) for rotor in (part.first, part.second))
        gradient = np.concatenate([(moves[list(ACROSS)] * size[:, None])[:n] for moves in ends])
        typical = np.tile(np.diag(laws[0][entry])[:n], 2)
        phase = len(scene.meshes) + entry
        offset = np.zeros(2 * n)
        elements.append(Element(Law.FRAME_COUPLING, entry, phase, gradient, offset, stiffness=typical))
    directions = np.array([part.directions for part in parts], dtype=np.int64)
    return tuple(elements), FrameCouplingLaws(directions, *laws)


# The force elements of the flanks: driving flanks of all meshes, coast flanks where backlash is on.


def _flank_elements(model: Model) -> tuple[Element, ...]:
    """Return one element per entry of ``flanks.law``, in its order.

    A driving flank's coordinate is the transmission error. A coast flank pushes along the line of action of
    the opposite sense, and its coordinate is the approach along that less the backlash: a smaller center
    distance closes both.
    """
    mechanism = model.mechanism
    scene, rotors, lines = mechanism.scene, mechanism.rotors, mechanism.lines
    driving = [
        Element(Law.FLANK, index, index, approach(scene, rotors, index, line)[None, :], np.zeros(1))
        for index, line in enumerate(lines)
    ]
    coasting = []
    for entry, index in enumerate(model.flanks.coast, start=len(lines)):
        line = line_of_action(scene, index, -mechanism.kinematics.mesh_sense[index])
        back = scene.meshes[index].coast
        gap = back.backlash if back is not None else 0.0
        gradient = approach(scene, rotors, index, line)[None, :]
        coasting.append(Element(Law.FLANK, entry, index, gradient, np.array([-gap])))
    return (*driving, *coasting)


# The force elements of torques that depend on speed.


def _speed_elements(model: Model) -> tuple[tuple[Element, ...], SpeedTorqueLaws]:
    """Return one element per speed torque, and their laws.

    Its coordinate is the rotation in the shaft's sense times a radius, and its rate in the kinematic motion
    is the shaft's speed times that radius.
    """
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    radius = tilt_lever(scene)
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
    return tuple(elements), SpeedTorqueLaws.packed(scene.speed_torques, radius)


# The force elements of bearings that are not linear, and of linear ones in housings that move.


def _bearing_elements(model: Model) -> tuple[tuple[Element, ...], dict[str, Any]]:
    """Return the elements of all laws of bearings, and their laws by the fields of `ElementLaws`.

    Cages of rows whose elements pass read the last of the positions.
    """
    mechanism, scene = model.mechanism, model.mechanism.scene
    cages = len(scene.meshes) + len(repeating_phases(scene, mechanism.kinematics))
    passing = [part.name for part in scene.rolling_bearings if part.name in mechanism.passing]
    phases = {name: cages + index for index, name in enumerate(passing)}
    supports, elements = supports_by_name(mechanism.rotors), []
    entries: dict[Any, list[Any]] = {arrays: [] for arrays in LAW_BY_ARRAYS}
    for part, at in zip(scene.laws_with(mechanism.passing), mechanism.bearings, strict=True):
        rotor, support = supports[at.name]
        gradient = at.way @ seat_motion(mechanism.rotors, rotor, support)
        offset = -at.way @ seat_error(mechanism.rotors, rotor, support)
        law, own, phase = LAW_BY_ARRAYS[part.arrays], entries[part.arrays], phases.get(at.name, -1)
        elements.append(Element(law, len(own), phase, gradient, offset, stiffness=at.typical))
        own.append(part.laid_out(mechanism.bearing_duty[at.name]))
    packed = {
        law.name.lower(): arrays.packed(own) if (own := entries[arrays]) else _none_of(arrays)
        for arrays, law in LAW_BY_ARRAYS.items()
    }
    return tuple(elements), packed


@cache
def _none_of(arrays: Any) -> Any:
    """Return the arrays of a law that no bearing has."""
    return by_address(arrays.packed([]))


def _housed_elements(model: Model) -> tuple[tuple[Element, ...], LinearBearingLaws]:
    rotors = model.mechanism.rotors
    return housed_bearing_elements(rotors, housed_bearings(model.mechanism.scene, rotors))


BY_LAW: tuple[tuple[Law, Callable[[Model], tuple[tuple[Element, ...], Any]]], ...] = (
    (Law.SPATIAL_FLANK, _spatial_elements),
    (Law.SPEED_TORQUE, _speed_elements),
    (Law.APPLIED_FORCE, _force_course_elements),
    (Law.UNBALANCE, _unbalance_elements),
    (Law.ROTATING_FRAME, _rotating_frame_elements),
    (Law.FRAME_COUPLING, _frame_coupling_elements),
    (Law.LINEAR_BEARING, _housed_elements),
)
"""What lays out the elements of a law and their arrays, in the order of the elements."""


def force_elements(model: Model) -> tuple[tuple[Element, ...], ElementLaws]:
    """Return the driving flanks of all meshes, everything else, bearings last, and their laws."""
    laws: dict[str, Any] = {"flank": model.flanks.law}
    elements: list[Element] = []
    for law, lay_out in BY_LAW:
        own, laws[law.name.lower()] = lay_out(model)
        elements += own
    on_bearings, bearing_laws = _bearing_elements(model)
    return (*elements, *on_bearings), ElementLaws(**laws, **bearing_laws)
