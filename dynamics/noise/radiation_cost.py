"""Time and memory of a radiation resistance over a range of frequencies, predicted before it is computed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from dynamics.acoustics import Air, RadiationModel
from dynamics.noise.coarse_hull import RadiatingHull
from dynamics.noise.knots import expected_knots
from dynamics.work_cost import Cost

USUAL = 0.85
"""Frequency of an octave whose cost is the mean, over its highest: they lie closer towards its end."""


class Octave(NamedTuple):
    """A range of frequencies, Hz, and the panels that resolve it."""

    first: float
    last: float
    hull: RadiatingHull


def radiation_cost(octaves: Iterable[Octave], model: RadiationModel, air: Air) -> Cost:
    """Predict the cost of `housing_radiation` once its hulls are there, on the reference host."""
    whole = Cost(0.0, 0.0)
    for octave in octaves:
        whole = whole.then(_cost(octave, model, air))
    return whole


def _cost(octave: Octave, model: RadiationModel, air: Air) -> Cost:
    """Return the cost of the resistances of an octave."""
    panels, coordinates = octave.hull.shapes.shape
    per_hertz = 2.0 * math.pi / air.sound_speed * octave.hull.hull.outer_radius
    usual = USUAL * octave.last
    return model.cost(panels, per_hertz * usual, coordinates).times(expected_knots(per_hertz * octave.last))
