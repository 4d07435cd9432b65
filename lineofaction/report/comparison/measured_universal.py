"""Measured transmission errors and order spectra, read from universal files (dataset 58, by pyuff)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.measured import MeasuredCurve, MeasuredOrders, averaged
from lineofaction.report.drawing.figure import FloatArray

ENDINGS = (".unv", ".uff", ".uf")
ORDER = 20
"""Specific data type of an abscissa of orders; positions and angles have none, their label tells them."""
_OF_TYPE = {8: ("µm", 1e6, (1, 0)), 9: ("N", 1.0, (0, 1)), 13: ("N", 1.0, (0, 1)), 12: ("m/s²", 1.0, (1, 0))}
"""Unit, what one SI unit is in it, and exponents of length and force, by the type of the ordinate."""
_FORM = "one function (dataset 58) in {unit} over orders, position (base pitches) or angle (degrees)"
_ADVICE = "Say which by the label of the abscissa: Order, Mesh order, Position or Angle."

Dataset = Mapping[str, Any]


def read_universal(path: Path, teeth: int, unit: str) -> MeasuredCurve | MeasuredOrders:
    """Read the one function of a file that can be compared; `teeth` are those of the driving gear.

    Parameters
    ----------
    path : Path
    teeth : int
    unit : str
        "µm", "N" or "m/s²": of what it is compared with. Values are converted by the file's units (dataset
        164); complex ones count by their amplitude.

    Raises
    ------
    BadInput
        No universal file, none or several such functions, or less than one base pitch.
    """
    datasets = _datasets(path)
    scale = next((each for each in datasets if each["type"] == 164), {})
    fitting = [each for each in datasets if each["type"] == 58 and _fits(each, unit)]
    if len(fitting) != 1:
        names = ", ".join(str(each["id1"]).strip() for each in fitting[:8])
        found = f"{len(fitting)} in {path.name}" + (f": {names}" if names else "")
        raise BadInput.of("measured", found, _FORM.format(unit=unit), _ADVICE)
    (function,) = fitting
    over, label = np.asarray(function["x"], dtype=np.float64), _label(function)
    values = _values(function, scale)
    if function["abscissa_spec_data_type"] == ORDER:
        return MeasuredOrders(over if label.startswith("mesh") else over / teeth, np.abs(values), unit)
    return averaged(path, over if label.startswith("position") else over * teeth / 360.0, np.real(values))


def _datasets(path: Path) -> list[Dataset]:
    """Return all datasets of a file."""
    if not path.is_file():
        raise BadInput.of("measured", str(path), "a universal file", "Check the path.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import pyuff  # noqa: PLC0415 (an extra)

            read = pyuff.UFF(str(path)).read_sets()
    except ImportError:
        advice = "pip install 'lineofaction[uff]'"
        raise BadInput.of("measured", str(path), "a CSV file without the extra uff", advice) from None
    except Exception:  # noqa: BLE001 (of a damaged file: whatever the reader meets)
        advice = "Export it again, as text (UFF58)."
        raise BadInput.of("measured", str(path), "a readable universal file", advice) from None
    return list(_known(read if isinstance(read, list) else [read]))


def _known(read: list[Any]) -> Iterator[Dataset]:
    """Yield the datasets that were understood."""
    for each in read:
        if isinstance(each, Mapping) and "type" in each:
            yield each


def _fits(function: Dataset, unit: str) -> bool:
    """Whether a function is in the unit, over orders, positions or angles."""
    known = _OF_TYPE.get(int(function["ordinate_spec_data_type"]), ("",))
    over = function["abscissa_spec_data_type"] == ORDER or _label(function).startswith(("position", "angle"))
    return known[0] == unit and over


def _label(function: Dataset) -> str:
    """Return the label of the abscissa."""
    return str(function["abscissa_axis_lab"]).strip().lower()


def _values(function: Dataset, scale: Dataset) -> FloatArray:
    """Return the ordinate in its unit: a file's value over the factors of its units is SI."""
    _, per_si, (length, force) = _OF_TYPE[int(function["ordinate_spec_data_type"])]
    own = float(scale.get("length", 1.0)) ** length * float(scale.get("force", 1.0)) ** force
    return np.asarray(function["data"]) * (per_si / own)
