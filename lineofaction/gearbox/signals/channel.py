"""A channel of a recording: values over time, or over another abscissa, with facts of its file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.units import MeasuredUnit, required_unit

FloatArray = NDArray[np.float64]
UNIFORM = 0.01
"""Largest distance of a sample from the uniform grid, in steps: jitter of a clock, and digits of a file."""


@dataclass(frozen=True)
class Channel:
    """A series of a file."""

    name: str
    unit: str
    """`name`, `unit`: Printable, as the file has them; the unit is empty where the file states none."""
    abscissa: FloatArray
    values: NDArray[Any]
    """`abscissa`, `values`: Values may be complex. Shape (n,) each."""
    over: str = "time"
    """Kind of abscissa: ``"time"`` (s), ``"order"``, ``"frequency"`` (Hz) of a frequency response, or empty
    for another kind.
    """
    label: str = ""
    """Name of the abscissa in the file."""
    direction: str = ""
    """``"x"``, ``"y"``, ``"z"`` where the file says along which the sensor measures; else empty."""
    nodes: tuple[int, ...] = ()
    """Response node and direction, reference node and direction of a frequency response; otherwise empty.
    Directions are 1 to 3 for x, y, z, negative for the opposite sense.
    """

    def series(self, field: str) -> tuple[FloatArray, FloatArray]:
        """Return times (n,) and values (n,) as the file has them.

        Raises `BadInput`: they are not over time, fewer than two, no finite real numbers, or time does not
        rise.
        """
        if self.over != "time":
            over = self.label or self.over or "something else"
            raise BadInput.of(field, self.name, f"a channel over time; it is over {over}")
        if self.values.size < 2:
            raise BadInput.of(field, self.name, f"at least two samples; it has {self.values.size}")
        if np.iscomplexobj(self.values) or not np.all(np.isfinite(self.values)):
            remedy = "Remove the gaps before the export, or name another channel."
            raise BadInput.of(field, self.name, "a channel of finite real numbers", remedy)
        rises = np.diff(self.abscissa) > 0.0
        if not (np.all(np.isfinite(self.abscissa)) and np.all(rises)):
            sample = int(np.argmin(rises)) + 1
            bound = f"a channel whose time rises; at sample {sample} it does not"
            raise BadInput.of(field, self.name, bound, "Export one recording, in the order of time.")
        return self.abscissa, np.asarray(self.values, dtype=np.float64)

    def measured(self, field: str, quantity: str, unit: str = "") -> tuple[FloatArray, FloatArray]:
        """Return times (n,) in s and values (n,) in the SI unit of a quantity.

        `unit` takes the place of the file's. Raises `BadInput` as `series` does, or the unit is of another
        quantity or none.
        """
        measured_unit: MeasuredUnit = required_unit(
            f"unit of {field} {self.name}", unit or self.unit, quantity
        )
        time, values = self.series(field)
        return time, measured_unit.factor * values


def uniform_rate(field: str, name: str, time: FloatArray) -> float:
    """Return the samples per second of times (n,).

    Raises `BadInput`: they are not evenly spaced.
    """
    step = (time[-1] - time[0]) / (time.size - 1)
    far = float(np.max(np.abs(time - (time[0] + step * np.arange(time.size))))) / step
    if far > UNIFORM:
        bound = f"sampled evenly: within {UNIFORM:g} of a step; it is off by {far:.3g}"
        raise BadInput.of(field, name, bound, "Export it at one sample rate.")
    return float(1.0 / step)
