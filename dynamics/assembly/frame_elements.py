"""The force elements of rotating frames: terms of rotors that rotate, and couplings across frames.

Axis letters: N columns, the six freedoms of every rotor; k laws of the kinematic motion. Local coordinates
are lengths in m: angles are multiplied by a lever. An element reads no position where its mesh is -1.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.assembly.model import Model
from dynamics.forces.elements import Element
from dynamics.forces.frame_coupling import FrameCouplingLaws
from dynamics.forces.frames import FrameTerm, RotatingFrameLaws
from dynamics.forces.laws import Law
from dynamics.mechanism.bearing_elements import tilt_lever
from dynamics.mechanism.carried_planets import ROTATION
from dynamics.mechanism.columns import section_rows
from dynamics.mechanism.coupling_rows import ACROSS, full_matrix
from dynamics.mechanism.frame_couplings import frame_couplings
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.mechanism import Mechanism
from dynamics.types import FloatArray


def rotating_frame_elements(model: Model) -> tuple[tuple[Element, ...], RotatingFrameLaws]:
    """Return the elements, and their laws, of the terms that effects add to rotors in rotation.

    Terms that no freedom moves have no element.
    """
    mechanism, freedoms = model.mechanism, model.freedoms
    lever, free = tilt_lever(mechanism.scene), mechanism.freely_turned
    terms: list[tuple[int, FrameTerm]] = []
    for index, rotor in enumerate(mechanism.rotors):
        added = [
            term
            for effect in model.ledger.on_rotor(rotor.shaft.name)
            for term in effect.frame_terms(mechanism, model.connections, index)
        ]
        moving = [term for term in added if np.any(freedoms.keep(term.rows))]
        terms += [(index, term) for term in _merged_terms(moving, freedoms)]
    elements = tuple(
        _rotor_element(mechanism, entry, index, term.rows, spin_lever=lever if free[index] else 0.0)
        for entry, (index, term) in enumerate(terms)
    )
    spinning = [bool(free[index]) for index, _ in terms]
    return elements, RotatingFrameLaws.packed([term for _, term in terms], lever, spinning)


def _merged_terms(terms: Sequence[FrameTerm], freedoms: Freedoms) -> list[FrameTerm]:
    """Return the terms of a rotor, with those of equal motion added up: a term costs two unknowns a stage."""
    merged: list[FrameTerm] = []
    for term in terms:
        for entry, other in enumerate(merged):
            if np.array_equal(freedoms.keep(term.rows), freedoms.keep(other.rows)):
                merged[entry] = other.plus(term)
                break
        else:
            merged.append(term)
    return merged


def _rotor_element(
    mechanism: Mechanism, entry: int, index: int, across: FloatArray, spin_lever: float
) -> Element:
    """Return the element of a rotor with its rows `across` the axis (2, N).

    With a `spin_lever` > 0 (m) it has a third row, the rotation of the shaft times the lever.
    """
    vectors = mechanism.vectors  # (k, N)
    ratio, frame = mechanism.kinematics.float_ratio, mechanism.rotors[index].frame
    rows, drift = across, across @ vectors.T
    if spin_lever > 0.0:
        spin = np.zeros((1, across.shape[1]))
        spin[0, 6 * index + ROTATION] = spin_lever
        rows, drift = np.concatenate([rows, spin]), np.concatenate([drift, np.zeros((1, drift.shape[1]))])
    frame_speed = np.zeros(ratio.shape[1]) if frame is None else ratio[frame]
    speed = np.array([ratio[index], frame_speed])
    return Element(Law.ROTATING_FRAME, entry, -1, rows, np.zeros(len(rows)), drift, speed=speed)


def frame_coupling_elements(model: Model) -> tuple[tuple[Element, ...], FrameCouplingLaws]:
    """Return the elements of all couplings between shafts of different frames, and their laws.

    A coupling acts in n = 2 directions across the axis, or in 4 with the tilts. The element reads the turn of
    its second frame against its first, a position behind those of the meshes.
    """
    scene, rotors = model.mechanism.scene, model.mechanism.rotors
    parts, lever = frame_couplings(scene), tilt_lever(scene)
    elements = []
    size = np.array([1.0, 1.0, lever, lever])
    stiffness, damping = np.zeros((len(parts), 4, 4)), np.zeros((len(parts), 4, 4))
    for entry, part in enumerate(parts):
        coupling, n = scene.couplings[part.coupling], part.directions
        for packed, matrix in ((stiffness, coupling.stiffness), (damping, coupling.damping)):
            packed[entry] = full_matrix(matrix, 0.0)[np.ix_(ACROSS, ACROSS)] / np.outer(size, size)
        ends = (section_rows(rotors, rotor, part.height) for rotor in (part.first, part.second))
        gradient = np.concatenate([(moves[list(ACROSS)] * size[:, None])[:n] for moves in ends])
        row_stiffness = np.tile(np.diag(stiffness[entry])[:n], 2)
        phase = len(scene.meshes) + entry
        offset = np.zeros(2 * n)
        elements.append(Element(Law.FRAME_COUPLING, entry, phase, gradient, offset, stiffness=row_stiffness))
    directions = np.array([part.directions for part in parts], dtype=np.int64)
    return tuple(elements), FrameCouplingLaws(directions, stiffness, damping)
