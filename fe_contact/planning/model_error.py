"""The error of the method against full contact by regime, whatever the mesh.

The floor is the error on ordinary pairs. The larger one of two errors of unlike signs adds to it. First, the
method has small displacements, while large ones turn bodies and flanks in proportion to STE over the module.
Second, contacts move as teeth tilt, most where a soft gear runs on a stiff one; the method misses a part of
this (`flank_tilt`). Errors of peak-to-peak and harmonics are relative to the bending of teeth: reliefs make
peak-to-peak smaller but not more exact.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, OFF_MESH, QUANTITIES
from fe_contact.types import FloatArray

_ALIKE, _UNLIKE = 0.1, 0.35
"""Mean change of STE over p R/(E* m^2) for gears of one material, and its growth for unlike materials.

Twelve pairs in plane strain have 0.04 to 0.15, and 0.2 to 0.55: 17 to 90 teeth, external and internal, steel
and 9 GPa, R/m of 1.7 to 12, STE of 2 to 70 um.
"""

FLOOR = (4e-4, 4.6e-4, 2.2e-3)
"""Errors of mean, peak-to-peak and harmonics of plain flanks. The pairs of the calibration need only 0.03 and
0.04 % of mean and peak-to-peak (docs/lab/index.md).
"""
MODIFIED_FLOOR = (4e-4, 4.6e-4, 2.2e-3)
"""Errors of mean, peak-to-peak and harmonics of modified flanks. In the plane points on reliefs have the
errors of points on plain flanks; the mean of four pairs is off by 0.01 %.
"""
POINT_FLOOR = 1.2e-3
"""Error of a single point over the mean. Where teeth take over, tip edges carry."""
LARGE_DISPLACEMENT = {False: (0.05, 0.6, 0.6), True: (0.3, 0.6, 0.6)}
"""Errors of mean, peak-to-peak and harmonics by large displacements, over the mean STE in modules: in the
plane (False), and over the face (True), where patches stay in place.
"""
TILT = {False: (0.5, 3.0, 3.0), True: (2.0, 8.0, 8.0)}
"""Errors of mean, peak-to-peak and harmonics by the tilt of the flanks, over the change of the mean by it
(`flank_tilt`), in the plane (False) and over the face (True). In the plane, full contact of a soft gear on
steel with small displacements needs 0 for the mean and 2.7 for peak-to-peak; steel on steel needs 0.
"""
AT_A_POINT = 2.0
"""Error of a point over that of the mean."""
SPUR_RIPPLE, HELICAL_RIPPLE = 0.43, 0.1
"""Peak-to-peak of pairs without modifications over their mean. Spur pairs have 0.42 to 0.44 at contact ratios
of 1.56 to 1.71; helical pairs have the least usual value.
"""
HELICAL_OVERLAP = 0.5
"""Least overlap ratio with the constants of helical pairs alone; pairs of the calibration had it and more."""
RELIEVED_OVERLAP = 0.9
"""Least overlap ratio of the pairs that the constants of relieved helical pairs were set on."""
HARMONIC_OVER_PEAK, FLAT_HARMONICS = 0.5, 3
"""Harmonics over the peak-to-peak of unmodified pairs, and number of the first harmonics that are equal,
since the handover is a step. From there harmonic k falls with 1/k.
"""


def flank_tilt(pair: ParallelAxes, force: FloatArray) -> FloatArray:
    """Return the part by which the tilt of the flanks lowers the mean transmission error; `force` in N.

    The approach falls by 3 R tau^2/2 on a pair of teeth, R the relative radius of curvature, and the tilt
    tau grows with p/(E* m). In gears of one material those of both flanks nearly cancel
    (docs/theory/contact.md, "Limits").
    """
    first, second = (gear.material for gear in (pair.pinion, pair.wheel))
    soft, stiff = 1.0 / first.plane_strain_modulus, 1.0 / second.plane_strain_modulus
    unlike = (soft - stiff) / (soft + stiff)
    line_load = force * math.cos(pair.base_helix_angle) / pair.face_width
    radius = 1.0 / abs(float(pair.relative_curvature(pair.path_of_contact.pitch_point)))
    slenderness = radius / pair.pinion.normal_module**2
    return (_ALIKE + _UNLIKE * unlike**2) * line_load * slenderness / contact_modulus(first, second)


def model_errors(pair: ParallelAxes, force: FloatArray, values: FloatArray, *, over_face: bool) -> FloatArray:
    """Return the errors of the quantities of curves, m.

    Parameters
    ----------
    force : ndarray, shape (F,)
        Normal forces, N.
    values : ndarray, shape (Q, F, ...)
        Mean, peak-to-peak and harmonics of the curves, m; at least the mean.
    over_face : bool
        Whether they are of a model over the face.
    """
    strain = values[MEAN] / pair.pinion.normal_module
    large = np.multiply.outer(_by_quantity(LARGE_DISPLACEMENT[over_face], values), strain)
    floor = _by_quantity(floor_of(pair), values).reshape(-1, *[1] * strain.ndim)
    of_motion = (floor + large) * of_bending(pair, values)
    return np.asarray(np.maximum(in_small_displacements(pair, force, values, over_face=over_face), of_motion))


def in_small_displacements(
    pair: ParallelAxes, force: FloatArray, values: FloatArray, *, over_face: bool
) -> FloatArray:
    """Return the errors against full contact with the small displacements that the bodies have, m.

    Parameters are those of `model_errors`.
    """
    tilted = flank_tilt(pair, force).reshape(-1, *[1] * (values.ndim - 2))
    floor = _by_quantity(floor_of(pair), values).reshape(-1, *[1] * tilted.ndim)
    tilt = np.multiply.outer(_by_quantity(TILT[over_face], values), tilted)
    return np.asarray((floor + tilt) * of_bending(pair, values))


def floor_of(pair: ParallelAxes) -> tuple[float, float, float]:
    """Return the floor of mean, peak-to-peak and harmonics, by whether a flank is modified."""
    plain = all(gear.modification.neutral for gear in (pair.pinion, pair.wheel))
    return FLOOR if plain else MODIFIED_FLOOR


def of_bending(pair: ParallelAxes, values: FloatArray) -> FloatArray:
    """Return the sizes of the quantities (Q, ...) by the bending of teeth, m: at least `values`."""
    ripple = bending_ripple(pair)
    number = np.arange(1, QUANTITIES - FIRST_HARMONIC + 1)
    harmonics = ripple * HARMONIC_OVER_PEAK * np.minimum(1.0, FLAT_HARMONICS / number)
    over_mean = np.array([1.0, ripple, 0.0, *harmonics])  # teeth that are alike bend at mesh orders only
    return np.asarray(np.maximum(values, np.multiply.outer(over_mean[: len(values)], values[MEAN])))


def bending_ripple(pair: ParallelAxes) -> float:
    """Return peak-to-peak over mean of the pair without modifications."""
    return SPUR_RIPPLE + helical_share(pair) * (HELICAL_RIPPLE - SPUR_RIPPLE)


def helical_share(pair: ParallelAxes) -> float:
    """Return the weight of the constants of helical pairs against those of spur pairs, 0 to 1.

    It grows with the overlap: a pair of hardly any overlap has the errors of a spur pair.
    """
    return min(abs(pair.overlap_ratio) / HELICAL_OVERLAP, 1.0)


def is_relieved_helical(pair: ParallelAxes) -> bool:
    """Whether a pair is helical, solid, and relieved on both gears: its contact ends inside the flanks."""
    gears = pair.pinion, pair.wheel
    solid = not pair.internal and all(gear.web is None for gear in gears)
    relieved = all(gear.modification.varies_along_profile for gear in gears)
    return solid and relieved and abs(pair.overlap_ratio) >= RELIEVED_OVERLAP


def point_error(
    pair: ParallelAxes, force: FloatArray, deflection: FloatArray, *, over_face: bool
) -> FloatArray:
    """Return the error at points (P, F) whose STE is `deflection`, m."""
    lag = np.abs(deflection).T  # (F, P)
    (mean_error,) = model_errors(pair, force, lag[None], over_face=over_face)
    mean_floor, _, _ = floor_of(pair)
    return np.asarray(AT_A_POINT * (mean_error + (POINT_FLOOR - mean_floor) * lag).T)


def _by_quantity(part: tuple[float, float, float], values: FloatArray) -> FloatArray:
    """Return the parts of the first quantities (Q,), as many as `values` has."""
    mean, ripple, harmonic = part
    return np.array([mean, ripple, *[harmonic] * (QUANTITIES - OFF_MESH)])[: len(values)]
