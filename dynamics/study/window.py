"""The part of a run that responses are taken from, with what several of them need."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from dynamics.checks import within
from dynamics.orders.valid_orders import checked_order
from dynamics.results import RunResult
from dynamics.results.order_fit import order_amplitudes, unwrapped
from dynamics.types import FloatArray

SOURCES = ("time_step", "table_interpolation")
"""Of a run's error, as its receipt states them."""


@dataclass(frozen=True)
class Window:
    """A run from a time on.

    Attributes
    ----------
    run : RunResult
    part : slice
        Its samples.
    highest_order : int
        Up to which orders are fitted, all together.
    bearings : tuple of int
        Whose forces are fitted.
    mesh : int
        Whose orders they are.
    """

    run: RunResult
    part: slice
    highest_order: int
    bearings: tuple[int, ...]
    mesh: int = 0
    _fits: dict[int, tuple[FloatArray, dict[int, FloatArray]]] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, run: RunResult, start: float, highest_order: int, bearings: tuple[int, ...]) -> Window:
        """Look at a run from `start` (s) on.

        Raises
        ------
        InputError
            The run ends before, or its output does not hold the order.
        """
        end = float(run.time[-1])
        return cls(run, run.window(within("start", start, 0.0, end), end), highest_order, bearings)

    def along(self, mesh: int) -> Window:
        """Return the same with the orders of a mesh."""
        return replace(self, mesh=mesh)

    def transmission_error(self, mesh: int) -> FloatArray:
        """Dynamic transmission error (T,), m."""
        return self.run.dynamic_transmission_error[mesh, self.part]

    @property
    def orders(self) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Amplitudes of the transmission error (H,) in m, and of the force of each bearing (3, H) in N.

        Of one fit to all of them, up to the highest order H.
        """
        if self.mesh not in self._fits:
            self._fits[self.mesh] = self._fitted()
        return self._fits[self.mesh]

    def _fitted(self) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Fit the orders of the mesh."""
        checked_order(self.run, "order", self.highest_order, self.mesh)
        position = unwrapped(self.run.position[self.mesh, self.part])
        forces = (self.run.bearing_force[bearing, :, self.part] for bearing in self.bearings)
        signals = np.vstack([self.transmission_error(self.mesh)[None], *forces])
        error, *force = order_amplitudes(position, signals, self.highest_order)
        return error, dict(zip(self.bearings, np.reshape(force, (-1, 3, self.highest_order)), strict=True))

    def error(self, name: str, order: int = 0) -> float:
        """Sum of the errors by source that the receipt states under a name; NaN where it states none."""
        stated = [self.run.receipt["error"].get(source, {}).get(name) for source in SOURCES]
        if order:
            stated = [None if each is None or len(each) < order else each[order - 1] for each in stated]
        known = [float(each) for each in stated if each is not None]
        return float(np.sum(known)) if known else float("nan")
