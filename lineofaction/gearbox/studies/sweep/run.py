"""A sweep of a case, and its figures in the units of the boundary.

A sweep computes quantities, such as peak-to-peak STE, at the points of a grid of one or two axes: torque,
alignment or figures of the flanks. The boundary are case files and JSON, with units in the names.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from bounds import Kind
from bounds.brief import brief
from bounds.types import Json
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.flank.modification import FlankModification
from fe_contact.microgeometry.sweep import Sweep, SweptQuantity, sweep
from fe_contact.microgeometry.sweep_request import CENTER_DISTANCE, TORQUE, SweepAxis, SweepRequest
from fe_contact.microgeometry.variables import GEARS, figure
from fe_contact.types import BoolArray, FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import case_at, operating_point
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.studies.computation import CaseStudy, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.sweep import Inputs, SweepFigures
from lineofaction.gearbox.units import UM, factor, unit_name
from model_studies.result_record import ResultRecord

STEPS = 9
"""Values of an axis whose range is not given."""
_MIN_TORQUES = 3  # least number of torques of a case that is swept as it is
_SKEW_UM, _DISTANCE = 30.0, 0.002  # usual misalignment, um; usual change over the center distance
_LEAST_TORQUE = 0.2  # first torque of a usual axis over the last one
_FIGURES = figures(FlankModification, Kind.AMOUNT, Kind.DEVIATION, Kind.LENGTH)
"""Figures of a flank that can be swept."""


@dataclass(frozen=True)
class _Swept:
    """A variable of a case that can be swept."""

    name: str
    """Name of the `SweepAxis`."""
    path: str
    """Path of the field in the case file; ``*`` stands for both gears."""
    description: str
    what: Figure | None = None
    """Declaration of the figure of the flanks; None for torque, misalignment and center distance."""

    @property
    def unit(self) -> str:
        """Symbol of the unit of the boundary."""
        return unit_name(self.path) or "N m"

    @property
    def factor(self) -> float:
        """The SI value of one unit."""
        return factor(self.path)

    @property
    def label(self) -> str:
        """Description with the unit, as on an axis."""
        return f"{self.description}, {self.unit}"

    @property
    def spellings(self) -> set[str]:
        """The accepted names: the path, its last parts, and both without the unit."""
        names = self.path.split(".")
        # of a figure of one gear the name of the gear is needed too
        minimum = 2 if self.what is not None and "*" not in names else 1
        tails = {".".join(names[-count:]) for count in range(minimum, len(names) + 1)}
        last = self.name.rpartition(".")[2]
        heads = [tail.rpartition(".")[:2] for tail in tails]
        return tails | {f"{head}{dot}{last}" for head, dot in heads}


def _of_gear(gear: str, what: Figure) -> _Swept:
    """Return the variable of a figure of one gear's flanks."""
    return _Swept(f"{gear}.{what.name}", f"pair.{gear}.{what.field}", f"{what.label} of the {gear}", what)


CONDITIONS = (
    _Swept(TORQUE, "load.torque_n_m", "torque on the driving gear"),
    _Swept("misalignment", "errors.misalignment_um", "misalignment"),
    _Swept(CENTER_DISTANCE, "errors.center_distance_change_mm", "change of the center distance"),
)
SWEEPABLE = {
    swept.name: swept
    for swept in (
        *CONDITIONS,
        *(_Swept(f.name, f"pair.*.{f.field}", f"{f.label} of both gears", f) for f in _FIGURES),
        *(_of_gear(gear, figure) for gear in GEARS for figure in _FIGURES),
    )
}
"""Variables by the name of their `SweepAxis`."""


def axis_of_text(case: CheckedCase, text: str) -> SweepAxis:
    """Return the axis of the text ``NAME`` or ``NAME=FIRST:LAST:STEP``.

    Raises `BadInput`: an unknown name, or values that are invalid or do not increase.
    """
    typed, equals, values = text.partition("=")
    swept = _named_variable(text, typed.strip())
    numbers = number_list(f"over {typed.strip()}", values) if equals else _usual(case, swept)
    if any(later <= earlier for earlier, later in pairwise(numbers)):
        raise BadInput.of("over", text, "over increasing values", "For example torque=50:300:50.")
    return SweepAxis(swept.name, tuple(value * swept.factor for value in numbers))


def _named_variable(text: str, name: str) -> _Swept:
    for swept in SWEEPABLE.values():
        if name in swept.spellings:
            return swept
    short = [swept.name for swept in SWEEPABLE.values()]
    close = difflib.get_close_matches(name[:64], short, n=3, cutoff=0.5)
    remedy = f"Did you mean {' or '.join(close)}?" if close else f"For example {', '.join(short[:4])}."
    bound = "the torque, the alignment or a flank modification of a case"
    raise BadInput.of("over", text, f"{bound}; other bodies need tables of their own", remedy)


def _usual(checked: CheckedCase, swept: _Swept) -> list[float]:
    """Return the values of an axis that was given by its name alone, in the unit of the boundary."""
    pair, case = checked.pair, checked.case
    if swept.what is not None:  # about the case's own values, or about a usual one where it has none
        variables = SweepAxis(swept.name, ()).variables
        declared = swept.what.what
        reference_value = max(abs(figure(pair, name)) for name in variables) or float(declared.example)
        size = swept.what.boundary_value(reference_value)
        if declared.kind is Kind.LENGTH:
            return _even_values(0.5 * size, 1.5 * size)
        return _even_values(-2.0 * size if declared.kind is Kind.DEVIATION else 0.0, 2.0 * size)
    if swept.name == TORQUE:
        forces = case.load.normal_force_n or ()
        loads = case.load.torque_n_m or [float(pair.torque(force)) for force in forces]
        return (
            list(loads) if len(loads) >= _MIN_TORQUES else _even_values(_LEAST_TORQUE * loads[-1], loads[-1])
        )
    if swept.name == CENTER_DISTANCE:
        changes = case.errors.center_distance_change_mm
        maximum = _DISTANCE * pair.center_distance / swept.factor
        return list(changes) if len(changes) > 1 else _even_values(0.0, maximum)
    maximum = max(map(abs, case.errors.misalignment_um)) or _SKEW_UM
    return _even_values(-maximum, maximum)


def _even_values(first: float, last: float) -> list[float]:
    """Return `STEPS` evenly spaced values, rounded to six digits."""
    return [float(f"{value:.6g}") for value in np.linspace(first, last, STEPS)]


@dataclass(frozen=True)
class _Quantity:
    """A quantity at the boundary."""

    description: str
    unit: str
    """`description`, `unit`: Description and unit as plots show them."""
    one: float
    """The SI value of one unit."""
    field: str
    """Name of the field in JSON and CSV; ``{}`` stands where the name of the error has ``_error``."""

    @property
    def label(self) -> str:
        """The words with the unit, as on an axis."""
        return f"{self.description}, {self.unit}" if self.unit else self.description


QUANTITIES = {
    "peak_to_peak": _Quantity("peak-to-peak STE", "µm", UM, "peak_to_peak{}_um"),
    **{
        f"harmonic_{n}": _Quantity(f"mesh harmonic {n} of STE", "µm", UM, f"harmonic_{n}{{}}_um")
        for n in (1, 2, 3)
    },
    "max_pressure": _Quantity("largest flank pressure", "MPa", 1e6, "max_pressure{}_mpa"),
    "face_load_factor": _Quantity("K_Hbeta of the cycle", "", 1.0, "k_h_beta{}"),
}
"""Quantities by their name in `fe_contact.microgeometry.sweep.SWEPT`."""


@brief
@dataclass(frozen=True)
class SweepResult(ResultRecord):
    """A sweep, and the quantities that are shown."""

    sweep: Sweep
    shown: tuple[str, ...]
    """Names of `QUANTITIES`, of which the sweep has values."""

    @property
    def axes(self) -> tuple[_Swept, ...]:
        """The swept variables."""
        return tuple(SWEEPABLE[name] for name in self.sweep.axes)

    @property
    def across(self) -> int:
        """The axis that runs across in plots and tables: the torque if it is swept, else the first."""
        return self.sweep.axes.index(TORQUE) if TORQUE in self.sweep.axes else 0

    @property
    def quantities(self) -> tuple[SweptQuantity, ...]:
        """The quantities that are shown, in their order."""
        by_name = {quantity.name: quantity for quantity in self.sweep.quantities}
        return tuple(by_name[name] for name in self.shown)

    def grid(self, values: Any) -> Any:
        """Return values (N,) as a grid (down, across); unchanged if there is one axis."""
        grid = values.reshape(self.sweep.shape)
        return np.asarray(grid.T if grid.ndim == 2 and self.across == 0 else grid)

    def like_least(self, quantity: SweptQuantity) -> BoolArray:
        """Return the points of the grid that cannot be told from the lowest one within both errors.

        In a map over the torque each point is compared with the lowest one at the same torque.
        """
        value, error = self.grid(quantity.value), self.grid(quantity.error)
        if value.ndim != 2 or TORQUE not in self.sweep.axes:
            return np.asarray(self.grid(quantity.like_least))
        rows = np.where(np.isnan(value), np.inf, value).argmin(axis=0)
        columns = np.arange(value.shape[1])
        return np.asarray(value - value[rows, columns] <= error + error[rows, columns])

    def levels(self, axis: int) -> FloatArray:
        """Return the values of an axis in the unit of the boundary, increasing."""
        return np.unique(self.sweep.point[:, axis]) / self.axes[axis].factor


class _SweepStudy(CaseStudy[Inputs, SweepFigures, SweepResult]):
    inputs, answer, file = Inputs, SweepFigures, record_file(("sweep", SweepResult))
    resumed = True

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        with boundary_errors():
            _ = case.request(_request, inputs).checked

    def predicted(self, case: CheckedCase, inputs: Inputs, cache: Path | None) -> StudyCost:
        """Return the cost of the bodies and of every design at all torques."""
        with boundary_errors():
            request = case.request(_request, inputs)
            predicted = predicted_designs(request.checked, cache)
        designs = Work("designs", predicted.design, len(request.designs), "contact")
        return StudyCost((Work("gears", predicted.all_bodies, 1.0, "compliance"), designs), predicted.bytes)

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> SweepResult:
        """Sweep a case; an unswept load is the highest, an unswept deviation the nearest to zero."""
        with boundary_errors():
            result = sweep(case.request(_request, inputs), means.analysis)
        known = {quantity.name for quantity in result.quantities}
        return SweepResult(result, tuple(name for name in inputs.show if name in known))

    def _derived(self, result: SweepResult) -> Json:
        swept = result.sweep
        return {
            "over": [(axis, {"values": result.levels(k)}) for k, axis in enumerate(result.axes)],
            "held": {_field(name): value / SWEEPABLE[name].factor for name, value in swept.held.items()},
            "points": [_at(result, k) | _figures(swept, k) for k, why in enumerate(swept.reason) if not why],
            "least": {
                QUANTITIES[quantity.name].field.format(""): _at(result, quantity.minimum)
                | {"points_within_error": int(quantity.like_least.sum())}
                for quantity in swept.quantities
                if swept.usable
            },
            "failed": [_at(result, k) | {"reason": why} for k, why in enumerate(swept.reason) if why],
        }

    def failure(self, result: SweepResult) -> str:
        return "" if result.sweep.usable else f"No point has figures: {result.sweep.reason[0]}."


def _request(case: CheckedCase, inputs: Inputs) -> SweepRequest:
    axes = tuple(axis_of_text(case, text) for text in inputs.over)
    point = operating_point(case_at(case.case, FlankPoint()))
    return SweepRequest(case.pair, axes, point, case.options)


def _field(name: str) -> str:
    """Return the field in the case file of a variable that is not swept."""
    return SWEEPABLE[name].path.rpartition(".")[2]


def _at(result: SweepResult, point: int) -> Json:
    """Return the place of a point by the paths of the axes."""
    place = zip(result.axes, result.sweep.point[point], strict=True)
    return {axis.path: float(f"{value / axis.factor:.12g}") for axis, value in place}


def _figures(swept: Sweep, point: int) -> Json:
    figures = {}
    for quantity in swept.quantities:
        shown = QUANTITIES[quantity.name]
        figures[shown.field.format("")] = float(quantity.value[point]) / shown.one
        figures[shown.field.format("_error")] = float(quantity.error[point]) / shown.one
    return figures


RUN = _SweepStudy()
