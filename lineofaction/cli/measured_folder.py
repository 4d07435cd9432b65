"""``loa measured`` of a folder: the population of its gears, for a tolerance study."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bounds import engineering
from bounds.error_digits import with_error
from bounds.types import Json
from lineofaction.cli.output import console, print_json, print_written, table
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.inspection.as_made import Inspected
from lineofaction.gearbox.inspection.measured_gear import Chart
from lineofaction.gearbox.inspection.population import (
    InspectedGear,
    Population,
    gear_files,
    inspected_gear,
    population,
)
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.units import UM

_OF_A_CASE = {"profile_slope": -1, "profile_form": 1, "helix_slope": -1, "helix_form": 1}
"""Sign of the traits of measured gears that are also flank figures of a case, so that a study can vary them.

A slope of a case removes material where a deviation is in excess.
"""
_SIGNIFICANT = 2.0
"""Correlations of fewer standard errors than this are not stated: they may be chance."""
_LONGEST = 300
"""Most characters of a warning about a file."""
_COMPONENTS = 4
"""Principal components whose share of the variance is printed."""


def run_folder(case: Case, folder: Path, of: Inspected, output: Path | None, *, as_json: bool) -> None:
    """Print the population of the gears in a folder, and write it as JSON."""
    gears = _gears(folder, of.chart(case), of.cutoff_mm)
    people = population(gears, str(folder))
    incomplete = [
        f"{gear.name}: not all of {', '.join(people.names)}"
        for gear in gears
        if gear.name not in people.gears
    ]
    warn(omission_warnings(incomplete, "population"))
    answer = _as_json(people, of.gear)
    written = [] if output is None else [output]
    for path in written:
        path.write_text(json.dumps(answer, allow_nan=False) + "\n", encoding="utf-8")
    if as_json:
        print_json(answer | {"written": [str(path) for path in written]})
        return
    _show(people, answer)
    print_written(written)


def _gears(folder: Path, chart: Chart, cutoff_mm: float | None) -> list[InspectedGear]:
    """Return the gears of a folder; a file that cannot be read, or differs from its printed values, warns."""
    gears, omissions = [], []
    for path in gear_files(folder):
        try:
            gear = inspected_gear(path, chart, None if cutoff_mm is None else cutoff_mm * 1e-3)
        except BadInput as error:
            omissions.append(f"{path.name}: {error.faults[0].bound}"[:_LONGEST])
            continue
        if gear.differences:
            omissions.append(f"{path.name}: {gear.differences[0]}; {len(gear.differences)} such values")
            continue
        gears.append(gear)
    warn(omission_warnings(omissions, "population"))
    return gears


def _as_json(people: Population, gear: str) -> Json:
    between, within = (np.sqrt(np.diag(matrix)) / UM for matrix in (people.between, people.within))
    traces = {
        kind: {
            "number": traces.number,
            "mean_um": (traces.mean / UM).tolist(),
            "components_um": (traces.components / UM).tolist(),
            "share": traces.share.tolist(),
        }
        for kind, traces in people.traces.items()
    }
    return {
        "gears": list(people.gears),
        "teeth": people.teeth,
        "traits": list(people.names),
        "mean_um": (people.mean / UM).tolist(),
        "mean_error_um": (people.mean_error / UM).tolist(),
        "between_gears_um": between.tolist(),
        "between_gears_error_um": (people.spread_error / UM).tolist(),
        "between_teeth_um": within.tolist(),
        "common": people.common.tolist(),
        "correlation": people.correlation.tolist(),
        "pitches_um": {name: (values / UM).tolist() for name, values in people.pitches.items()},
        "traces": traces,
        "population": list(_rows(people, gear)),
    }


def _rows(people: Population, gear: str) -> Iterator[str]:
    """Yield the population as options of a tolerance study.

    ``GEAR.TRAIT_um=MEAN/DEVIATION`` has mean and standard deviation between gears, ``TRAIT*TRAIT=VALUE`` a
    correlation.
    """
    names = [name for name in people.names if name in _OF_A_CASE]
    at = [people.names.index(name) for name in names]
    for name, k in zip(names, at, strict=True):
        mean, spread = _OF_A_CASE[name] * people.mean[k] / UM, np.sqrt(people.between[k, k]) / UM
        yield f"{gear}.{name}_um={mean:.3f}/{spread:.3f}"
    for i, later in enumerate(names):
        for j, earlier in list(enumerate(names))[:i]:
            correlation = _OF_A_CASE[later] * _OF_A_CASE[earlier] * people.correlation[at[i], at[j]]
            if abs(correlation) > _SIGNIFICANT / np.sqrt(len(people.gears) - 1.0):
                yield f"{gear}.{earlier}_um*{gear}.{later}_um={correlation:.2f}"


def _show(people: Population, answer: Json) -> None:
    out = console()
    known = (("mean_um", "mean_error_um"), ("between_gears_um", "between_gears_error_um"))
    with_errors = [list(map(with_error, answer[value], answer[error])) for value, error in known]
    plain = [[engineering(value, 3) for value in answer[key]] for key in ("between_teeth_um", "common")]
    rows = list(zip(people.names, *with_errors, *plain, strict=True))
    title = (
        f"{len(people.gears)} gears, {people.teeth} teeth: gears by the mean of their teeth, teeth about it"
    )
    head = ("trait", "mean, µm", "gears, µm (1 s)", "teeth, µm (1 s)", "common")
    out.print(table(head, rows, title, ("trait",)))
    if people.pitches:
        pitches = [
            (name, str(values.size), engineering(values.mean() / UM, 3), engineering(values.max() / UM, 3))
            for name, values in people.pitches.items()
        ]
        out.print(table(("pitches", "gears", "mean, µm", "largest, µm"), pitches, "", ("pitches",)))
    for kind, traces in people.traces.items():
        shares = ", ".join(f"{100.0 * share:.3g} %" for share in traces.share[:_COMPONENTS])
        out.print(
            f"{traces.number} traces of the {kind}: principal components with {shares} of the variance."
        )
    out.print(f"For loa scatter: --population '{','.join(answer['population'])}'", soft_wrap=True)
