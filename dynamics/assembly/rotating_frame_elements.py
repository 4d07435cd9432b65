"""Rotating-frame elements: what effects add to rotors because these, or their frames, rotate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.model import Model
from dynamics.effects.frame_term import FrameTerm, frame_laws, frame_lever
from dynamics.forces.law import Law
from dynamics.forces.rotating_frame import RotatingFrameLaws
from dynamics.mechanism.freedoms import ROTATION, Freedoms
from dynamics.mechanism.mechanism import Mechanism
from dynamics.types import FloatArray


def rotating_frame_elements(model: Model) -> tuple[tuple[Element, ...], RotatingFrameLaws]:
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
