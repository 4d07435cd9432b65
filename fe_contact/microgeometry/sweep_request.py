"""The request of a sweep: one or two axes over operating conditions and figures of the flanks.

A figure of the flanks is one quantity of the modification of one gear, such as ``pinion.tip_relief``. A
design is one combination of the values on all axes but the torque.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.errors import InputError, increasing
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.variables import GEARS, DesignVariable, check_variables, modified
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from fe_contact.types import FloatArray

TORQUE, CENTER_DISTANCE = "torque", "center_distance_change"

CONDITIONS = (TORQUE, MISALIGNMENT, CENTER_DISTANCE)
"""Operating conditions that a sweep can vary."""

MAX_POINTS = 4096
"""Largest number of combinations of the values on the axes."""

Values = Mapping[str, float]
"""Values of a design by the name of the axis, m."""


@dataclass(frozen=True)
class SweepAxis:
    """An axis of a sweep."""

    name: str
    """One of `CONDITIONS`, a design variable ``gear.quantity``, or ``quantity`` alone: both gears alike."""
    values: tuple[float, ...]
    """Values on the axis, N m or m, increasing, at least two."""

    @property
    def variables(self) -> tuple[str, ...]:
        """Figures of the flanks that the axis sets, ``gear.quantity``."""
        if self.name in CONDITIONS:
            return ()
        return (self.name,) if "." in self.name else tuple(f"{gear}.{self.name}" for gear in GEARS)

    @property
    def largest(self) -> float:
        """Value on the axis whose magnitude is largest."""
        return max(self.values, key=abs)


@dataclass(frozen=True)
class SweepRequest:
    """A gear pair, and the axes of its sweep."""

    pair: ParallelAxes
    """Gear pair. Its modifications hold where they are not swept."""
    axes: tuple[SweepAxis, ...]
    """One or two axes of the sweep."""
    point: OperatingPoint
    """Operating point; it holds where it is not swept."""
    options: AnalysisOptions = AnalysisOptions()  # noqa: RUF009 (frozen)
    """Options of the analysis; `positions`, `receipt` and `on_violation` are ignored. Model and mesh are
    chosen once, for the values that act most.
    """

    @property
    def torques(self) -> FloatArray:
        """Torques (L,) at which every design is solved at once, N m."""
        axis = next((axis for axis in self.axes if axis.name == TORQUE), None)
        point = self.point
        torque = point.torque if point.torque is not None else self.pair.torque(point.normal_force or 0.0)
        return np.array([torque] if axis is None else axis.values, dtype=np.float64)

    @property
    def designs(self) -> tuple[dict[str, float], ...]:
        """Every combination of the values of the other axes by name, those of the first slowest."""
        others = [axis for axis in self.axes if axis.name != TORQUE]
        names = [axis.name for axis in others]
        combinations = product(*(axis.values for axis in others))
        return tuple(dict(zip(names, values, strict=True)) for values in combinations)

    def flanks(self, design: Values) -> ParallelAxes:
        """Return the pair with the flanks of a design."""
        figures: dict[str, float] = {}
        for axis in self.axes:
            if axis.name in design:
                figures |= dict.fromkeys(axis.variables, design[axis.name])
        return modified(self.pair, figures)

    def alignment(self, design: Values) -> tuple[float, float]:
        """Return misalignment and change of the center distance of a design, m."""
        misalignment, change = self.point.misalignment, self.point.center_distance_change
        return design.get(MISALIGNMENT, misalignment), design.get(CENTER_DISTANCE, change)

    @cached_property
    def checked(self) -> Checked:
        """The checked request of one design: every axis but the torque at its value of largest magnitude.

        All designs are checked; nothing is computed.

        Raises `InputError`: no axis, more than two, or one twice; too many points; a value cannot be used.
        """
        self._check_axes()
        variables: list[DesignVariable] = []
        for axis in self.axes:
            low, high = axis.values[0], axis.values[-1]
            variables += [DesignVariable(name, low, high) for name in axis.variables]
        if variables:
            check_variables(self.pair, variables)
        for design in self.designs:
            self.flanks(design)  # raises where a modification does not fit its gear
        largest = {axis.name: axis.largest for axis in self.axes}
        swept = {axis.name: axis.values for axis in self.axes}
        axes = TableAxes(
            self.torques,
            misalignments=swept.get(MISALIGNMENT, (self.point.misalignment,)),
            center_distance_changes=swept.get(CENTER_DISTANCE, (self.point.center_distance_change,)),
        )
        # as the documentation of `options` says, the choices of the caller for these three are ignored
        options = replace(self.options, positions=None, receipt="full", on_violation="report")
        # no table is stored, so its size has no limit; all designs have the same effects
        return check_request(self.flanks(largest), axes, options, check_size=False, neglect=False)

    def _check_axes(self) -> None:
        names = [axis.name for axis in self.axes]
        if not 1 <= len(names) <= 2:
            raise InputError("axes", names, "one or two")
        varied = [name for axis in self.axes for name in axis.variables or (axis.name,)]
        for name in varied:
            if varied.count(name) > 1:
                raise InputError("axes", name, "varied by one axis")
        for axis in self.axes:
            if increasing(f"axes.{axis.name}", axis.values).size < 2:
                raise InputError(f"axes.{axis.name}", list(axis.values), "at least two values")
        points = int(np.prod([len(axis.values) for axis in self.axes]))
        if points > MAX_POINTS:
            raise InputError("axes", points, f"at most {MAX_POINTS} points", "Take larger steps.")
