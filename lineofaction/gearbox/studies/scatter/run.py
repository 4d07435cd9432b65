"""Tolerance Monte Carlo of a case: its request, its predicted cost, and what a drawing and a limit mean."""

from __future__ import annotations

import difflib
import re
from dataclasses import replace
from pathlib import Path

from bounds import Kind
from bounds.types import Json
from fe_contact.analysis.run_plan import predicted_designs, table_seconds
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.drawn_teeth import ToothTolerances, iso1328_tooth_tolerances
from fe_contact.microgeometry.measured_tolerances import measured_tolerances
from fe_contact.microgeometry.order_limit import OrderLimit
from fe_contact.microgeometry.tolerance_study import (
    Sampling,
    ToleranceRequest,
    ToleranceStudy,
    WithinClass,
    sampled,
)
from fe_contact.microgeometry.tolerances import Tolerances, iso1328_tolerances
from fe_contact.microgeometry.variables import ACROSS_FACE, GEARS, figure
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.convert.case import PLANE
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.model import Row
from lineofaction.gearbox.studies.computation import CaseStudy, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.scatter import Drawn, Inputs, ScatterFigures, ToleranceInputs
from lineofaction.gearbox.units import UM, factor, in_um

ONE_ALIGNMENT = 1, 1
"""Numbers of misalignments and of center distances of the table at the end, which is of the nominal pair."""
_TANGENT = 0.6
"""CPU time of the tangent about a pair over that of its solution: 0.5 to 0.7 over the face, 1 in a plane."""
_DRAWN_FLANKS = 1.5
"""CPU time of the contact of flanks with drawn slopes and forms over that of other flanks, over the face.

Of a spur pair 20/20 it was 1.6, of a helical one 23/67 1.8, in the plane 0.9. The load of the host is in it.
"""
_ADDED = 1e-9
"""CPU seconds to add one deviation at one point by a tangent."""
_DRAWN_TEETH = 2.2
"""CPU time of a pitch between teeth with drawn deviations over the time of a pitch of a table. Slopes and
forms of drawn teeth change the contact.

Measured: 2.1 and 2.4 for the revolutions of a hobbed helical pair 23/67, 2.3 for a spur pair 19/28 in the
plane.
"""
MAX_SAMPLES = 100_000
"""Most samples of a job: its result holds every pair, 10 to 100 MB."""

_TOLERATED = {
    f"{gear}.{figure.field}": f"{gear}.{figure.name}"
    for gear in GEARS
    for figure in figures(FlankModification, Kind.AMOUNT, Kind.DEVIATION, Kind.LENGTH)
}
"""Figures of the case file that a drawing may bound, by their names in the library."""
# mesh order, sign, gear and number of its turns: "2", "mesh 2 - pinion 3", "pinion"
_ORDER = re.compile(r"(?:mesh )?(\d{1,6})?\s*(?:([+-])?\s*\b(pinion|wheel)\b\s*(\d{1,6})?)?")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_UNITS = {"um": UM, "µm": UM, "μm": UM, "nm": 1e-3 * UM}
_MEASURED = "For example wheel.profile_slope_um=-11.5/3.9."
_LIMITS = "For example 1=0.5um, 2=-12dB, 1-pinion=80nm, pinion 3=0.2um."


class _ScatterStudy(CaseStudy[Inputs, ScatterFigures, ToleranceStudy]):
    inputs, answer, file = Inputs, ScatterFigures, record_file(("tolerance study", ToleranceStudy))

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        with boundary_errors():
            _ = case.request(scatter_request, inputs).checked

    def normalized(self, case: CheckedCase, inputs: Inputs) -> Json:
        """Return all inputs; refuse a sample too large for a job."""
        if inputs.samples > MAX_SAMPLES:
            remedy = "For more use loa scatter."
            raise BadInput.of("samples", inputs.samples, f"at most {MAX_SAMPLES}", remedy)
        return super().normalized(case, inputs)

    def predicted(self, case: CheckedCase, inputs: Inputs, cache: Path | None) -> StudyCost:
        """Return the cost of bodies, pairs analyzed in full, the model of the others, and the table."""
        with boundary_errors():
            request = case.request(scatter_request, inputs)
            predicted = predicted_designs(request.checked, cache)
            table = table_seconds(request.checked, request.pair, ONE_ALIGNMENT, cache)
        sampling = request.sampling
        # measured pairs are compared to pairs of the class
        solved = (sampling.solved + _TANGENT * sampling.tangents) * (2 if inputs.population else 1)
        work, loads = predicted.work, len(request.torques)
        pair = work.of_flanks(sampling.positions, loads) * (_DRAWN_FLANKS if predicted.across_face else 1.0)
        points = sampling.positions * loads * sampling.tangents * len(request.tolerances.widths)
        parts = [
            Work("gears", predicted.bodies, stage="compliance"),
            Work("compliance", work.of(sampling.positions, 0), stage="first order"),  # all pairs share it
            Work("tangent", pair, 1.0 + _TANGENT, "first order"),
            Work("pairs", pair, solved, "samples"),
            Work("samples", _ADDED * points, sampling.samples, "confirmation"),
            Work("coarse gears", predicted.coarse_bodies, stage="confirmation"),
            Work("table", table, stage="confirmation"),
        ]
        if request.teeth is not None:
            revolution = work.in_pitches(sampling.positions, (loads,), request.teeth.teeth)
            parts.append(Work("revolutions", _DRAWN_TEETH * revolution, sampling.solved, "sidebands"))
        return StudyCost(tuple(parts), predicted.bytes)

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> ToleranceStudy:
        """Sample the pairs of a case; in a plane model helix slopes do not deviate."""
        with boundary_errors():
            run = means.analysis
            study = sampled(case.request(scatter_request, inputs), run)
            if not inputs.population:
                return study
            of_class = inputs.model_copy(update={"population": ()})
            within_class = WithinClass.of(sampled(case.request(scatter_request, of_class), run))
            return replace(study, within_class=within_class)

    def _derived(self, study: ToleranceStudy) -> Json:
        widths = study.request["tolerances"]
        tolerances = {
            "misalignment_um": widths["misalignment_m"] / UM,
            **{boundary_name(name): width / UM for name, width in widths["modification_m"].items()},
            "distribution": widths["distribution"],
        }
        return {
            "names": [boundary_name(name) for name in study.names],
            "asked": in_um(study.request) | {"tolerances": tolerances},
        }


def scatter_request(case: CheckedCase, inputs: Inputs) -> ToleranceRequest:
    """Return the study of a case: tolerances, number of pairs solved without tangents, and limit."""
    request = tolerance_request(case, inputs)
    sampling = replace(request.sampling, exact=inputs.exact)
    limit = None if inputs.limit is None else order_limit(inputs.limit)
    teeth = None if limit is None or not limit.gear else _teeth(case, inputs, limit.gear)
    request = replace(request, sampling=sampling, limit=limit, teeth=teeth)
    return _measured_request(request, case, inputs.population) if inputs.population else request


def _measured_request(request: ToleranceRequest, case: CheckedCase, rows: Row[Drawn]) -> ToleranceRequest:
    """Return the request with figures of measured gears; in the plane helices do not deviate."""
    mean: dict[str, float] = {}
    deviation: dict[str, float] = {}
    correlation: dict[tuple[str, str], float] = {}
    for text in rows:
        names, values = _population_row(text)
        across_face = any(name.partition(".")[2] in ACROSS_FACE for name in names)
        if across_face and case.case.accuracy.model in PLANE:
            continue
        if len(names) == 2:
            correlation[names[0], names[1]] = values[0]
        else:
            (name,) = names
            mean[name] = values[0] - figure(request.pair, name)
            deviation[name] = values[1]
    return replace(request, tolerances=measured_tolerances(request.tolerances, mean, deviation, correlation))


def _population_row(text: str) -> tuple[list[str], list[float]]:
    """Return figure, mean and deviation in m that a row says, or two figures and their correlation."""
    left, _, right = text.partition("=")
    names = [name.strip() for name in left.split("*")]
    values = [value.strip() for value in right.split("/")]
    if unknown := [name for name in names if name not in _TOLERATED]:
        raise _unknown_figure("population", text, unknown[0], _MEASURED)
    numbers = all(_NUMBER.fullmatch(value) for value in values)
    is_row = (len(names), len(values)) in ((1, 2), (2, 1))
    if not numbers or not is_row or (len(values) == 2 and values[1][0] == "-"):
        forms = (
            "GEAR.FIGURE=MEAN/DEVIATION, a deviation of 0 or above, or GEAR.FIGURE*GEAR.FIGURE=CORRELATION"
        )
        raise BadInput.of("population", text, forms, _MEASURED)
    unit = factor(names[0]) if len(names) == 1 else 1.0
    return [_TOLERATED[name] for name in names], [float(value) * unit for value in values]


def _teeth(case: CheckedCase, inputs: Inputs, gear: str) -> ToothTolerances:
    """Return the tolerances of the differences between the teeth of a gear of the class."""
    return iso1328_tooth_tolerances(
        case.pair,
        gear,
        inputs.tolerance_class,
        across_face=case.case.accuracy.model not in PLANE,
        distribution=inputs.distribution,
        finishing=inputs.finishing,
    )


def tolerance_request(checked: CheckedCase, inputs: ToleranceInputs) -> ToleranceRequest:
    """Return the pair of a case with the tolerances of its class, in a plane without those of helices."""
    pair, case, load = checked.pair, checked.case, checked.case.load
    tolerances = tolerances_of(pair, inputs, across_face=case.accuracy.model not in PLANE)
    torques = load.torque_n_m or [float(pair.torque(force)) for force in load.normal_force_n or ()]
    sampling, misalignment = Sampling(inputs.samples, inputs.seed), case.errors.misalignment_um[0] * UM
    return ToleranceRequest(pair, list(torques), tolerances, sampling, checked.options, misalignment)


def tolerances_of(pair: ParallelAxes, inputs: ToleranceInputs, *, across_face: bool) -> Tolerances:
    """Return the tolerances of a class, overridden by those of a drawing."""
    of_class = iso1328_tolerances(
        pair,
        inputs.tolerance_class,
        misalignment=inputs.misalignment_um * UM,
        across_face=across_face,
        distribution=inputs.distribution,
        finishing=inputs.finishing,
    )
    of_drawing = dict(map(_drawing_tolerance, inputs.drawing))
    return replace(of_class, modification={**of_class.modification, **of_drawing})


def _drawing_tolerance(text: str) -> tuple[str, float]:
    """Return name and tolerance in m of a flank's figure from ``GEAR.FIGURE=VALUE`` of a drawing."""
    name, _, value = (part.strip() for part in text.partition("="))
    if name not in _TOLERATED:
        raise _unknown_figure("drawing", text, name, "For example pinion.profile_slope_um=4.")
    if not _NUMBER.fullmatch(value) or float(value) <= 0.0:
        bound = f"{name}= and a tolerance above 0 in the unit of the name"
        raise BadInput.of("drawing", text, bound, f"For example {name}=4.")
    return _TOLERATED[name], float(value) * factor(name)


def _unknown_figure(field: str, text: str, name: str, example: str) -> BadInput:
    close = difflib.get_close_matches(name[:64], _TOLERATED, n=3, cutoff=0.5)
    remedy = f"Did you mean {' or '.join(close)}?" if close else example
    return BadInput.of(field, text, "pinion or wheel, a dot, and a figure of the flanks", remedy)


def order_limit(text: str) -> OrderLimit:
    """Return the limit that ``ORDER=VALUE`` with a unit states."""
    order, _, value = (part.strip() for part in text.partition("="))
    number = value.rstrip("µμumndBb ")  # without the letters of all units
    unit = value.removeprefix(number).strip()
    named = _ORDER.fullmatch(order)
    if named is None or not (int(named[1] or 0) or named[3]):
        raise BadInput.of("limit", text, "a mesh order, turns of a gear beside it, =, an amplitude", _LIMITS)
    if not _NUMBER.fullmatch(number):
        raise BadInput.of("limit", text, "an order, =, and a number with its unit", _LIMITS)
    mesh, sign, gear, turns = named.groups()
    if unit.lower() == "db":
        amplitude = UM * 10.0 ** (min(float(number), 200.0) / 20.0)
    elif unit in _UNITS:
        amplitude = _UNITS[unit] * float(number)
    else:
        raise BadInput.of("limit", text, "an amplitude in um, nm or dB re 1 um", _LIMITS)
    if amplitude <= 0.0:
        raise BadInput.of("limit", text, "an amplitude above 0", _LIMITS)
    sideband = int(turns or 1) * (-1 if sign == "-" else 1) if gear else 0
    return OrderLimit(int(mesh or 0), amplitude, gear or "", sideband)


RUN = _ScatterStudy()
