"""Deviations of a gear in a case from the sheet of an inspection, and a sheet from deviations.

A sheet has traces of tooth flanks, each a list of points: "profile" along the roll length, "helix" along the
face, "topography" over both, and pitch deviations of one point per tooth.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.inspection.evaluation import Split, split
from lineofaction.gearbox.inspection.reading import FIELD, REMEDY
from lineofaction.gearbox.inspection.sheet import OMITTED, PITCHES, Flank, Interval, Point, Sheet
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, UM

OTHER_FLANK = f"{OMITTED}not the loaded flank"
_AXES = ("roll_length_mm", "face_position_mm")
_LISTED = 61
"""Number of points of a trace that is written."""
_ROUNDING = 1e-9
"""Distance, m, by which a point may lie beyond the usable flank: sheets round their coordinates."""


@dataclass(frozen=True)
class Chart:
    """Map from the numbers of teeth on an inspection sheet to their sequence in mesh.

    A sheet numbers teeth clockwise as seen on the datum face. The right flank is on the right of a tooth
    whose tip points up. The right flank of an external gear faces clockwise. A driving gear turns towards the
    side that its loaded flank faces, a driven gear away from that side. The next teeth in mesh come from
    behind.
    """

    gear: Toothing
    loaded: Flank
    drives: bool

    @property
    def facing(self) -> int:
        """1 if the loaded flanks face clockwise, else -1."""
        return (1 if self.loaded == "right" else -1) * self.gear.sign

    def meshing(self, tooth: int) -> int:
        """Return the number from 1, in the order of meshing, of a tooth numbered as on the sheet.

        Tooth 1 is the first in both. The map is its own inverse: it also gives the number on the sheet of a
        tooth numbered in the order of meshing.
        """
        step = -self.facing if self.drives else self.facing
        return (tooth - 1) * step % self.gear.teeth + 1


@dataclass(frozen=True)
class MeasuredGear:
    """Deviations of a gear as a case has them, and the use of every line of the sheet."""

    fields: Mapping[str, Any]
    """Fields of the gear's table in the case."""
    account: Mapping[str, int]
    """Number of lines by their use: the trace that a line belongs to, or the reason why it is left out."""
    splits: Mapping[tuple[int, str], Split]
    """Evaluated traces by tooth of the sheet and trace."""
    recomputed: int = 0
    differences: tuple[str, ...] = ()
    ranged: bool = False
    """`recomputed`, `differences`, `ranged`: Number of values printed by the machine that are recomputed;
    those that differ; and whether the file states where traces are evaluated.
    """

    @property
    def omitted(self) -> list[str]:
        """Return which points of the loaded flanks are left out."""
        counts = (
            (use.removeprefix(OMITTED), count)
            for use, count in self.account.items()
            if use.startswith(OMITTED) and use != OTHER_FLANK
        )
        return [f"{why} (points: {count})" for why, count in counts]


def measured_gear(
    sheet: Sheet, chart: Chart, name: str, cutoff: float | None = None, *, mean_of_others: bool = False
) -> MeasuredGear:
    """Return the deviations of the loaded flanks of the gear `name` that a sheet states.

    `cutoff` is the wavelength of the filter of traces, m; None: the default of `split`. Teeth that were not
    measured are as designed or, with `mean_of_others`, the mean of those that were. Raises `BadInput`: some
    teeth lack a pitch deviation, pitches are stated in both forms, or a trace cannot be evaluated.
    """
    account = Counter(sheet.account)
    traces: dict[tuple[int, str], list[Point]] = defaultdict(list)
    over_flank = {point.tooth for point in sheet.points if _use(point, chart) == "topography"}
    for point in sheet.points:
        use = _use(point, chart)
        if use in ("profile", "helix") and point.tooth in over_flank:
            use = f"{OMITTED}the tooth has a topography"
        account[use] += 1
        if not use.startswith(OMITTED):
            traces[point.tooth, point.trace].append(point)
    try:
        pitches = _pitches(traces, chart)
        splits = dict(_splits(traces, sheet.intervals, chart.loaded, cutoff))
        surfaces = {tooth: _surface(traces[tooth, "topography"]) for tooth in over_flank}
        teeth = sorted({tooth for tooth, _ in splits} | over_flank)
        flanks = [_flank(tooth, splits, surfaces, chart) for tooth in teeth]
        fields = (
            _about_mean(flanks) if mean_of_others and flanks else {"tooth_flanks": flanks} if flanks else {}
        )
    except ValueError as fault:
        raise BadInput.of(FIELD, name, str(fault), REMEDY) from None
    if flanks:
        fields["tooth_flanks"].sort(key=lambda flank: int(flank["tooth"]))
    return MeasuredGear(
        fields | pitches,
        dict(account),
        splits,
        recomputed=sheet.recomputed,
        differences=sheet.differences,
        ranged=bool(sheet.intervals),
    )


def _use(point: Point, chart: Chart) -> str:
    """Return the trace that a point belongs to, or why it is left out."""
    gear = chart.gear
    if point.flank != chart.loaded:
        return OTHER_FLANK
    ends = sorted((gear.form_roll_length, gear.tip_roll_length))
    if point.roll is not None and not ends[0] - _ROUNDING <= point.roll <= ends[1] + _ROUNDING:
        return f"{OMITTED}beyond the usable profile"
    if point.face is not None and abs(point.face) > 0.5 * gear.face_width + _ROUNDING:
        return f"{OMITTED}beyond the face width"
    return point.trace


def _pitches(traces: Mapping[tuple[int, str], list[Point]], chart: Chart) -> dict[str, list[float]]:
    names = {name for _, name in traces if name in PITCHES}
    if not names:
        return {}
    if len(names) > 1:
        raise ValueError("single or cumulative pitch deviations, not both")
    (name,) = names  # the only one
    teeth = chart.gear.teeth
    missing = [tooth for tooth in range(1, teeth + 1) if not traces.get((tooth, name))]
    if missing:
        raise ValueError(
            f"{name} of all {teeth} teeth; {len(missing)} are missing, the first is {missing[0]}"
        )
    values = np.array([traces[tooth, name][0].deviation for tooth in range(1, teeth + 1)])
    if name == "pitch":  # single pitch deviations; their sum around the gear closes
        values = np.cumsum(values - values.mean())
    order = [chart.meshing(tooth) - 1 for tooth in range(1, teeth + 1)]
    return {"pitch_deviation_um": _um(chart.facing * values[order])}


def _splits(
    traces: Mapping[tuple[int, str], list[Point]],
    intervals: Mapping[tuple[str, Flank], Interval],
    flank: Flank,
    cutoff: float | None,
) -> Iterator[tuple[tuple[int, str], Split]]:
    for (tooth, name), points in sorted(traces.items()):
        if name not in ("profile", "helix"):
            continue
        rows = np.array(sorted((_coordinate(point), point.deviation) for point in points))
        try:
            yield (tooth, name), split(rows[:, 0], rows[:, 1], cutoff, intervals.get((name, flank)))
        except ValueError as fault:
            raise ValueError(f"{fault} ({name} of tooth {tooth})") from None


def _coordinate(point: Point) -> float:
    coordinate = point.roll if point.trace == "profile" else point.face
    assert coordinate is not None
    return coordinate


def _surface(points: list[Point]) -> dict[str, Any]:
    """Return the flank grid of a topography."""
    nodes = {(point.roll or 0.0, point.face or 0.0): point.deviation for point in points}
    rolls, faces = (sorted({node[axis] for node in nodes}) for axis in (0, 1))
    if len(nodes) != len(rolls) * len(faces):
        missing = len(rolls) * len(faces) - len(nodes)
        raise ValueError(f"topographies on a whole grid; tooth {points[0].tooth} lacks {missing} points")
    return _grid(np.array(rolls), np.array(faces), np.array([[nodes[r, f] for f in faces] for r in rolls]))


def _flank(
    tooth: int, splits: Mapping[tuple[int, str], Split], surfaces: Mapping[int, dict[str, Any]], chart: Chart
) -> dict[str, Any]:
    """Return the entry of a tooth: slopes over the whole flank, and the rest of its traces as a grid."""
    entry: dict[str, Any] = {"tooth": chart.meshing(tooth)}
    if tooth in surfaces:
        return entry | {"flank_grid": surfaces[tooth]}
    gear = chart.gear
    form, tip, half = gear.form_roll_length, gear.tip_roll_length, 0.5 * gear.face_width
    # length of the whole flank along each trace, and its ends
    over = {"profile": (tip - form, np.sort([form, tip])), "helix": (2.0 * half, np.array([-half, half]))}
    coordinates, rests = [], []
    for name, (length, ends) in over.items():
        trace = splits.get((tooth, name))
        coordinates.append(ends if trace is None else trace.coordinate)
        rests.append(np.zeros(2) if trace is None else trace.rest)
        if trace is not None:
            (entry[f"{name}_slope_um"],) = _um(np.array([trace.slope / trace.length * length]))
    roll_length, face = coordinates
    return entry | {"flank_grid": _grid(roll_length, face, np.add.outer(rests[0], rests[1]))}


def _about_mean(flanks: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the mean of the flanks as that of all teeth, and the flanks of single teeth about it.

    A slope of all teeth removes where that of a tooth is in excess.
    """
    slopes = [name for name in flanks[0] if name.endswith("_slope_um")]
    kinds = {(*flank, str([flank["flank_grid"][axis] for axis in _AXES])) for flank in flanks}
    if len(kinds) > 1:
        raise ValueError("traces of the same kinds at the same places on every tooth, for their mean")
    removed = np.array([flank["flank_grid"]["removed_um"] for flank in flanks])
    mean = {name: float(np.mean([flank[name] for flank in flanks])) for name in slopes}
    teeth = [
        {"tooth": flank["tooth"], **{name: round(flank[name] - mean[name], 5) + 0.0 for name in slopes}}
        | {"flank_grid": flank["flank_grid"] | {"removed_um": np.round(part, 5).tolist()}}
        for flank, part in zip(flanks, removed - removed.mean(axis=0), strict=True)
    ]
    common = flanks[0]["flank_grid"] | {"removed_um": np.round(removed.mean(axis=0), 5).tolist()}
    return {name: round(-mean[name], 5) + 0.0 for name in slopes} | {
        "flank_grid": common,
        "tooth_flanks": teeth,
    }


def _grid(rolls: FloatArray, faces: FloatArray, excess: FloatArray) -> dict[str, Any]:
    """Return the flank grid of a case, which states removed material, from the excess (rolls, faces), m."""
    return {
        "roll_length_mm": np.round(rolls / MM, 6).tolist(),
        "face_position_mm": np.round(faces / MM, 6).tolist(),
        "removed_um": [_um(-row) for row in excess],
    }


def _um(values: FloatArray) -> list[float]:
    return [float(value) for value in np.round(values / UM, 5) + 0.0]  # + 0.0 turns -0.0 into 0.0


def inspected(chart: Chart) -> Iterator[Point]:
    """Yield the points that an inspection of a gear would measure: pitches, and traces of tooth flanks."""
    gear = chart.gear
    cumulative = np.array(gear.pitch_deviation.cumulative)
    for tooth in range(1, 1 + cumulative.size):
        deviation = chart.facing * cumulative[chart.meshing(tooth) - 1]
        yield Point(0, tooth, chart.loaded, "cumulative_pitch", None, None, float(deviation))
    root, tip = sorted((gear.form_roll_length, gear.tip_roll_length))
    rolls = np.linspace(root, tip, _LISTED)
    faces = np.linspace(-0.5, 0.5, _LISTED) * gear.face_width
    middle = np.full(_LISTED, rolls.mean())
    for flank in gear.tooth_flanks:
        tooth = chart.meshing(flank.tooth)
        for roll, value in zip(rolls, flank.excess(gear, rolls, np.zeros(_LISTED)), strict=True):
            yield Point(0, tooth, chart.loaded, "profile", float(roll), None, float(value))
        for face, value in zip(faces, flank.excess(gear, middle, faces), strict=True):
            yield Point(0, tooth, chart.loaded, "helix", None, float(face), float(value))
