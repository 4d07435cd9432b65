"""Errors of strips on rough flanks, by the even gap that replaces the true one (`contact.rough_strip`)."""

from __future__ import annotations

import numpy as np

from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.rough_strip import BREAKS
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, QUANTITIES
from fe_contact.types import FloatArray

BETWEEN_LOADS = 1.5
"""Error of the even gap at any load over the largest error at the solved loads. Nine contacts in ten keep it.
"""
AT_AN_EDGE = 0.25
"""Error of the even gap at a tip edge over the additional deflection of crests beyond plain flanks. No even
gap is fitted at edges.
"""


def rough_flank_errors(problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return the errors (P, L) of the transmission error in m; zero where no flank is rough.

    It is the mean error of the contacts, weighted with their forces. If the solution has more positions than
    forces, since base pitches follow from derivatives, all have the largest error of the first pitch.
    """
    shape, force = solution.deflection.shape, np.moveaxis(solution.force, 1, 2)
    touch = problem.candidates.touch
    if touch.offset.shape[-1] < BREAKS:
        return np.zeros(shape)
    rows = slice(len(force))
    crests = touch.curvature[rows] * touch.radius[rows]
    edge = (touch.low[rows] >= 0.0) | (touch.high[rows] <= 0.0)  # the flank ends at the touching point
    ragged = np.abs(np.log(np.where(edge & (crests > 0.0), crests, 1.0)))
    # 2 p/(pi E*), m: the load P of `contact.rough_strip` times the relative radius
    scaled = 2.0 / (np.pi * problem.modulus) * force / problem.candidates.width[rows][..., None]
    error, radius = touch.approach_error[rows][..., None], touch.radius[rows][..., None]
    of_gap = BETWEEN_LOADS * error * np.sqrt(scaled * radius)
    approach = np.maximum(np.minimum(of_gap, scaled), 0.5 * AT_AN_EDGE * ragged[..., None] * scaled)
    weight = force / np.maximum(force.sum(axis=1), 1e-300)[:, None]
    error = (weight * approach).sum(axis=1)
    return np.asarray(error) if len(error) == shape[0] else np.broadcast_to(error.max(axis=0), shape)


def quantity_errors(error: FloatArray) -> FloatArray:
    """Return the errors (23, L) of the quantities of curves with errors (P, L) of their points, m.

    Their signs are not known: a harmonic may have twice the mean.
    """
    mean, errors = error.mean(axis=0), np.empty((QUANTITIES, error.shape[1]))
    errors[:] = 2.0 * mean
    errors[MEAN], errors[PEAK_TO_PEAK] = mean, error.max(axis=0)
    return errors
