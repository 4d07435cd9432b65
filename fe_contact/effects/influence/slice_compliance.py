"""Compliance between loaded slices without finite elements: coupled springs in closed form.

A slice bends its own tooth (`tooth_bending`) and, less and less, the slices beside it: exponentially over a
decay length, as a beam on an elastic foundation, reflected at the free ends of the face, so that an even load
is met evenly. All teeth of a gear twist and shift its body, and the surface of the body sinks with the
logarithm of the distance, as that of a half plane:

    u_j = body + k ln(2 D/(j p)),    k = 2 (1 - nu^2)/(pi E),

j pitches p away on a body of depth D. Finite elements of 17 to 60 teeth give the same within 10 %. The axial
part of a helical tooth's force moves the body too (`_axial_shear`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact import ContactModel, LoadedSlices
from fe_contact.effects.influence.axial_compliance import antiplane_shear, plate_bending
from fe_contact.effects.influence.tooth_bending import half_plane, tooth_bending
from fe_contact.geometry import (
    ParallelAxes,
    Toothing,
    blank_factor,
    seat_compliance,
    web_compliance,
)
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.geometry.web_compliance import shear_modulus, shift_compliance, torsion_compliance
from fe_contact.types import FloatArray

TOOTH_DECAY = 1.7
"""Modules over which the bending of a tooth fades along the face: by the compliance (1.4 to 1.7) and the
ripple (1.6 to 1.9) of nine helical pairs of finite elements, 15 to 30 degrees, faces of 7 to 17 modules."""
BODY_DECAY = 2.0 / math.pi
"""Depths of the body over which its shear fades along the face."""
SUNK_DEPTH = 3.75
"""Modules of body depth that Weber and Banaschek's half plane stands for."""
WEB_EXCESS = 2.1
"""Compliance that a web adds over its own twist: 1.9 to 2.3 measured (docs/effects.md#thin_rim)."""


class _GearCompliance(NamedTuple):
    """Normal approach (P, n, n) in m of each slice per N on each other, of one gear."""

    tooth: FloatArray
    """Bending, shear and compression of the tooth, and compliance of its foundation."""
    contact: FloatArray
    """Approach between the load patch and the middle of the tooth."""
    body: FloatArray
    """Approach by body, web and seat."""


def slice_compliance(pair: ParallelAxes, slices: LoadedSlices, model: ContactModel) -> FloatArray:
    """Return the normal approach (P, n, n) in m of each slice per N on each other, both gears.

    The sum of `slice_compliances`, whose parameters it has.
    """
    return np.asarray(sum(part for gear in slice_compliances(pair, slices, model) for part in gear))


def slice_compliances(
    pair: ParallelAxes, slices: LoadedSlices, model: ContactModel
) -> tuple[_GearCompliance, _GearCompliance]:
    """Return the compliance between slices of the driving and of the driven gear, by source.

    Parameters
    ----------
    slices : LoadedSlices
        P positions, n slices.
    model : ContactModel
        What of it a compliance can show: coupling, finite width, rim, seats.
    """
    touch = slices.touch
    wider = finite_width_excess(pair)[1] if model.finite_width or model.across_face else 0.0
    patches = (slices.mean(patch.law_width) for patch in (slices.patch_1, slices.patch_2))
    sides = zip(
        (pair.pinion, pair.wheel),
        (touch.s_1, touch.s_2),
        (touch.lever_1, touch.lever_2),
        patches,
        strict=True,
    )
    first, second = (
        # off the line of action the gear with the edge moves less, as in `contact_problem`
        _GearCompliance(
            *(
                (1.0 + wider) * lever[:, :, None] * lever[:, None, :] * part
                for part in _of_gear(gear, slices, model, s, patch)
            )
        )
        for gear, s, lever, patch in sides
    )
    return first, second


def _of_gear(
    gear: Toothing, slices: LoadedSlices, model: ContactModel, s: FloatArray, patch: FloatArray
) -> _GearCompliance:
    bending = tooth_bending(gear)
    blank = blank_factor(gear.with_parts(model.parts))
    root = np.sqrt(bending.at(bending.tooth, s) + bending.at(bending.foundation, s) / blank)
    distance = np.abs(slices.pair[:, None] - slices.pair)
    face = slices.face_position
    decay = TOOTH_DECAY * gear.normal_module
    on_tooth = (distance == 0) * _along_face(face, decay, slices.slice_width)
    tooth = root[:, :, None] * root[:, None, :] * on_tooth
    depth = 2.0 * bending.at(bending.depth, s) / patch
    ratio = gear.material.poissons_ratio
    local = np.log(depth) - 0.5 * ratio / (1.0 - ratio) - 0.25
    # what is within the reference length is in the local law, and never more than there is
    local = np.maximum(local, np.log(slices.law_length / patch))
    local *= math.cos(gear.helix_angle) * half_plane(gear) / slices.slice_width
    body = _body(gear, slices, model)
    return _GearCompliance(
        tooth, local[:, :, None] * np.eye(face.size), body if model.couple_teeth else (distance == 0) * body
    )


def _body(gear: Toothing, slices: LoadedSlices, model: ContactModel) -> FloatArray:
    """Return the displacement (n, n) of teeth by the motion of the body under them."""
    distance, face = np.abs(slices.pair[:, None] - slices.pair), slices.face_position
    inner, outer = sorted((gear.seat_radius, gear.root_radius))
    depth = outer - inner
    pitch = math.pi * gear.transverse_module
    rigid = gear.base_radius**2 * torsion_compliance(inner, outer, gear.material)
    rigid += shift_compliance(inner, outer, gear.material)
    near = np.maximum(np.log(2.0 * depth / (np.maximum(distance, 1) * pitch)), 0.0)
    below_tooth = max(math.log(depth / (SUNK_DEPTH * gear.normal_module)), 0.0)
    sunk = half_plane(gear) * np.where(distance == 0, below_tooth, near)
    body = gear.with_parts(model.parts)
    rigid_motion = WEB_EXCESS * web_compliance(body) + _seat(body)
    transverse, axial = math.cos(gear.base_helix_angle) ** 2, math.sin(gear.base_helix_angle) ** 2
    elastic = transverse * (rigid + sunk) + axial * _axial_shear(gear, distance)
    elastic = elastic * _along_face(face, BODY_DECAY * depth, slices.slice_width)
    return np.asarray(
        elastic + transverse * rigid_motion + axial * plate_bending(gear)[distance % gear.teeth]
    )


def _axial_shear(gear: Toothing, distance: FloatArray) -> FloatArray:
    """Axial displacement (n, n) of the body; what is near the tooth is in the half plane it is clamped in."""
    near = math.log(SUNK_DEPTH * gear.normal_module / (0.5 * math.pi * gear.transverse_module))
    shear = antiplane_shear(gear)[distance % gear.teeth] - (distance == 0) * near / (
        math.pi * shear_modulus(gear.material)
    )
    return np.asarray(np.maximum(shear, 0.0))


def _seat(gear: Toothing) -> float:
    """Displacement of the line of action as the rigid gear turns and shifts on an elastic seat, m/N."""
    low, high = gear.seat.ends(gear.face_width)
    stiffness = sum(k for k in gear.seat.stiffness[:2])
    shift = 1.0 / (math.pi * gear.seat_radius * (high - low) * stiffness) if stiffness > 0.0 else 0.0
    return seat_compliance(gear) + shift


def _along_face(face: FloatArray, decay: float, width: float) -> FloatArray:
    """Displacement (n, n) per force, unit compliance per length, over a face with free ends, 1/m.

    The Green's function of u - decay^2 u'' = q, u' = 0 at both ends: cosh(a) cosh(b)/(decay sinh(c)), a and b
    the distances of the outer points from the ends and c the length, over the decay. One slice is all of it.
    """
    if np.ptp(face) == 0.0:
        return np.full((face.size, face.size), 1.0 / width)
    low, high = face.min() - 0.5 * width, face.max() + 0.5 * width
    length = (high - low) / decay
    before = (np.minimum(face[:, None], face) - low) / decay
    after = (high - np.maximum(face[:, None], face)) / decay
    # cosh cosh / sinh without overflow
    growth = np.exp(before + after - length) * (1.0 + np.exp(-2.0 * before)) * (1.0 + np.exp(-2.0 * after))
    return np.asarray(growth / (2.0 * decay * (1.0 - math.exp(-2.0 * length))))
