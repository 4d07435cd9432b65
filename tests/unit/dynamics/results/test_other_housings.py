"""Housings of a scene beside those of a run."""

import json
from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene

from dynamics import Housing, simulate
from dynamics.results.other_housings import other_housings
from dynamics.types import FloatArray


def test_housings_are_compared_by_what_they_state():
    """Matrices without damping are the same again, and not those with another mass; without mass none is."""
    run = simulate(gear_pair_scene(duration=0.001))
    unit = np.eye(10)
    damped, bare, heavy = (
        Housing("case", ("left", "right"), _rows(1e8 * unit), mass=_rows(mass * unit), **further)
        for mass, further in ((1.0, {"damping": _rows(10.0 * unit)}), (1.0, {}), (1.1, {}))
    )
    massless = Housing("case", ("left", "right"), _rows(1e8 * unit))
    part = json.loads(json.dumps(vars(bare), default=list))
    moved = replace(run, case=run.case | {"housings": [part]})
    assert other_housings([bare, massless], moved) == ()
    for other in (damped, heavy):
        assert other_housings([other], moved) == ("case",)
    assert other_housings([bare], run) == ("case",)


def _rows(matrix: FloatArray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, matrix.tolist()))
