"""Measured transmission errors and order spectra, read from universal files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.channel import Channel
from lineofaction.gearbox.signals.recording import Recording, read_recording
from lineofaction.gearbox.signals.units import ACCELERATION, FORCE, LENGTH, measured_unit, required_unit
from lineofaction.report.comparison.measured import MeasuredCurve, MeasuredOrders, averaged

_SCALES = {"µm": (LENGTH, 1e6), "N": (FORCE, 1.0), "m/s²": (ACCELERATION, 1.0)}
"""Quantity of a unit of the page, and value of one SI unit in that unit."""
_FORM = "one function (dataset 58) in {unit} over orders, position (base pitches) or angle (degrees)"
_AXIS_REMEDY = "Say which by the label of the abscissa: Order, Mesh order, Position or Angle."


def read_universal(path: Path, teeth: int, unit: str) -> MeasuredCurve | MeasuredOrders:
    """Return the measured curve or orders of a universal file (UFF)."""
    return of_universal(read_recording(path, "measured"), teeth, unit)


def of_universal(recording: Recording, teeth: int, unit: str) -> MeasuredCurve | MeasuredOrders:
    """Return the one function of a file that can be compared.

    `teeth` is the number of teeth of the driving gear. `unit` is that of the computed series: "µm", "N" or
    "m/s²". A complex spectrum gives its amplitudes.
    """
    quantity, per_si = _SCALES[unit]
    fitting = [channel for channel in recording.channels if _fits(channel, quantity)]
    if len(fitting) != 1:
        names = ", ".join(channel.name for channel in fitting[:8])
        present = f"{len(fitting)} in {recording.name}" + (f": {names}" if names else "")
        raise BadInput.of("measured", present, _FORM.format(unit=unit), _AXIS_REMEDY)
    (channel,) = fitting
    over, label = channel.abscissa, channel.label.lower()
    values = per_si * required_unit("measured", channel.unit, quantity).factor * channel.values
    if not (np.all(np.isfinite(over)) and np.all(np.isfinite(values))):
        raise BadInput.of("measured", channel.name, "a function of finite numbers", "Export it again.")
    if channel.over == "order":
        return MeasuredOrders(over if label.startswith("mesh") else over / teeth, np.abs(values), unit)
    position = over if label.startswith("position") else over * teeth / 360.0
    return averaged(Path(recording.name), position, np.real(values))


def _fits(channel: Channel, quantity: str) -> bool:
    unit = measured_unit(channel.unit)
    has_axis = channel.over == "order" or channel.label.lower().startswith(("position", "angle"))
    return has_axis and unit is not None and unit.quantity == quantity
