"""Check of the reading of a curve file: printed slopes, forms and pitches are compared to recomputed ones.

Without printed values the tips of both flanks decide: material is missing there, never in excess.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import Toothing
from lineofaction.gearbox.inspection.machine_file import (
    MATERIAL,
    MachineFile,
    PitchTable,
    Trace,
    place,
    places,
    trace_range,
)
from lineofaction.gearbox.inspection.machine_heading import Conventions
from lineofaction.gearbox.inspection.machine_values import Printed
from lineofaction.gearbox.inspection.sheet import Flank

LIMIT_UM = 0.1
"""Largest difference between a printed value and the recomputed one."""
HELIX_SIGN: dict[Flank, int] = {"left": 1, "right": -1}
"""Sign of f_Hbeta of a lead whose material rises upwards: a right-hand helix is positive (line 165, DIN)."""
_FIGURES = {"profile": ("fHa", "ffa", "Fa"), "helix": ("fHb", "ffb", "Fb")}
_SYMBOLS = {"fHa": "f_Halpha", "ffa": "f_falpha", "Fa": "F_alpha", "fHb": "f_Hbeta", "ffb": "f_fbeta"}
_SYMBOLS |= {"Fb": "F_beta", "fp max": "largest f_p", "fu max": "largest f_u", "Rp": "R_p", "Fp": "F_p"}
_SYMBOLS |= {"Fpz/8": "F_pz/8", "Fr": "F_r"}
_CLEAR_UM, _TIP_POINTS = 1.0, 3
"""Fall of a tip from which it counts, and points at the end of a trace over which it is averaged."""
_ROUNDING = 1e-9
"""Rounding of a difference, um, and of the ends of a range, m."""
Key = tuple[str, Flank | None, int]


@dataclass(frozen=True)
class Judgement:
    """Number of printed values that are recomputed, and those that differ."""

    recomputed: int
    differences: tuple[str, ...]


def judgement_of(file: MachineFile, gear: Toothing, printed: Iterable[Printed] = ()) -> Judgement:
    """Judge the reading of a file by the results that the machine printed of the same gear.

    Raises `ValueError`: nothing is printed of its profiles, and the tips show that their sign is wrong.
    """
    computed = dict(results(file, gear))
    recomputed = 0
    judged_flanks = set()
    differences = []
    for entry in (*file.printed, *printed):
        result = computed.get((entry.figure, entry.flank, entry.tooth))
        if result is None:
            continue
        recomputed += 1
        if entry.figure == "fHa":
            judged_flanks.add(entry.flank)
        if abs(entry.value - result) > LIMIT_UM + _ROUNDING:
            differences.append(_difference(entry, result))
    for table in file.tables:
        differences += _unequal_columns(table)
    differences += _tips(file, gear, judged_flanks)
    return Judgement(recomputed, tuple(differences))


def evaluated(trace: Trace, conventions: Conventions, gear: Toothing) -> tuple[float, float, float]:
    """Return slope, form and total deviation of a trace as the machine prints them, um.

    Raises `ValueError`: too few points.
    """
    ends, coordinate = trace_range(trace, conventions), places(trace, conventions, gear)
    first, last = (place(trace.kind, end, gear) for end in (ends.first, ends.last))
    in_range = (coordinate >= first - _ROUNDING) & (coordinate <= last + _ROUNDING)
    inside = in_range & (trace.values != conventions.undefined)
    values = trace.values[inside]
    if values.size < 3:
        bound = "a file of traces measured where they are evaluated"
        raise ValueError(f"{bound}; that of line {trace.line} is not")
    slope, mean = np.polyfit(coordinate[inside] - first, values, 1)
    rest = values - mean - slope * (coordinate[inside] - first)
    length, sign = last - first, MATERIAL[trace.flank]
    if trace.kind == "helix":
        length, sign = coordinate[-1] - coordinate[0], sign * HELIX_SIGN[trace.flank]
    return float(sign * slope * length), float(np.ptp(rest)), float(np.ptp(values))


def results(file: MachineFile, gear: Toothing) -> Iterator[tuple[Key, float]]:
    """Yield each result that is recomputed, by its figure, flank and tooth, in um."""
    for trace in file.traces:
        if trace.kind is not None:
            figures = zip(_FIGURES[trace.kind], evaluated(trace, file.conventions, gear), strict=True)
            yield from (((figure, trace.flank, trace.tooth), value) for figure, value in figures)
    for table in file.tables:
        single, cumulative, run_out = table.values.T
        yield ("fp max", table.flank, 0), float(np.abs(single).max())
        yield ("fu max", table.flank, 0), float(np.abs(single - np.roll(single, 1)).max())
        yield ("Rp", table.flank, 0), float(np.ptp(single))
        yield ("Fp", table.flank, 0), float(np.ptp(np.append(cumulative, 0.0)))
        eighth = int(cumulative.size / 8.0 + 0.5)  # of the teeth, rounded half up
        yield ("Fpz/8", table.flank, 0), float(np.abs(np.roll(cumulative, -eighth) - cumulative).max())
        yield ("Fr", None, 0), float(np.ptp(run_out))


def _difference(printed: Printed, value: float) -> str:
    tooth = f" of tooth {printed.tooth}" if printed.tooth else ""
    label = f"{_SYMBOLS[printed.figure]}{tooth}{f' {printed.flank}' if printed.flank else ''}"
    return f"{label}: {printed.value:.1f} µm printed, {value:.1f} µm recomputed"


def _unequal_columns(table: PitchTable) -> Iterator[str]:
    """Yield the rows whose single pitch is not the step of the cumulative one."""
    single, cumulative, _ = table.values.T
    steps = np.diff(cumulative, prepend=cumulative[-1])
    for row in np.flatnonzero(np.abs(steps - single) > LIMIT_UM):
        yield (
            f"f_p of tooth {row + 1} {table.flank}: {single[row]:.1f} µm printed, {steps[row]:.1f} µm by F_p "
            f"(line {table.lines[row]})"
        )


def _tips(file: MachineFile, gear: Toothing, judged_flanks: set[Flank | None]) -> list[str]:
    """Judge the sign of profiles by their tips where no slope is printed."""
    unsure = []
    for flank in MATERIAL:
        traces = [trace for trace in file.traces if (trace.kind, trace.flank) == ("profile", flank)]
        if flank in judged_flanks or not traces:
            continue
        falls = [_fall(trace, file.conventions, gear) for trace in traces]
        if max(falls) > _CLEAR_UM:
            raise ValueError(
                f"a file whose tips fall off on both flanks; those of {flank} profiles rise by "
                f"{max(falls):.1f} µm, and no printed value shows their sign"
            )
        if min(falls) > -_CLEAR_UM:
            unsure.append(f"the sign of {flank} profiles: no value is printed, and no tip falls off")
    return unsure


def _fall(trace: Trace, conventions: Conventions, gear: Toothing) -> float:
    """Return how far the end of a profile is above the mean line of the evaluated range, um of material."""
    ends, coordinate = trace_range(trace, conventions), places(trace, conventions, gear)
    first, last = (place("profile", end, gear) for end in (ends.first, ends.last))
    measured = trace.values != conventions.undefined
    inside = measured & (coordinate >= first) & (coordinate <= last)
    if inside.sum() < _TIP_POINTS:
        return 0.0
    # the evaluated range ends before a tip relief, so that a line fits it
    line = np.polyfit(coordinate[inside], trace.values[inside], 1)
    tip = np.flatnonzero(measured)[-_TIP_POINTS:]
    rise = np.mean(trace.values[tip] - np.polyval(line, coordinate[tip]))
    return float(MATERIAL[trace.flank] * rise)
