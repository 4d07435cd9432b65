"""Errors of the meshes of relieved helical pairs: of the mean with their sign, of the ripple without one.

Where reliefs end the contact inside the flanks, meshes and load patches change the compliance by the same
part at every position: finer meshes soften it, narrower patches stiffen it. The error of the mean therefore
has a known sign, and a *doubt*: the uncertainty of that signed error. The error of peak-to-peak has no known
sign. The difference of two meshes along the curve tells its size alone.

Changes between two meshes (or patches) are first extrapolated at second order: multiplied by the part of the
change that would remain up to infinitely fine ones. The factors of this file correct that remainder; they
were fitted to random pairs of electric drives (docs/lab/index.md, "Quiet helical pairs"). Shapes: loads f,
misalignments m, center distances d at which the table was solved again; F, M, D all those of the table.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.analysis.estimates.table_sample import Nested
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.discretization import Discretization, FaceDiscretization
from fe_contact.planning.model_error import is_relieved_helical
from fe_contact.planning.plan import Plan
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, mean_of_curves
from fe_contact.types import FloatArray


class MeshRemainder(NamedTuple):
    """Factors from the remainder of second order to the errors of a mesh."""

    mesh: float
    patches: float
    """`mesh`, `patches`: Signed errors of the mean by the mesh and by the patches, over their remainders."""
    doubt: float
    """Doubt of the signed error of the mean, over the remainder by the mesh."""
    ripple: float
    """Error of peak-to-peak, over half the peak-to-peak of the remaining difference of the curves."""
    harmonics: float
    """Error of a harmonic, over the remainder of its phasor."""


REMAINDER = {
    "draft": MeshRemainder(0.72, 1.55, 0.3, 1.35, 2.0),
    "medium": MeshRemainder(1.0, 1.55, 0.5, 1.0, 2.0),
    "standard": MeshRemainder(0.45, 1.55, 0.2, 1.2, 1.8),
}
"""Factors of each level of fidelity; the level "fine" has those of "standard"."""


def remainder_of(plan: Plan) -> MeshRemainder:
    """Return the factors of the level of a plan."""
    return REMAINDER.get(plan.level, REMAINDER["standard"])


def has_signed_errors(pair: ParallelAxes, discretization: Discretization) -> bool:
    """Whether the errors of a discretization follow the laws of this file."""
    return isinstance(discretization, FaceDiscretization) and is_relieved_helical(pair)


def mean_left(nested: Nested, plan: Plan) -> tuple[FloatArray, FloatArray]:
    """Return how much higher the mean lies on exact meshes, and the doubt of this, each (f, m, d) in m.

    `nested` has the transmission error of the table at the points that were solved again.
    """
    by_mesh = _mean(nested, nested.patched - nested.coarse) * plan.discretization.remaining
    by_patches = _mean(nested, nested.table - nested.patched) * plan.remaining_patches
    return mean_of_limit(remainder_of(plan), by_mesh, by_patches)


def mesh_bias(nested: Nested, plan: Plan) -> FloatArray:
    """Return how much higher the mean lies on exact meshes, (F,) in m, at the worst alignment of a load."""
    signed, _ = mean_left(nested, plan)
    spread = nested.sample.spread(signed)
    by_load = spread.reshape(spread.shape[0], -1)
    worst = np.abs(by_load).argmax(axis=1)
    return np.asarray(np.take_along_axis(by_load, worst[:, None], axis=1)[:, 0])


def mean_of_limit(
    remainder: MeshRemainder, by_mesh: FloatArray | float, by_patches: FloatArray | float
) -> tuple[FloatArray, FloatArray]:
    """Return how much higher the mean lies in the limit of exact meshes, and the doubt of that, m.

    `by_mesh` and `by_patches` are the remainders of second order of the mean, m.
    """
    signed = remainder.mesh * by_mesh + remainder.patches * by_patches
    return np.asarray(signed), np.asarray(remainder.doubt * np.abs(by_mesh))


def ripple_of_limit(remainder: MeshRemainder, half: FloatArray, added: FloatArray) -> FloatArray:
    """Return the error of peak-to-peak by the mesh, (f, ...) in m.

    The difference of two meshes may be small at one load by accident, but not at several. So its ratio to
    `added` (f, ...), the deflection that the load adds to the mean, is averaged over all loads. `half`
    (f, ...) is the remainder of half the peak-to-peak of the difference. Both are in m.
    """
    loads = half.shape[0]  # a mean square of few samples scatters: 1 / loads widens the error
    relative = np.sqrt(np.mean(np.square(half / added), axis=0))
    return np.asarray(remainder.ripple * np.sqrt(1.0 + 1.0 / loads) * relative * added)


def with_signed_errors(changes: FloatArray, nested: Nested, added: FloatArray, plan: Plan) -> FloatArray:
    """Return the errors by mesh and by patches (2, 23, F, M, D) in m, of the 23 quantities of a curve.

    `changes` are their remainders of second order. The error of the mean by the mesh contains its error by
    patches. `added` (f, m, d) is the deflection, m, that the load adds to the mean where the table was solved
    again.
    """
    left, remaining = remainder_of(plan), plan.discretization.remaining
    by_mesh, by_patches = changes.copy()
    by_mesh *= left.harmonics
    signed, doubt = mean_left(nested, plan)
    half = 0.5 * remaining * np.ptp(np.nan_to_num(nested.patched - nested.coarse), axis=0)
    by_mesh[MEAN] = nested.sample.spread(np.abs(signed) + doubt)
    by_mesh[PEAK_TO_PEAK] = nested.sample.spread(ripple_of_limit(left, half, added))
    by_patches[MEAN] = 0.0
    return np.stack([by_mesh, by_patches])


def _mean(nested: Nested, difference: FloatArray) -> FloatArray:
    """Return the mean over the positions (f, m, d) of a difference of curves (T R, f, m, d)."""
    sample = nested.sample
    rows = np.nan_to_num(difference).reshape(sample.knots.size, -1)
    return mean_of_curves(sample.knots, rows, sample.period).reshape(difference.shape[1:])
