"""Whether a run stayed on the axes of its mesh-force tables."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.results.axis_series import FIELDS, axis_rows
from dynamics.types import Json

WHAT = ("tilt", "center distance")


class AxisChecks:
    """Gathers, block by block, how far misalignment and center distance left the tables' axes."""

    def __init__(self, system: System) -> None:
        self._system, self._samples = system, 0
        self._watched = [(axis, mesh) for axis in (0, 1) for mesh in axis_rows(system, axis, follows=True)]
        self._beyond = dict.fromkeys(self._watched, 0)
        self._range = dict.fromkeys(self._watched, (np.inf, -np.inf))

    def see(self, series: dict[str, Any]) -> None:
        """Take a block of series."""
        self._samples += series["time"].size
        for axis, mesh in self._watched:
            values, (low, high) = series[FIELDS[axis]][mesh], self._range[axis, mesh]
            first, last = self._ends(axis, mesh)
            self._beyond[axis, mesh] += int(np.count_nonzero((values < first) | (values > last)))
            self._range[axis, mesh] = (
                float(np.min(values, initial=low)),
                float(np.max(values, initial=high)),
            )

    def found(self) -> list[Json]:
        """Return one entry per mesh and axis in use.

        ``beyond`` is the share of the samples off the axis, where the table's last value holds, ``farthest``
        in m how far off.
        """
        return [self._entry(axis, mesh) for axis, mesh in self._watched if self._samples]

    def _entry(self, axis: int, mesh: int) -> Json:
        """One mesh and axis."""
        (low, high), (first, last) = self._range[axis, mesh], self._ends(axis, mesh)
        farthest = max(first - low, high - last, 0.0)
        span = f"{low:.4g} to {high:.4g} m of {first:.4g} to {last:.4g} m"
        reason = f"{WHAT[axis]} inside the table's axis: {span}"
        if farthest > 0.0:
            reason = f"{WHAT[axis]} beyond the axis: {span}; the last value was held. Compute a wider axis"
        return {
            "effect": self._system.ledger.effect_adding(FIELDS[axis]),
            "assumption": f"{WHAT[axis]} inside the table",
            "part": self._system.scene.meshes[mesh].name,
            "holds": farthest <= 0.0,
            "beyond": self._beyond[axis, mesh] / self._samples,
            "farthest": farthest,
            "reason": reason,
        }

    def _ends(self, axis: int, mesh: int) -> tuple[float, float]:
        """First and last knot of the table's axis, m."""
        knots = np.ravel(getattr(self._system.scene.meshes[mesh].table, FIELDS[axis]))
        return float(knots[0]), float(knots[-1])
