"""Peak pressure of the contacts, from their loads and strips."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.strip import Gap, gap_at, half_strip
from fe_contact.types import BoolArray, FloatArray

_EDGE = 0.08
"""Slope against the flank from which on a break is an edge: less than any chamfer's, more than a relief's."""


def contact_pressure(problem: ContactProblem, force: FloatArray) -> FloatArray:
    """Return the peak pressure of each contact in Pa, shape (P, L, n).

    It is 2 p/(pi h), the peak of an elliptic pressure over the strip 2 h as it is: Hertz's on a plain flank.
    Where a relief begins the pressure of a sharp kink is infinite at a point; this is the mean over the
    strip, times 4/pi. At the edge of a tip or of its chamfer, which is never sharp, it is Hertz's as if the
    flank went on; a rounded tip is what it is.

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
    endless = _unchamfered(here)._replace(low=-none, high=none)
    endless = endless._replace(slope=np.where(at_edge, 0.0, endless.slope))
    _fill(endless, np.ascontiguousarray(force) / candidates.width[:, None], problem.modulus, pressure)
    return pressure


def at_edges(problem: ContactProblem, force: FloatArray, pressure: FloatArray) -> BoolArray:
    """Return which loaded contacts (P, L, n) reach an edge with their strip: there the pressure is singular.

    `contact_pressure` states Hertz's there, which only indicates how hard the edge presses.

    Parameters
    ----------
    problem : ContactProblem
    force, pressure : ndarray, shape (P, L, n)
        Normal forces, N, and their `contact_pressure`, Pa.
    """
    here = problem.candidates.gap_about
    chamfer = np.where(here.jump >= _EDGE, np.abs(here.place), np.inf).min(axis=-1, initial=np.inf)
    reach = np.minimum(np.minimum(-here.low, here.high), chamfer)[:, None, :]
    strip = 2.0 * force / (math.pi * problem.candidates.width[:, None])  # half of it, times the pressure
    return np.asarray((force > 0.0) & (strip > reach * pressure))


def _unchamfered(about: Gap) -> Gap:
    """Return the gaps as if flanks went on over their chamfers.

    At an edge that holds the touching point slope and curvature are those to its left: a chamfer's, or else
    what the chamfer to the right of it is added to.
    """
    chamfer = about.jump >= _EDGE
    held = chamfer & (about.place == 0.0)
    to_the_left = held & (about.slope[..., None] < -0.5 * about.jump)
    return about._replace(
        slope=np.where(held.any(axis=-1), 0.0, about.slope),
        curvature=about.curvature + np.where(to_the_left, about.bend, 0.0).sum(axis=-1),
        jump=np.where(chamfer, 0.0, about.jump),
        bend=np.where(chamfer, 0.0, about.bend),
    )


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
