"""Universal files: functions at nodes (dataset 58, text or binary), by pyuff."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from lineofaction.gearbox.signals.formats.raw import RawChannel, SampleBudget, UnusableFile, wanted
from lineofaction.gearbox.signals.units import measured_unit

EXTRA = "uff"
UNITS, FUNCTION = 164, 58
_TIME, _ORDER = 17, 20
_OF_TYPE = {8: ("m", (1, 0)), 9: ("N", (0, 1)), 12: ("m/s²", (1, 0)), 13: ("N", (0, 1)), 19: ("rpm", (0, 0))}
"""SI unit and exponents of length and force, by the type of the ordinate; speeds are in rpm by the format."""
_NONE = ("", "none")
_DIRECTIONS = {1: "x", 2: "y", 3: "z"}
_TWICE = 1e-6
"""Relative difference of two statements of one unit that is no contradiction."""

Dataset = Mapping[str, Any]


def channels(file: Path, names: Sequence[str]) -> Iterator[RawChannel]:
    """Yield the functions of a file; raises `UnusableFile`: one is cut off, or states two units."""
    sets = datasets(file)
    scale = next((part for part in sets if part.get("type") == UNITS), None)
    budget = SampleBudget()
    for part in sets:
        if part.get("type") != FUNCTION:
            continue
        name = str(part.get("id1", "")).strip()
        if wanted(name, names):
            budget.take(len(part["data"]))
            yield _channel(name, part, scale)


def datasets(file: Path) -> list[Dataset]:
    """Return the datasets of a file that pyuff knows."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import pyuff  # noqa: PLC0415 (an extra)

        read = pyuff.UFF(str(file)).read_sets()
    return [part for part in (read if isinstance(read, list) else [read]) if isinstance(part, Mapping)]


def _channel(name: str, part: Dataset, scale: Dataset | None) -> RawChannel:
    if len(part["data"]) != int(part["num_pts"]) or len(part["x"]) != len(part["data"]):
        raise UnusableFile("a universal file whose functions have as many values as they say", value=name)
    label = text_of(part, "abscissa_axis_lab")
    kind = int(part["abscissa_spec_data_type"])
    over = {_TIME: "time", _ORDER: "order"}.get(kind, "time" if label.lower().startswith("time") else "")
    unit, factor = _unit(name, part, scale)
    direction = _DIRECTIONS.get(abs(int(part.get("rsp_dir") or 0)), "")
    return RawChannel(name, factor * part["data"], part["x"], unit, over, label, direction)


def _unit(name: str, part: Dataset, scale: Dataset | None) -> tuple[str, float]:
    """Return the unit of the ordinate, and the factor from its values to this unit.

    A file states it by the units of the file (dataset 164), by the label of the axis, or by both.
    """
    labeled = text_of(part, "ordinate_axis_units_lab")
    by_label = measured_unit(labeled)
    unit, exponents = _OF_TYPE.get(int(part["ordinate_spec_data_type"]), ("", (0, 0)))
    if not unit or (scale is None and exponents != (0, 0)):
        return labeled, 1.0
    factors = scale or {}
    length, force = float(factors.get("length", 1.0)), float(factors.get("force", 1.0))
    factor = 1.0 / (length ** exponents[0] * force ** exponents[1])
    by_type = measured_unit(unit)
    if by_label is not None and by_type is not None and by_label.quantity == by_type.quantity:
        if abs(by_label.factor / (by_type.factor * factor) - 1.0) > _TWICE:
            bound = f"a function with one unit; its label says {labeled}, dataset 164 another"
            raise UnusableFile(bound, "Export it in SI units.", name)
        return labeled, 1.0
    return unit, factor


def text_of(part: Dataset, key: str) -> str:
    """Return a text of a dataset; empty where it says that there is none."""
    text = str(part.get(key) or "").strip()
    return "" if text.lower() in _NONE else text
