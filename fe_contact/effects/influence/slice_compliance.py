"""Compliance between loaded slices without finite elements: springs that know of each other.

A slice bends its own tooth (`_tooth_bending`) and, less and less, the slices beside it: exponentially over a
decay length, as a beam on an elastic foundation, reflected at the free ends of the face, so that an even load
is met evenly. All teeth of a gear twist and shift its body, and the surface of the body sinks with the
logarithm of the distance, as that of a half plane:

    u_j = body + k ln(2 D/(j p)),    k = 2 (1 - nu^2)/(pi E),

j pitches p away on a body of depth D. Finite elements of 17 to 60 teeth give the same within 10 %. The axial
part of a helical tooth's force moves the body too (`_axial_shear`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fe_contact.contact import ContactModel, LoadedSlices
from fe_contact.geometry import (
    ParallelAxes,
    Toothing,
    blank_factor,
    seat_compliance,
    tooth_profile,
    web_compliance,
)
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.geometry.web_compliance import shear_modulus, shift_compliance, torsion_compliance
from fe_contact.types import FloatArray

# Compliance of a gear under the axial part of the force of a helical tooth, in closed form.
#
# The body is an annular plate held at its bore, loaded at its edge (S. Timoshenko, S. Woinowsky-Krieger:
# Theory of Plates and Shells, 1959, art. 62): every harmonic of the load around the gear bends it, clamped
# inside and free outside, and shears it, as an antiplane shear of the annulus. The force acts above the
# edge, where the tooth is, and turns it too.

BENDING_HARMONICS = 12
"""Of the load around a gear; bending falls with the third power of their number."""

_SAMPLES = 101
TOOTH_DECAY = 1.7
"""Modules over which the bending of a tooth fades along the face: by the compliance (1.4 to 1.7) and the
ripple (1.6 to 1.9) of nine helical pairs of finite elements, 15 to 30 degrees, faces of 7 to 17 modules."""
BODY_DECAY = 2.0 / math.pi
"""Depths of the body over which its shear fades along the face."""
SUNK_DEPTH = 3.75
"""Modules of body depth that Weber and Banaschek's half plane stands for."""
WEB_EXCESS = 2.1
"""Compliance that a web adds over its own twist: 1.9 to 2.3 measured (docs/effects.md#thin_rim)."""


@lru_cache(maxsize=64)
def _plate_bending(gear: Toothing) -> FloatArray:
    """Axial displacement (z,) of the load's place per axial force, m/N, 0, 1, ... teeth apart."""
    material, radius = gear.material, gear.root_radius
    rigidity = material.youngs_modulus * gear.face_width**3 / (12.0 * (1.0 - material.poissons_ratio**2))
    ratio, above = gear.held_radius / radius, abs(gear.reference_radius / radius - 1.0)
    orders = range(BENDING_HARMONICS + 1)
    amplitudes = np.array([_bent(n, ratio, above, material.poissons_ratio) for n in orders])
    return _around(gear, amplitudes * radius**2 / (math.pi * rigidity))


@lru_cache(maxsize=64)
def _antiplane_shear(gear: Toothing) -> FloatArray:
    """Axial displacement (z,) per line load, m/(N/m), of the body's edge 0, 1, ... teeth apart.

    A load is spread over half a pitch, the thickness of its tooth.
    """
    order = np.arange(1, 4 * gear.teeth + 1)
    ratio = gear.held_radius / gear.root_radius
    inner = min(ratio, 1.0 / ratio) ** (2 * order)
    spread = np.sinc(0.5 * order / gear.teeth) ** 2
    amplitudes = np.concatenate([[abs(math.log(ratio))], (1.0 - inner) / (1.0 + inner) / order * spread])
    return _around(gear, amplitudes / (math.pi * shear_modulus(gear.material)))


def _around(gear: Toothing, amplitudes: FloatArray) -> FloatArray:
    """Sum the harmonics of a force at tooth 0 at all teeth; the even one counts half."""
    amplitudes = amplitudes * np.where(np.arange(amplitudes.size) == 0, 0.5, 1.0)
    angle = 2.0 * math.pi * np.arange(gear.teeth) / gear.teeth
    return np.asarray(np.cos(angle[:, None] * np.arange(amplitudes.size)) @ amplitudes)


def _bent(n: int, ratio: float, above: float, poisson: float) -> float:
    """Displacement at a lever `above` the edge, for harmonic `n` of a unit force there.

    A plate whose edge has the radius 1 and whose rigidity is 1, held at the radius `ratio`: inside, or
    outside as a ring gear is. Its shapes are r^n, r^-n, r^(n + 2), r^(2 - n), with ln r where two are one.
    """
    powers = [(n, 0), (-n, 0), (n + 2, 0), (2 - n, int(n == 1))] if n else [(0, 0), (0, 1), (2, 0), (2, 1)]
    inner_edge, edge = (np.array([_derivatives(*power, r) for power in powers]).T for r in (ratio, 1.0))
    value, slope, second, third = edge
    outwards = math.copysign(1.0, 1.0 - ratio)
    moment = second + poisson * (slope - n**2 * value)
    force = third + second - (1 + n**2) * slope + 2 * n**2 * value - (1.0 - poisson) * n**2 * (slope - value)
    factors = np.linalg.solve(
        np.stack([inner_edge[0], inner_edge[1], moment, -outwards * force]), [0.0, 0.0, above, 1.0]
    )
    return float(factors @ (value + outwards * above * slope))


def _derivatives(power: int, logarithm: int, r: float) -> list[float]:
    """Return r^power, times ln r if `logarithm` is 1, and its first three derivatives."""
    derivatives, slope, rest = [], float(logarithm), 1.0 - logarithm
    for k in range(power, power - 4, -1):
        derivatives.append((slope * math.log(r) + rest) * r**k)
        slope, rest = k * slope, k * rest + slope
    return derivatives


# Compliance of a tooth under a line load, in closed form.
#
# C. Weber, K. Banaschek: Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern.
# Schriftenreihe Antriebstechnik 11, Vieweg 1953: bending, shear and compression of the tooth over its root,
# the elastic half plane that it is clamped in, and the approach of the contact to the tooth's middle. Against
# finite elements of the transverse section (17 to 60 teeth, loads over the whole flank) it is right within 5
# %.


@dataclass(frozen=True)
class _ToothBending:
    """Compliance of one tooth in the transverse section, by flank coordinate."""

    s: FloatArray
    """Flank coordinates from root to tip, m. Shape (n,)."""
    tooth: FloatArray
    foundation: FloatArray
    """`tooth`, `foundation`: Displacement along the normal per line load of the tooth itself and of what it
    is clamped in, m/(N/m). Shape (n,) each.
    """
    depth: FloatArray
    """Distance in m along the normal from the flank to the tooth's center line. Shape (n,)."""

    def at(self, values: FloatArray, s: FloatArray) -> FloatArray:
        """Interpolate one of the attributes at flank coordinates `s` of any shape."""
        return np.asarray(np.interp(s, self.s, values))


@lru_cache(maxsize=64)
def _tooth_bending(gear: Toothing) -> _ToothBending:
    """Integrate over the tooth of `gear`, plane strain.

    A helical tooth bends in its normal section: there it is thinner, and longer by the same factor.
    """
    profile = tooth_profile(gear)
    s = np.linspace(profile.s_root, profile.s_tip, _SAMPLES)
    half, height = profile.flank(s).T
    height = np.abs(height - height[0])
    normal = profile.normal(s)
    narrow = math.cos(gear.helix_angle)
    half = narrow * half
    slope = narrow * gear.sign * normal[:, 1] / np.abs(normal[:, 0])
    cosine = 1.0 / np.sqrt(1.0 + slope**2)
    # where the line of action crosses the center line, above the root
    lever = np.maximum(height - half * slope, 0.0)
    per_modulus = narrow * cosine**2 * (1.0 - gear.material.poissons_ratio**2) / gear.material.youngs_modulus
    root = 2.0 * half[0]
    foundation = 5.2 * (lever / root) ** 2 + lever / root + 1.4 * (1.0 + 0.294 * slope**2)
    tooth = _energy(height, 2.0 * half, lever, slope, gear.material.poissons_ratio)
    return _ToothBending(s, per_modulus * tooth, per_modulus * foundation, half / cosine)


def _energy(
    height: FloatArray, thickness: FloatArray, lever: FloatArray, slope: FloatArray, ratio: float
) -> FloatArray:
    """12 int (h - y)^2/t^3 dy + (2.4/(1 - nu) + tan^2) int dy/t up to the lever h of every load."""
    zeroth, first, second = (_up_to(lever, height, height**k / thickness**3) for k in range(3))
    bending = lever**2 * zeroth - 2.0 * lever * first + second
    return np.asarray(
        12.0 * bending + (2.4 / (1.0 - ratio) + slope**2) * _up_to(lever, height, 1.0 / thickness)
    )


def _up_to(lever: FloatArray, height: FloatArray, values: FloatArray) -> FloatArray:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(height)
    return np.asarray(np.interp(lever, height, np.concatenate([[0.0], np.cumsum(steps)])))


def half_plane(gear: Toothing) -> float:
    """2 (1 - nu^2)/(pi E), 1/Pa."""
    return 2.0 * (1.0 - gear.material.poissons_ratio**2) / (math.pi * gear.material.youngs_modulus)


class _GearCompliance(NamedTuple):
    """Normal approach (P, n, n) in m of each slice per N on each other, of one gear."""

    tooth: FloatArray
    """Bending, shear and compression of the tooth, and what it is clamped in."""
    contact: FloatArray
    """From under the load patch to the tooth's middle."""
    body: FloatArray
    """Body, web and seat."""


def slice_compliance(pair: ParallelAxes, slices: LoadedSlices, model: ContactModel) -> FloatArray:
    """Return the normal approach (P, n, n) in m of each slice per N on each other, both gears.

    The sum of `slice_compliances`, whose parameters it has.
    """
    return np.asarray(sum(part for gear in slice_compliances(pair, slices, model) for part in gear))


def slice_compliances(
    pair: ParallelAxes, slices: LoadedSlices, model: ContactModel
) -> tuple[_GearCompliance, _GearCompliance]:
    """Return the compliance between slices of the driving and of the driven gear by what yields.

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
    bending = _tooth_bending(gear)
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
    """Displacement (n, n) of teeth by what the body under them does."""
    distance, face = np.abs(slices.pair[:, None] - slices.pair), slices.face_position
    inner, outer = sorted((gear.held_radius, gear.root_radius))
    depth = outer - inner
    pitch = math.pi * gear.transverse_module
    rigid = gear.base_radius**2 * torsion_compliance(inner, outer, gear.material)
    rigid += shift_compliance(inner, outer, gear.material)
    near = np.maximum(np.log(2.0 * depth / (np.maximum(distance, 1) * pitch)), 0.0)
    below_tooth = max(math.log(depth / (SUNK_DEPTH * gear.normal_module)), 0.0)
    sunk = half_plane(gear) * np.where(distance == 0, below_tooth, near)
    body = gear.with_parts(model.parts)
    whole = WEB_EXCESS * web_compliance(body) + _seat(body)
    transverse, axial = math.cos(gear.base_helix_angle) ** 2, math.sin(gear.base_helix_angle) ** 2
    elastic = transverse * (rigid + sunk) + axial * _axial_shear(gear, distance)
    elastic = elastic * _along_face(face, BODY_DECAY * depth, slices.slice_width)
    return np.asarray(elastic + transverse * whole + axial * _plate_bending(gear)[distance % gear.teeth])


def _axial_shear(gear: Toothing, distance: FloatArray) -> FloatArray:
    """Axial displacement (n, n) of the body; what is near the tooth is in the half plane it is clamped in."""
    near = math.log(SUNK_DEPTH * gear.normal_module / (0.5 * math.pi * gear.transverse_module))
    shear = _antiplane_shear(gear)[distance % gear.teeth] - (distance == 0) * near / (
        math.pi * shear_modulus(gear.material)
    )
    return np.asarray(np.maximum(shear, 0.0))


def _seat(gear: Toothing) -> float:
    """Displacement of the line of action as the rigid gear turns and shifts on an elastic seat, m/N."""
    low, high = gear.seat.ends(gear.face_width)
    stiffness = sum(k for k in gear.seat.stiffness[:2])
    shift = 1.0 / (math.pi * gear.held_radius * (high - low) * stiffness) if stiffness > 0.0 else 0.0
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
