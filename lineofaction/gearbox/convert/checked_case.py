"""Cases with the checks that a schema cannot do: feasibility and predicted cost."""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from bounds import warn_of
from bounds.types import Json
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import THICK, analysis_options, case_json, gear_pair, table_axes
from lineofaction.gearbox.schemas.case import Case

if TYPE_CHECKING:
    from fe_contact.analysis.request.request import Checked

Inputs = TypeVar("Inputs")
Requested = TypeVar("Requested")


@dataclass(frozen=True)
class CheckedCase:
    """A case on its way to the contact solver: converted once and checked once, each when first needed."""

    case: Case
    _requests: dict[Any, tuple[Any, Any]] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def pair(self) -> ParallelAxes:
        """The gear pair of the case, as `gear_pair` returns it."""
        return gear_pair(self.case)

    @cached_property
    def axes(self) -> TableAxes:
        """The axes of the case's table, as `table_axes` returns them."""
        return table_axes(self.case)

    @cached_property
    def options(self) -> AnalysisOptions:
        """The analysis options of the case, as `analysis_options` returns them."""
        return analysis_options(self.case)

    @property
    def converted(self) -> tuple[ParallelAxes, TableAxes, AnalysisOptions]:
        """Pair, axes and options, as the library takes them."""
        return self.pair, self.axes, self.options

    @cached_property
    def feasible(self) -> Checked:
        """The request with all its effects; refusals on submission come from here. Raises `BadInput`."""
        return self._checked(neglect=False)

    @cached_property
    def checked(self) -> Checked:
        """The request as it is solved, without the effects that its tolerance does not need."""
        from fe_contact.analysis.request.request_check import neglecting  # noqa: PLC0415 (start-up time)

        if "feasible" not in self.__dict__:
            return self._checked()
        with boundary_errors():
            return neglecting(self.feasible)

    @cached_property
    def at_point(self) -> Checked:
        """The request of the case's one load and one alignment: its table may be of any size."""
        return self._checked(check_size=False, neglect=False)

    def _checked(self, *, check_size: bool = True, neglect: bool = True) -> Checked:
        from fe_contact.analysis.request.request_check import check_request  # noqa: PLC0415 (start-up time)

        converted = self.converted
        with boundary_errors():
            return check_request(*converted, check_size=check_size, neglect=neglect)

    def request(self, make: Callable[[CheckedCase, Inputs], Requested], inputs: Inputs) -> Requested:
        """Return the request of a study to the library, made once for its check and for its work.

        Raises `BadInput`.
        """
        known = self._requests.get(make)
        if known is None or known[0] != inputs:
            with boundary_errors():
                known = inputs, make(self, inputs)
            self._requests[make] = known
        made: Requested = known[1]
        return made


def across_face(case: CheckedCase) -> CheckedCase:
    """Return a case in three dimensions."""
    across = case.case.accuracy.model_copy(update={"model": "3d"})
    return CheckedCase(case.case.model_copy(update={"accuracy": across}))


class CheckedCases:
    """The cases of a scene, or the last ones of a process; equal ones are converted and checked once."""

    def __init__(self, maximum: int = 256) -> None:
        self._maximum, self._cases = maximum, OrderedDict[str, CheckedCase]()

    def of(self, case: Case) -> CheckedCase:
        """Return a validated case."""
        return self._of(case_json(case), lambda: case)

    def of_json(self, inputs: Json) -> CheckedCase:
        """Return a normalized case, which is validated unless an equal one is stored."""
        return self._of(inputs, lambda: Case.model_validate_json(json.dumps(inputs)))

    def _of(self, inputs: Json, case: Callable[[], Case]) -> CheckedCase:
        name = json.dumps(inputs, sort_keys=True)
        checked = self._cases.get(name)
        if checked is None:
            checked = self._cases[name] = CheckedCase(case())
            while len(self._cases) > self._maximum:
                self._cases.popitem(last=False)
        return checked


def check_case(case: Case) -> ParallelAxes:
    """Return the pair of a case that can be computed.

    Raises `BadInput`: no such pair, or a request that no plan can meet.
    """
    return CheckedCase(case).feasible.request.pair


def check_plain_case(case: Case) -> ParallelAxes:
    """Return the pair of a case of loads alone, as `check_case` does, without modules that compute.

    Such a case has default accuracy and effects, one alignment and equal teeth. It is refused for its loads,
    or for a disc that is too thin: only thin discs take the full check.
    """
    pair = gear_pair(case)
    for gear in (pair.pinion, pair.wheel):
        if gear.face_width * THICK < abs(gear.root_radius - gear.seat_radius):
            return check_case(case)
    with boundary_errors():
        axes = table_axes(case)
        load = axes.load(pair)
        alignments = axes.misalignment, axes.center_distance_change
        warn_of(pair_findings(pair, load, *alignments, loads_as=axes.loads_as))
    return pair
