"""Peak pressure of the contacts, from their loads and strips."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import Gap, gap_at, half_strip
from fe_contact.types import FloatArray


def contact_pressure(problem: ContactProblem, force: FloatArray) -> FloatArray:
    """Return the peak pressure of each contact in Pa, shape (P, L, n).

    It is 2 p/(pi h), the peak of an elliptic pressure over the strip 2 h as it is: Hertz's on a plain flank.
    Where a relief begins the pressure of a sharp kink is infinite at a point; this is the mean over the
    strip, times 4/pi. At a tip edge, which is never sharp, it is Hertz's as if the flank went on.

    Parameters
    ----------
    problem : ContactProblem
    force : ndarray, shape (P, L, n)
        Normal forces, N.
    """
    pressure = np.zeros(force.shape)
    candidates = problem.candidates
    here = candidates.gap_about
    at_edge, none = (here.low >= 0.0) | (here.high <= 0.0), np.full(here.low.shape, np.inf)
    endless = here._replace(slope=np.where(at_edge, 0.0, here.slope), low=-none, high=none)
    _fill(endless, np.ascontiguousarray(force) / candidates.width[:, None], problem.modulus, pressure)
    return pressure


@njit(cache=True)
def _fill(about: Gap, line_load: FloatArray, modulus: float, out: FloatArray) -> None:
    """Fill in where there is load."""
    positions, loads, contacts = line_load.shape
    for p in range(positions):
        here = gap_at(about, p)
        for k in range(loads):
            for i in range(contacts):
                load = line_load[p, k, i]
                if load > 0.0:
                    out[p, k, i] = 2.0 * load / (math.pi * half_strip(here, i, load, modulus)[0])
