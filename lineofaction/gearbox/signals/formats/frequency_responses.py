"""Frequency response functions of universal files (dataset 58, text or binary), by pyuff, in SI units.

References
----------
.. [1] Universal File Format 58, Function at Nodal DOF: SDRL, University of Cincinnati.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile
from lineofaction.gearbox.signals.formats.universal import FUNCTION, UNITS, datasets, text_of
from lineofaction.gearbox.signals.units import FORCE, MeasuredUnit, measured_unit

EXTRA = "uff"
_FREQUENCY_RESPONSE = 4  # function type, record 6
_FREQUENCY = 18  # type of the abscissa, record 8
_MOTIONS = {8: "displacement", 11: "velocity", 12: "acceleration"}  # types of the numerator, record 9
_FORCES = (9, 13)  # types of the denominator, record 10: excitation, reaction
_PER_FORCE = {"displacement": "m/N", "velocity": "m/(N s)", "acceleration": "m/(N s²)"}
_MAX_FUNCTIONS = 8192  # 200 points in three directions per four bearings in three
_TWICE = 1e-6
"""Relative difference of two statements of one unit that is no contradiction."""
_REMEDY = "Export type and unit of numerator and denominator, or the units of the file (dataset 164)."

Dataset = Mapping[str, Any]


def channels(file: Path, _names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the frequency responses of a file with their nodes; functions of other types are passed over.

    Raises `UnusableFile`: one is cut off or not over frequency, or its unit is not stated or stated twice.
    """
    sets = datasets(file)
    scale = next((part for part in sets if part.get("type") == UNITS), None)
    budget = SampleBudget(_MAX_FUNCTIONS)
    for part in sets:
        if part.get("type") == FUNCTION and int(part["func_type"]) == _FREQUENCY_RESPONSE:
            budget.take(len(part["data"]))
            yield _response(part, scale)


def _response(part: Dataset, scale: Dataset | None) -> RawChannel:
    ends = tuple(int(part[key]) for key in ("rsp_node", "rsp_dir", "ref_node", "ref_dir"))
    name = f"{ends[0]}:{ends[1]:+d} per {ends[2]}:{ends[3]:+d}"
    if len(part["data"]) != int(part["num_pts"]) or len(part["x"]) != len(part["data"]):
        raise UnusableFile("a universal file whose functions have as many values as they say", value=name)
    if int(part["abscissa_spec_data_type"]) != _FREQUENCY:
        raise UnusableFile("a frequency response over frequency (abscissa of type 18)", value=name)
    quantity, motion = _motion(name, part, scale)
    factor = motion / _force(name, part, scale)
    values = factor * np.asarray(part["data"])
    return RawChannel(name, values, part["x"], _PER_FORCE[quantity], "frequency", nodes=ends)


def _motion(name: str, part: Dataset, scale: Dataset | None) -> tuple[str, float]:
    """Return the quantity of the numerator, and the SI value of its unit."""
    label = text_of(part, "ordinate_axis_units_lab")
    unit, kind = measured_unit(_numerator(label)), int(part["ordinate_spec_data_type"])
    quantity = _MOTIONS.get(kind) or (unit.quantity if unit is not None and kind == 0 else "")
    if quantity not in _PER_FORCE:
        bound = "a response of displacement, velocity or acceleration (numerator of type 8, 11 or 12)"
        raise UnusableFile(bound, _REMEDY, name)
    return quantity, _factor(name, quantity, (label, unit), None if scale is None else scale["length"])


def _force(name: str, part: Dataset, scale: Dataset | None) -> float:
    """Return the unit of the denominator in N."""
    label = text_of(part, "orddenom_axis_units_lab")
    kind = int(part["orddenom_spec_data_type"])
    below = text_of(part, "ordinate_axis_units_lab").rpartition("/")[2]
    if not label and (unit := measured_unit(below)) is not None and unit.quantity == FORCE:
        label = below
    unit = measured_unit(label)
    if kind not in _FORCES and (kind != 0 or unit is None or unit.quantity != FORCE):
        raise UnusableFile("a response per force (denominator of type 13 or 9)", _REMEDY, name)
    return _factor(name, FORCE, (label, unit), None if scale is None else scale["force"])


def _numerator(label: str) -> str:
    """Return the numerator of a label such as ``(m/s^2)/N``; of one without a force all of it."""
    above, _, below = label.rpartition("/")
    unit = measured_unit(below)
    is_quotient = unit is not None and unit.quantity == FORCE
    return (above if is_quotient else label).strip("()")


def _factor(
    name: str, quantity: str, labeled: tuple[str, MeasuredUnit | None], per_si: float | None
) -> float:
    """Return the SI value of one unit, by its label, by the units of the file, or by both alike.

    `per_si`: units of the file in one SI unit, of dataset 164.
    """
    label, unit = labeled
    wrong = label if unit is None and per_si is None else unit is not None and unit.quantity != quantity
    if wrong:
        raise UnusableFile(f"a response with a unit of {quantity}; its label says {label}", _REMEDY, name)
    if unit is None and per_si is None:
        raise UnusableFile(f"a response that states its unit of {quantity}", _REMEDY, name)
    by_file = None if per_si is None else _of_file(name, float(per_si))
    if unit is None or by_file is None:
        return unit.factor if unit is not None else float(by_file or 0.0)
    if abs(unit.factor / by_file - 1.0) > _TWICE:
        bound = f"a response with one unit of {quantity}; its label says {label}, dataset 164 another"
        raise UnusableFile(bound, "Export it in SI units.", name)
    return unit.factor


def _of_file(name: str, per_si: float) -> float:
    """Return the SI value of one unit of the file."""
    if not (np.isfinite(per_si) and per_si > 0.0):
        raise UnusableFile("a universal file whose units (dataset 164) are above 0", value=name)
    return 1.0 / per_si
