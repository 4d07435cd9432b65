"""Measurements read and aligned, and differences from them."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bounds.error_digits import error_text, to_error, with_error
from fe_contact.types import Estimate
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import FloatArray, Table, number

COLORS = palette.DESIGNS
"""Colors of the first result and of the second."""

POSITIONS = ("position", "angle_deg")
ORDERS = ("mesh_order", "order")
"""Names of the first column: base pitches, degrees of the driving gear; mesh orders, orders of its shaft."""
VALUES = {  # units by the name of the second column
    "transmission_error_um": "µm",
    "amplitude_um": "µm",
    "amplitude_n": "N",
    "amplitude_m_per_s2": "m/s²",
}
PER_PITCH = 256  # values of an averaged ripple in a base pitch
NEAR = 0.1  # distance from an order within which a line belongs to it, in orders
_FEWEST = 8  # samples in a base pitch
_REMEDY = (
    "The first line names two columns: position (base pitches) or angle_deg (of the driving gear) and "
    "transmission_error_um; or mesh_order or order (of the driving shaft) and amplitude_um, amplitude_n or "
    "amplitude_m_per_s2."
)


@dataclass(frozen=True)
class Difference:
    """A number of two results: its name, its load or speed, and both values in the unit of the report."""

    name: str
    where: str
    first: Estimate
    second: Estimate

    @property
    def value(self) -> float:
        """Second less first."""
        return self.second.value - self.first.value

    @property
    def error(self) -> float:
        """Root of the sum of both errors squared, which are independent; NaN where one is not stated."""
        return math.hypot(self.first.error, self.second.error)

    @property
    def is_significant(self) -> bool:
        """Whether the difference is larger than its error."""
        return abs(self.value) > self.error

    @property
    def finding(self) -> str:
        """The conclusion in words."""
        if math.isnan(self.error):
            return "no error stated"
        if not self.is_significant:
            return "not shown to differ"
        return "the second is larger" if self.value > 0.0 else "the second is smaller"

    def __str__(self) -> str:
        """Return the difference with its error and its verdict as text."""
        return f"{self.written}: {self.finding}"

    @property
    def between(self) -> str:
        """Text of both values and their difference; a signed number alone would read as a value."""
        before, after = (number(estimate.value, 3) for estimate in (self.first, self.second))
        return f"{before} to {after} {self.first.unit}, by {self._bare}"

    @property
    def written(self) -> str:
        """Text of the difference with its error, both to the last significant digit."""
        return f"{self._bare} {self.first.unit}"

    @property
    def _bare(self) -> str:
        """Text of the difference with its error, without the unit."""
        if math.isnan(self.error):
            return number(self.value, 3)
        return f"{to_error(self.value, self.error, '+')} ± {error_text(self.value, self.error)}"


def differences_table(differences: Sequence[Difference], names: Sequence[str]) -> Table:
    """Tabulate differences, each with its verdict."""
    rows = tuple(
        (item.name, item.where, _estimate(item.first), _estimate(item.second), item.written, item.finding)
        for item in differences
    )
    head = ("quantity", "at", *names, "second less first", "finding")
    return Table("Differences with their errors", head, rows)


def changed_fields(cases: Mapping[str, Mapping[str, Any]]) -> Table:
    """Tabulate the fields of two cases or scenes, by their names, that are not equal."""
    flat = [dict(_flat(case)) for case in cases.values()]
    fields = dict.fromkeys(field for case in flat for field in case)
    rows = tuple(
        (field, *(_text(case.get(field)) for case in flat))
        for field in fields
        if any(case.get(field) != flat[0].get(field) for case in flat)
    )
    return Table("Fields that differ", ("field", *cases), rows)


def _flat(content: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value with its path; lists of numbers stay whole."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _flat(value, f"{path}.{key}" if path else str(key))
    elif isinstance(content, list) and any(isinstance(value, Mapping | list) for value in content):
        for index, value in enumerate(content):
            name = value.get("name", index) if isinstance(value, Mapping) else index
            yield from _flat(value, f"{path}[{name}]")
    else:
        yield path, content


def _text(value: Any) -> str:
    """Write a value of a field; one that is not there is left out."""
    if isinstance(value, float):
        return f"{value:g}"
    return "" if value is None else str(value)


def _estimate(value: Estimate) -> str:
    if math.isnan(value.error):
        return f"{number(value.value, 4)} {value.unit}"
    return with_error(value.value, value.error, value.unit)


@dataclass(frozen=True)
class MeasuredCurve:
    """A measured transmission error, averaged over its base pitches."""

    ripple: FloatArray
    """Mean of all base pitches at equal steps from position 0, less its own mean, µm. Shape (PER_PITCH,)."""
    spread: float
    """Standard deviation of single base pitches from `ripple`, µm: pitch errors, run-out and noise."""
    pitches: int
    """Number of base pitches."""


@dataclass(frozen=True)
class MeasuredOrders:
    """A measured order spectrum: mesh orders (K,) and amplitudes (K,) in `unit`."""

    order: FloatArray
    amplitude: FloatArray
    unit: str

    def require(self, unit: str) -> None:
        """Refuse amplitudes in another unit."""
        if self.unit != unit:
            raise BadInput.of("measured", f"amplitudes in {self.unit}", f"amplitudes in {unit}")

    def near(self, order: float) -> float:
        """Return the largest line within a tenth of an order; NaN if there is none."""
        lines = self.amplitude[np.abs(self.order - order) <= NEAR]
        return float(lines.max()) if lines.size else float("nan")


def read_measured(path: Path, teeth: int) -> MeasuredCurve | MeasuredOrders:
    """Read a CSV file with a line of names; `teeth` are the driving gear's.

    Raises `BadInput`: the columns are not known, a cell is no number, or less than one base pitch is sampled.
    """
    names, rows = _rows(path)
    if len(names) != 2 or names[0] not in (*POSITIONS, *ORDERS) or names[1] not in VALUES:
        raise BadInput.of("measured", ", ".join(names), "columns of a known name", _REMEDY)
    abscissa, values = rows.T
    if names[0] in ORDERS:
        mesh = abscissa if names[0] == "mesh_order" else abscissa / teeth
        return MeasuredOrders(mesh, values, VALUES[names[1]])
    if names[1] != "transmission_error_um":
        raise BadInput.of("measured", names[1], '"transmission_error_um" over a position', _REMEDY)
    position = abscissa if names[0] == "position" else abscissa * teeth / 360.0
    return averaged(path, position, values)


def _rows(path: Path) -> tuple[list[str], FloatArray]:
    """Return the names and the numbers (n, 2) of a file."""
    if not path.is_file():
        raise BadInput.of("measured", str(path), "a CSV file", "Check the path.")
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
        names = [name.strip() for name in lines[0]]
        rows = np.array([[float(cell) for cell in line] for line in lines[1:]])
    except (ValueError, IndexError):
        raise BadInput.of("measured", str(path), "a line of names, then numbers", _REMEDY) from None
    if rows.ndim != 2 or not np.all(np.isfinite(rows)):
        raise BadInput.of("measured", str(path), "as many finite numbers in each line as names", _REMEDY)
    return names, rows


def averaged(path: Path, position: FloatArray, values: FloatArray) -> MeasuredCurve:
    """Average the whole base pitches of a curve over positions (n,) in base pitches, values (n,) in µm.

    Raises `BadInput`: less than one base pitch is sampled, or too roughly; `path` is named.
    """
    order = np.argsort(position, kind="stable")
    position, values = position[order], values[order]
    pitches = int(np.floor(position[-1] - position[0]))
    if pitches < 1 or position.size < _FEWEST * (position[-1] - position[0]):
        bound = f"at least one base pitch with {_FEWEST} samples in each"
        sampled = f"{position.size} samples over {position[-1] - position[0]:.3g} base pitches"
        raise BadInput.of("measured", sampled, bound, f"Check the first column of {path}.")
    grid = np.ceil(position[0] * PER_PITCH) + np.arange(pitches * PER_PITCH)
    folded = np.interp(grid / PER_PITCH, position, values).reshape(pitches, PER_PITCH)
    folded = np.roll(folded, int(grid[0]) % PER_PITCH, axis=1)  # the first column at a whole base pitch
    single = folded - folded.mean(axis=1, keepdims=True)
    ripple = single.mean(axis=0)
    spread = float(np.sqrt(np.mean((single - ripple) ** 2)))
    return MeasuredCurve(ripple, spread, pitches)


@dataclass(frozen=True)
class Aligned:
    """A measured curve shifted onto a computed one."""

    measured: MeasuredCurve
    ripple: FloatArray
    """Measured ripple after the shift, from position 0, µm. Shape (PER_PITCH,)."""
    shift: float
    """Shift towards larger positions, base pitches in [0, 1)."""
    rms: float
    """Root mean square of the difference of both curves after the shift, µm."""
    correlation: float
    """Correlation of both curves after the shift."""


def aligned_to(curve: MeasuredCurve, computed: FloatArray) -> Aligned:
    """Shift a measured ripple to where its circular correlation with `computed` (PER_PITCH,), µm, is largest.

    The shift must be found, because the zero of a measured position is that of an encoder.
    """
    target = computed - computed.mean()
    correlations = np.fft.irfft(np.fft.rfft(target) * np.conj(np.fft.rfft(curve.ripple)), PER_PITCH)
    steps = int(np.argmax(correlations))
    ripple = np.roll(curve.ripple, steps)
    sizes = float(np.linalg.norm(ripple) * np.linalg.norm(target))
    return Aligned(
        curve,
        ripple,
        shift=steps / PER_PITCH,
        rms=float(np.sqrt(np.mean((ripple - target) ** 2))),
        correlation=float(np.dot(ripple, target)) / sizes if sizes > 0.0 else 0.0,
    )
