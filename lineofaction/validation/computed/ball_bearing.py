"""Displacement and life of a ball bearing under a load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dynamics.bearings import BallBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.rating_life import rating_life


def loaded_ball_bearing(
    bearing: Mapping[str, float], load_n: Sequence[float], rating_n: float
) -> Mapping[str, float]:
    """Return the larger displacement in µm and the rating life in million revolutions."""
    loaded = LoadedBearing(BallBearing(**bearing))  # type: ignore[arg-type]
    displacement = loaded.displacement((load_n[0], 0.0, load_n[1], 0.0, 0.0))
    life = rating_life(loaded.bearing, loaded.evaluate(displacement).load, rating_n)
    return {"displacement": 1e6 * float(np.abs(displacement[:3]).max()), "life": 1e-6 * life.revolutions}
