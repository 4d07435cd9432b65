"""Compliance between loaded slices without finite elements: coupled springs in closed form.

A force on a slice bends the tooth there (`tooth_bending`) and, with the distance along the face, less and
less at other slices: exponentially over a decay length, like a beam on an elastic foundation. The decay is
reflected at the free ends of the face, so that a uniform load bends the tooth uniformly.

The forces on all teeth also rotate and shift the gear's body. Around a loaded tooth the surface of the body
sinks as that of a half plane, with the logarithm of the distance:

    u_j = body + k ln(2 D/(j p)),    k = 2 (1 - nu^2)/(pi E).

u_j is the displacement j pitches p away on a body of depth D, `body` that by rotation and shift. Finite
elements of 17 to 60 teeth give the same within 10 %. The axial component of a helical tooth's force moves the
body too (`_axial_shear`). Shapes: P positions, n slices.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact import ContactModel, LoadedSlices
from fe_contact.effects.influence.axial_compliance import antiplane_shear, plate_bending
from fe_contact.effects.influence.tooth_bending import half_plane, tooth_bending
from fe_contact.geometry import ParallelAxes, Toothing, blank_factor, seat_compliance, web_compliance
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.geometry.web_compliance import shear_modulus, shift_compliance, torsion_compliance
from fe_contact.types import FloatArray

TOOTH_DECAY = 1.7
"""Decay length of a tooth's bending along the face, modules.

Fitted to the compliance (1.4 to 1.7) and the ripple (1.6 to 1.9) of nine helical pairs of finite elements,
helix angles of 15 to 30 degrees, faces of 7 to 17 modules.
"""
BODY_DECAY = 2.0 / math.pi
"""Decay length of the body's shear along the face, depths of the body."""
SUNK_DEPTH = 3.75
"""Depth of the body, modules, whose sinking is in the foundation of `tooth_bending` (Weber and Banaschek)."""
WEB_EXCESS = 2.1
"""Compliance that a web adds over that of its torsion: 1.9 to 2.3 measured (docs/effects.md#thin_rim)."""


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

    It is the sum of `slice_compliances` over gears and sources; the parameters are the same.
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
        Contact model, of which coupling of teeth, finite width, rim and seats change the compliance.
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
    # approach between the middle of the tooth and the load patch, over the half plane's k
    depth = 2.0 * bending.at(bending.depth, s) / patch
    ratio = gear.material.poissons_ratio
    local = np.log(depth) - 0.5 * ratio / (1.0 - ratio) - 0.25
    # at least the approach within the reference length, which the local law takes from it
    local = np.maximum(local, np.log(slices.law_length / patch))
    local *= math.cos(gear.helix_angle) * half_plane(gear) / slices.slice_width
    body = _body(gear, slices, model)
    return _GearCompliance(
        tooth, local[:, :, None] * np.eye(face.size), body if model.couple_teeth else (distance == 0) * body
    )


def _body(gear: Toothing, slices: LoadedSlices, model: ContactModel) -> FloatArray:
    """Return the displacement (n, n) of teeth per force by the motion of the body under them, m/N."""
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
    """Return the axial displacement (n, n) of the body per axial force, for unit length of the face.

    The displacement near the loaded tooth is left out, since `tooth_bending` has it in its foundation.
    """
    near = math.log(SUNK_DEPTH * gear.normal_module / (0.5 * math.pi * gear.transverse_module))
    shear = antiplane_shear(gear)[distance % gear.teeth] - (distance == 0) * near / (
        math.pi * shear_modulus(gear.material)
    )
    return np.asarray(np.maximum(shear, 0.0))


def _seat(gear: Toothing) -> float:
    """Return the displacement along the line of action of a rigid gear on an elastic seat, m/N."""
    low, high = gear.seat.ends(gear.face_width)
    stiffness = sum(k for k in gear.seat.stiffness[:2])  # radial and tangential
    shift = 1.0 / (math.pi * gear.seat_radius * (high - low) * stiffness) if stiffness > 0.0 else 0.0
    return seat_compliance(gear) + shift


def _along_face(face: FloatArray, decay: float, width: float) -> FloatArray:
    """Return the displacement (n, n) per force over a face with free ends, unit compliance per length, 1/m.

    It is the Green's function of u - decay^2 u'' = q with u' = 0 at both ends: cosh(a) cosh(b)/(decay
    sinh(c)). Over the decay, a is the distance of the lower of the two points from the low end, b that of the
    upper point from the high end, and c the length. A face of one slice moves as a whole.
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
