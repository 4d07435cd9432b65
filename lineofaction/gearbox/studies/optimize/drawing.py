"""The grid of the drawing: amounts in steps of 0.5 µm, lengths and starts of reliefs in steps of 0.1 mm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bounds.types import Json
from fe_contact.errors import InputError
from fe_contact.flank.drawing_starts import DrawingStarts, relief_length, relief_start
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.drawing_grid import Grid
from fe_contact.microgeometry.variables import LENGTHS, DesignVariable
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.gear import ToothingInput
from lineofaction.gearbox.units import MM, UM, factor

AMOUNT, LENGTH, ANGLE = 0.5 * UM, 0.1 * MM, np.radians(0.1)
"""Steps of a drawing: of an amount, of a length or diameter, and of a roll angle."""
_STARTS: Mapping[str, Figure] = {figure.field: figure for figure in figures(DrawingStarts)}
"""Figures of the starts of reliefs, by their field of a case."""


def drawing_grid(case: Case, pair: ParallelAxes, variables: Sequence[DesignVariable]) -> Grid:
    """Return the values of the variables that a drawing may state, in the form in which reliefs are typed."""
    return {variable.name: _values(case, pair, variable) for variable in variables}


def _values(case: Case, pair: ParallelAxes, variable: DesignVariable) -> FloatArray:
    if variable.quantity not in LENGTHS:
        return _steps(variable.low, variable.high, AMOUNT)
    gear_input = getattr(case.pair, variable.gear)
    field = typed_start(gear_input, variable.quantity)
    if field is None:
        return _steps(variable.low, variable.high, LENGTH)
    gear = getattr(pair, variable.gear)
    ends = sorted(relief_start(gear, _STARTS[field].name, end) for end in (variable.low, variable.high))
    lengths = []
    for start in _steps(ends[0], ends[1], ANGLE if field.endswith("_deg") else LENGTH):
        try:
            lengths.append(relief_length(gear, _STARTS[field].name, float(start)))
        except InputError:  # at the end of the flank
            continue
    inside = [length for length in lengths if variable.low <= length <= variable.high]
    return np.array(sorted(inside))


def typed_start(gear: ToothingInput, length: str) -> str | None:
    """Return the field of a gear that states where a relief starts, not its length; None: none does."""
    relief = length.removesuffix("_length")
    fields = (field for field in _STARTS if field.startswith(f"{relief}_start"))
    return next((field for field in fields if getattr(gear, field) is not None), None)


def as_typed(case: Case, pair: ParallelAxes, values: Mapping[str, float]) -> dict[str, Json]:
    """Return a design, `gear.quantity` to m, by gear and field of the case, in the form typed there."""
    out: dict[str, Json] = {}
    for name, value in values.items():
        gear, _, quantity = name.partition(".")
        field = typed_start(getattr(case.pair, gear), quantity) if quantity in LENGTHS else None
        if field is None:
            whole = boundary_name(name)
            out.setdefault(gear, {})[whole.partition(".")[2]] = _rounded(value / factor(whole))
        else:
            start = relief_start(getattr(pair, gear), _STARTS[field].name, value)
            out.setdefault(gear, {})[field] = _rounded(start / factor(field))
    return out


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def _steps(low: float, high: float, step: float) -> FloatArray:
    """Return the multiples of a step from one bound to the other."""
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return np.clip(np.arange(first, last + 1.0) * step, low, high)
