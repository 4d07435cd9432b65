"""From a case to a gear pair and the arguments of `fe_contact.analyze`, and whether it can be computed."""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from bounds import inside, warn_of
from bounds.types import Json
from fe_contact.allowed_error import AllowedError
from fe_contact.errors import FeContactError
from fe_contact.flank.stated_start import StatedStarts
from fe_contact.geometry import (
    FlankModification,
    Gear,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    PitchDeviation,
    RingGear,
    Shaft,
    Toothing,
)
from fe_contact.geometry.flank_tolerances import NO_CLEARANCE, MisalignmentRange, misalignment_range
from fe_contact.material import Material
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.declared import in_si, part_of
from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case, ErrorsInput, LoadInput
from lineofaction.gearbox.schemas.gear import FlankPoint, ToothingInput
from lineofaction.gearbox.units import MM, NM, UM
from model_studies.workers import WorkersLost

if TYPE_CHECKING:
    from fe_contact.analysis.request.request import Checked

Toothed = TypeVar("Toothed", bound=Toothing)
Inputs = TypeVar("Inputs")
Requested = TypeVar("Requested")
THICK = 10.0
"""Face widths from bore to root up to which `check_request` refuses no disc: rounding leaves less than a
tenth of what it allows."""
PLANE = ("plane_strain", "plane_stress")
"""Models that a case may state, and that have no misalignment."""


def gear_pair(case: Case) -> ParallelAxes:
    """Return the gear pair of a case, an `InternalGearPair` if its wheel is a ring gear.

    Raises `BadInput`: no such pair exists; named by the case's fields, in its units.
    """
    with boundary_errors():
        pinion = _gear(Gear, "pinion", case)
        first = part_of(Shaft, case.pair.pinion.shaft, "pinion.shaft")
        shafts = (first, part_of(Shaft, case.pair.wheel.shaft, "wheel.shaft"))
        facts = in_si(GearPair, case.pair)
        if case.pair.wheel.internal:
            return InternalGearPair(pinion, _gear(RingGear, "wheel", case), shafts=shafts, **facts)
        return GearPair(pinion, _gear(Gear, "wheel", case), shafts=shafts, **facts)


@contextmanager
def boundary_errors(prefix: str = "") -> Iterator[None]:
    """Turn errors of the libraries into the boundary's."""
    try:
        yield
    except (FeContactError, WorkersLost) as error:
        known = translated(error)
        if isinstance(known, BadInput) and prefix:
            known = known.within(prefix)
        raise known or error from None


def _gear(kind: type[Toothed], name: str, case: Case) -> Toothed:
    """One gear of the pair; mating external ones have opposite hands."""
    gear: ToothingInput = getattr(case.pair, name)
    hand = -kind.sign if name == "wheel" else 1
    with inside(name):
        facts = in_si(kind, gear, case.pair)
        facts |= {
            "helix_angle": hand * facts["helix_angle"] + 0.0,  # -0.0 becomes 0.0
            "material": Material(**in_si(Material, gear.material or case.material)),
            "pitch_deviation": _pitch_deviation(gear),
        }
        return kind(**facts, modification=_modification(gear, lambda: kind(**facts)))


def _modification(gear: ToothingInput, plain: Callable[[], Toothing]) -> FlankModification:
    """Return the modification of a gear; `plain` makes the gear without it."""
    facts, starts = in_si(FlankModification, gear), StatedStarts(**in_si(StatedStarts, gear))
    return FlankModification(**facts | starts.lengths(facts, plain))


def _pitch_deviation(gear: ToothingInput) -> PitchDeviation:
    """Return the deviations that a gear states as cumulative or as single ones."""
    if gear.single_pitch_deviation_um:
        return PitchDeviation.of_single_pitches([value * UM for value in gear.single_pitch_deviation_um])
    return PitchDeviation(tuple(value * UM for value in gear.pitch_deviation_um))


def table_axes(case: Case) -> TableAxes:
    """Return what the table of a case is computed over, in SI."""
    load, errors, allowed = case.load, case.errors, allowed_misalignment(case)
    with boundary_errors():
        return TableAxes(
            load.torque_n_m,
            load.normal_force_n,
            tuple(value * UM for value in errors.misalignment_um) if allowed is None else allowed.axis,
            tuple(value * MM for value in errors.center_distance_change_mm),
            case.accuracy.pitches,
        )


def allowed_misalignment(case: Case) -> MisalignmentRange | None:
    """Return the range that a class allows; None where the case states its misalignments.

    Raises `BadInput`: no such pair exists, or it is beyond the standards.
    """
    errors = case.errors
    if errors.misalignment_class is None:
        return None
    first, second = errors.bearing_clearance_um or NO_CLEARANCE
    pair = gear_pair(case)
    with boundary_errors():
        return misalignment_range(pair, errors.misalignment_class, (first * UM, second * UM))


def analysis_options(case: Case) -> AnalysisOptions:
    """Return accuracy, model and effects of a case, in SI."""
    accuracy = case.accuracy
    with boundary_errors():
        relative, floor = accuracy.tolerance, accuracy.tolerance_floor_nm * NM
        allowed = None if relative is None else AllowedError(relative, floor)
        converted = {"tolerance": allowed, "effects": dict(case.effects)}
        return AnalysisOptions(**in_si(AnalysisOptions, accuracy) | converted)


def study_options(options: AnalysisOptions) -> AnalysisOptions:
    """Return the options of a case for a study, which measures its errors and repeats what it must."""
    return replace(options, receipt="full", on_violation="repeat")


def case_at(case: Case, point: FlankPoint) -> Case:
    """Return the case with the one load and the one alignment of a point.

    What the point leaves open is the case's highest load, and its deviations nearest to zero.
    """
    load, errors = case.load, case.errors
    if point.torque_n_m is not None:
        load = LoadInput(torque_n_m=(point.torque_n_m,))
    elif point.normal_force_n is not None:
        load = LoadInput(normal_force_n=(point.normal_force_n,))
    elif load.torque_n_m is not None:
        load = LoadInput(torque_n_m=load.torque_n_m[-1:])
    elif load.normal_force_n is not None:
        load = LoadInput(normal_force_n=load.normal_force_n[-1:])
    skew, change = point.misalignment_um, point.center_distance_change_mm
    here = ErrorsInput(
        misalignment_um=(min(errors.misalignment_um, key=abs) if skew is None else skew,),
        center_distance_change_mm=(
            min(errors.center_distance_change_mm, key=abs) if change is None else change,
        ),
    )
    accuracy = case.accuracy.model_copy(update={"positions": None})  # a cycle is always the same 64
    return case.model_copy(update={"load": load, "errors": here, "accuracy": accuracy})


def operating_point(case: Case) -> OperatingPoint:
    """Return the first load and the first alignment of a case, in SI."""
    load, errors = case.load, case.errors
    return OperatingPoint(
        None if load.torque_n_m is None else load.torque_n_m[0],
        None if load.normal_force_n is None else load.normal_force_n[0],
        errors.misalignment_um[0] * UM,
        errors.center_distance_change_mm[0] * MM,
    )


def case_json(case: Case) -> Json:
    """Return the case with all defaults, as JSON: what is hashed and echoed."""
    return case.model_dump(mode="json")


def case_as_filed(case: Case) -> Json:
    """Return the case with its title block, on which no result depends: what a file has."""
    block = {} if case.report is None else {"report": case.report.model_dump(mode="json")}
    return case_json(case) | block


# Whether a case can be computed: what a schema cannot check and a request can afford.


@dataclass(frozen=True)
class CheckedCase:
    """A case on its way to the contact solver: converted once and checked once, each when first needed.

    A process makes one of the validated model and hands it on. A worker is another process: it reads the
    stored inputs once, and makes its own.
    """

    case: Case
    _requests: dict[Any, tuple[Any, Any]] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def pair(self) -> ParallelAxes:
        """As `gear_pair`."""
        return gear_pair(self.case)

    @cached_property
    def axes(self) -> TableAxes:
        """As `table_axes`."""
        return table_axes(self.case)

    @cached_property
    def options(self) -> AnalysisOptions:
        """As `analysis_options`."""
        return analysis_options(self.case)

    @property
    def converted(self) -> tuple[ParallelAxes, TableAxes, AnalysisOptions]:
        """All three, as the library takes them."""
        return self.pair, self.axes, self.options

    @cached_property
    def feasible(self) -> Checked:
        """The request with all its effects: what is refused on submission. Raises `BadInput`."""
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
        return self._checked(whole_table=False, neglect=False)

    def _checked(self, *, whole_table: bool = True, neglect: bool = True) -> Checked:
        from fe_contact.analysis.request.request_check import check_request  # noqa: PLC0415 (start-up time)

        converted = self.converted
        with boundary_errors():
            return check_request(*converted, whole_table=whole_table, neglect=neglect)

    def request(self, make: Callable[[CheckedCase, Inputs], Requested], inputs: Inputs) -> Requested:
        """Return what a study requests of the library: made once, for its check and for its work.

        Raises `BadInput`.
        """
        known = self._requests.get(make)
        if known is None or known[0] != inputs:
            with boundary_errors():
                known = self._requests[make] = inputs, make(self, inputs)
        made: Requested = known[1]
        return made


def across_face(checked: CheckedCase) -> CheckedCase:
    """Return a case in three dimensions."""
    across = checked.case.accuracy.model_copy(update={"model": "3d"})
    return CheckedCase(checked.case.model_copy(update={"accuracy": across}))


class CheckedCases:
    """The cases of a scene, or the last ones of a process; equal ones are converted and checked once."""

    def __init__(self, most: int = 256) -> None:
        self._most, self._kept = most, OrderedDict[str, CheckedCase]()

    def of(self, case: Case) -> CheckedCase:
        """Return a validated case."""
        return self._of(case_json(case), lambda: case)

    def of_json(self, inputs: Json) -> CheckedCase:
        """Return a normalized case; one that is not kept is validated."""
        return self._of(inputs, lambda: Case.model_validate_json(json.dumps(inputs)))

    def _of(self, inputs: Json, case: Callable[[], Case]) -> CheckedCase:
        name = json.dumps(inputs, sort_keys=True)
        checked = self._kept.get(name)
        if checked is None:
            checked = self._kept[name] = CheckedCase(case())
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        return checked


def check_case(case: Case) -> ParallelAxes:
    """Return the pair of a case that can be computed.

    Raises `BadInput`: no such pair, or a request that no plan can meet.
    """
    return CheckedCase(case).feasible.request.pair


def check_plain_case(case: Case) -> ParallelAxes:
    """Return the pair of a case of loads alone, as `check_case` does, without what computes.

    A case with default accuracy and effects, one alignment and equal teeth is refused for its loads, or for
    a disc that is too thin; whether one may be is decided here.
    """
    pair = gear_pair(case)
    if any(
        gear.face_width * THICK < abs(gear.root_radius - gear.held_radius)
        for gear in (pair.pinion, pair.wheel)
    ):
        return check_case(case)
    with boundary_errors():
        axes = table_axes(case)
        load = axes.load(pair)
        alignments = axes.misalignment, axes.center_distance_change
        warn_of(pair_findings(pair, load, *alignments, loads_as=axes.loads_as))
    return pair
