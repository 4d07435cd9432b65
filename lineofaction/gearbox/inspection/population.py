"""A population of measured gears: mean and covariance of their deviations, between gears and between teeth.

Traits are deviations as a case states them of single teeth: slopes over the usable profile and the face
width, and forms, as a range, and, where the file has the measured curves (traces), as the height of a
parabola. The deviation of a gear is the mean of its measured teeth. The variance of these means has a part by
the differences of teeth, which is subtracted to get the variance between gears (analysis of variance, one
way).
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.inspection.evaluation import Split
from lineofaction.gearbox.inspection.machine_file import is_machine_file, place, sheet_tooth
from lineofaction.gearbox.inspection.machine_heading import Conventions
from lineofaction.gearbox.inspection.machine_judgement import HELIX_SIGN
from lineofaction.gearbox.inspection.machine_values import ValueFile, is_value_file, value_file
from lineofaction.gearbox.inspection.measured_gear import Chart, measured_gear
from lineofaction.gearbox.inspection.reading import FIELD, REMEDY, read_sheet
from lineofaction.gearbox.inspection.sheet import Interval
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.named_files import read_text
from lineofaction.gearbox.units import MM, UM

ENDINGS = (".csv", ".mka", ".mew")
MOST_FILES = 2000
"""Most files of a folder."""
SLOPES = ("profile_slope", "helix_slope")
_FIGURES = {"fHa": "profile_slope", "ffa": "profile_range", "fHb": "helix_slope", "ffb": "helix_range"}
_PITCHES = {"fp max": "single_pitch", "Fp": "cumulative_pitch", "Fr": "run_out"}
_STATIONS = 41
"""Number of places of a trace, evenly over the usable profile or the face width."""
_EXPLAINED = 0.99
"""Least part of the variance of traces that the stated principal components explain."""
_LEAST = 1e-9
"""Standard deviation between gears, m, below which gears do not differ."""
Traits = dict[str, float]


@dataclass(frozen=True)
class InspectedGear:
    """Deviations of one gear on its loaded flanks, m."""

    name: str
    teeth: Mapping[int, Traits]
    """Traits by tooth of the sheet."""
    pitches: Traits
    traces: Mapping[str, tuple[FloatArray, ...]]
    """Profiles and helices at even places, (k,) each."""
    differences: tuple[str, ...] = ()
    """Values that the machine printed and that the curves do not confirm, in words."""


@dataclass(frozen=True)
class TracePopulation:
    """Mean and principal components of traces at k even places, m."""

    number: int
    mean: FloatArray
    components: FloatArray
    """Principal components (c, k), each as large as one standard deviation."""
    share: FloatArray
    """Part of the variance of each component (c,)."""


@dataclass(frozen=True)
class Population:
    """Mean and covariance of d traits of gears, m."""

    gears: tuple[str, ...]
    names: tuple[str, ...]
    teeth: int
    """Number of measured teeth."""
    mean: FloatArray
    between: FloatArray
    within: FloatArray
    """`mean`, `between`, `within`: Mean (d,), and covariances (d, d) of gears, and of teeth about their gear.
    """
    of_gears: FloatArray
    """Mean of the measured teeth of each gear (n, d)."""
    pitches: Mapping[str, FloatArray]
    """Pitch deviations of all gears that have them."""
    traces: Mapping[str, TracePopulation]

    @property
    def common(self) -> FloatArray:
        """Part of the standard deviation that all teeth of a gear have in common, (d,)."""
        between, within = np.diag(self.between), np.diag(self.within)
        return np.sqrt(between / np.maximum(between + within, np.finfo(float).tiny))

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the traits between gears, (d, d)."""
        spread = np.sqrt(np.maximum(np.diag(self.between), _LEAST**2))
        return np.asarray(self.between / np.outer(spread, spread))

    @property
    def mean_error(self) -> FloatArray:
        """Standard errors of the mean (d,), m: of few gears."""
        return np.asarray(self.of_gears.std(axis=0, ddof=1) / math.sqrt(len(self.gears)))

    @property
    def spread_error(self) -> FloatArray:
        """Standard errors of the standard deviations between gears (d,), m.

        The variance of n means is known to sqrt(2/(n - 1)) of itself; what differences of teeth take off it
        leaves that error whole.
        """
        between = np.diag(self.between)
        of_variance = self.of_gears.var(axis=0, ddof=1) * math.sqrt(2.0 / (len(self.gears) - 1.0))
        return np.asarray(np.sqrt(between + of_variance) - np.sqrt(between))

    def drawn(self, count: int, seed: int, teeth: float = math.inf) -> FloatArray:
        """Draw the mean traits of gears of so many measured teeth, normally distributed, (count, d) in m."""
        values, vectors = np.linalg.eigh(self.between + self.within / teeth)
        deviates = np.random.default_rng(seed).standard_normal((count, values.size))
        return np.asarray(self.mean + (deviates * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)


def gear_files(folder: Path) -> list[Path]:
    """Return the files of inspections in a folder, sorted, but no value file whose curve file is there.

    Raises `BadInput`: too many files. A link that leads out of the folder is left out.
    """
    inside = folder.resolve()
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS and path.is_file())
    curves = {path.stem for path in paths if path.suffix.lower() == ".mka"}
    files = [
        path
        for path in paths
        if path.resolve().is_relative_to(inside)
        and not (path.suffix.lower() == ".mew" and path.stem in curves)
    ]
    if len(files) > MOST_FILES:
        raise BadInput.of(FIELD, str(folder), f"a folder of at most {MOST_FILES} inspections", REMEDY)
    return files


def values_beside(path: Path) -> str | None:
    """Return the text of the value file of a curve file's name in its folder, or None.

    Links that lead out of the folder are not followed.
    """
    if path.suffix.lower() != ".mka":
        return None
    folder = path.resolve().parent
    files = (file for file in map(path.with_suffix, (".mew", ".MEW")) if file.is_file())
    beside = next((file for file in files if file.resolve().parent == folder), None)
    return None if beside is None else read_text(beside, str(beside))


def inspected_gear(path: Path, chart: Chart, cutoff: float | None = None) -> InspectedGear:
    """Return the deviations of one gear by its file; raises `BadInput`: a file that cannot be read."""
    text, values = read_text(path, str(path)), values_beside(path)
    try:
        if is_value_file(text):
            return _by_values(path.name, value_file(text), chart)
        sheet = read_sheet(text, chart.gear, str(path), values)
        gear = measured_gear(sheet, chart, str(path), cutoff)
        evaluated = {kind: part for (kind, flank), part in sheet.intervals.items() if flank == chart.loaded}
        teeth = _by_splits(gear.splits, evaluated, chart.gear)
        pitches = _pitch_traits(gear.fields.get("pitch_deviation_um", []))
        if values is not None and is_machine_file(text):
            printed = _by_values(path.name, value_file(values), chart)
            for tooth, traits in printed.teeth.items():
                teeth[tooth] |= traits
            pitches = printed.pitches or pitches
    except ValueError as fault:
        raise BadInput.of(FIELD, str(path), str(fault), REMEDY) from None
    traces: dict[str, list[FloatArray]] = defaultdict(list)
    for (_, kind), trace in gear.splits.items():
        traces[kind].append(_trace(trace, kind, chart.gear))
    return InspectedGear(
        path.name, teeth, pitches, {kind: tuple(rows) for kind, rows in traces.items()}, gear.differences
    )


def population(gears: Sequence[InspectedGear], name: str) -> Population:
    """Return the population of gears in the traits that at least half of them have.

    Raises `BadInput`: fewer than two gears have these traits.
    """
    names = _frequent(gears)
    blocks = {gear.name: _rows(gear, names) for gear in gears}
    gears = [gear for gear in gears if len(blocks[gear.name])]
    if len(gears) < 2 or not names:
        raise BadInput.of(
            FIELD, name, "two gears or more that have slopes of the loaded flanks in common", REMEDY
        )
    rows = [blocks[gear.name] for gear in gears]
    between, within = _covariances(rows)
    pitches = defaultdict(list)
    for gear in gears:
        for trait, value in gear.pitches.items():
            pitches[trait].append(value)
    of_gears = np.array([block.mean(axis=0) for block in rows])
    return Population(
        gears=tuple(gear.name for gear in gears),
        names=tuple(names),
        teeth=sum(map(len, rows)),
        mean=of_gears.mean(axis=0),
        between=between,
        within=within,
        of_gears=of_gears,
        pitches={trait: np.array(values) for trait, values in pitches.items()},
        traces=_traces(gears),
    )


def _frequent(gears: Sequence[InspectedGear]) -> list[str]:
    """Return the traits of at least half of the gears."""
    counts = Counter(trait for gear in gears for trait in set().union(*gear.teeth.values()))
    return sorted(trait for trait, count in counts.items() if 2 * count >= len(gears))


def _rows(gear: InspectedGear, names: Sequence[str]) -> FloatArray:
    """Return traits (n, d) of the teeth that have them all."""
    return np.array(
        [[traits[trait] for trait in names] for traits in gear.teeth.values() if {*names} <= {*traits}]
    )


def _covariances(rows: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return covariances (d, d) between gears and between teeth of a gear, by traits (n, d) of each gear."""
    counts = np.array([len(block) for block in rows])
    total = counts.sum()
    means = np.array([block.mean(axis=0) for block in rows])
    centered = np.concatenate([block - mean for block, mean in zip(rows, means, strict=True)])
    freedom = total - len(rows)
    within = centered.T @ centered / freedom if freedom else np.zeros((means.shape[1],) * 2)
    # the covariance of the means, less the part by the differences of teeth: a mean of n teeth has 1/n of it
    between = np.atleast_2d(np.cov(means, rowvar=False)) - within * float(np.mean(1.0 / counts))
    values, vectors = np.linalg.eigh(between)
    return (vectors * np.maximum(values, 0.0)) @ vectors.T, within


def _traces(gears: Iterable[InspectedGear]) -> dict[str, TracePopulation]:
    rows: dict[str, list[FloatArray]] = defaultdict(list)
    for gear in gears:
        for kind, traces in gear.traces.items():
            rows[kind] += traces
    return {kind: _principal(np.array(traces)) for kind, traces in rows.items() if len(traces) > 1}


def _principal(traces: FloatArray) -> TracePopulation:
    """Return mean and principal components of traces (n, k) until they explain the variance."""
    mean = traces.mean(axis=0)
    _, singular, vectors = np.linalg.svd(traces - mean, full_matrices=False)
    variance = singular**2 / (len(traces) - 1)
    share = variance / max(variance.sum(), np.finfo(float).tiny)
    number = int(np.searchsorted(np.cumsum(share), _EXPLAINED)) + 1
    components = np.sqrt(variance[:number, None]) * vectors[:number]
    return TracePopulation(len(traces), mean, components, share[:number])


def _by_splits(
    splits: Mapping[tuple[int, str], Split], evaluated: Mapping[str, Interval], gear: Toothing
) -> dict[int, Traits]:
    teeth: dict[int, Traits] = defaultdict(dict)
    for (tooth, kind), trace in splits.items():
        length = _length(kind, gear)
        teeth[tooth][f"{kind}_slope"] = trace.slope / trace.length * length
        teeth[tooth][f"{kind}_range"] = trace.form
        part = evaluated.get(kind) or Interval(trace.coordinate[0], trace.coordinate[-1], trace.length)
        middle = 2.0 * (trace.coordinate - part.first) / (part.last - part.first) - 1.0
        inside = np.abs(middle) <= 1.0 + 1e-9  # the evaluated interval, with rounding
        # material is in excess in the middle of a flank of positive form
        teeth[tooth][f"{kind}_form"] = -float(np.polyfit(middle[inside], trace.rest[inside], 2)[0])
    return teeth


def _trace(trace: Split, kind: str, gear: Toothing) -> FloatArray:
    """Return a trace less its mean at even places of the usable flank, (k,)."""
    half = 0.5 * gear.face_width
    rolls = sorted((gear.form_roll_length, gear.tip_roll_length))
    first, last = rolls if kind == "profile" else (-half, half)
    values = trace.rest + trace.slope / trace.length * (trace.coordinate - trace.coordinate[0])
    even = np.interp(np.linspace(first, last, _STATIONS), trace.coordinate, values)
    return np.asarray(even - even.mean())


def _by_values(name: str, file: ValueFile, chart: Chart) -> InspectedGear:
    """Return the printed deviations of the loaded flanks as a case states them."""
    gear, conventions = chart.gear, file.conventions
    if file.teeth != gear.teeth:
        raise ValueError(f"the file of a gear of {gear.teeth} teeth; it has {file.teeth}")
    teeth: dict[int, Traits] = defaultdict(dict)
    pitches: Traits = {}
    for result in file.printed:
        trait = _FIGURES.get(result.figure)
        if trait and result.flank == chart.loaded and result.tooth <= gear.teeth:
            factor = _scale(trait, conventions, chart) if trait in SLOPES else 1.0
            tooth = sheet_tooth(result.tooth, conventions, gear)
            teeth[tooth][trait] = factor * result.value * UM
        elif result.figure in _PITCHES and result.flank in (None, chart.loaded):
            pitches[_PITCHES[result.figure]] = result.value * UM
    return InspectedGear(name, teeth, pitches, {})


def _scale(trait: str, conventions: Conventions, chart: Chart) -> float:
    """Return the quotient of the slope that a case states by the slope that the machine prints.

    The case's is over the usable profile or face width, the machine's over its evaluation range.
    """
    kind, gear = trait.partition("_")[0], chart.gear
    ends = conventions.ranges.get((kind, chart.loaded))
    if ends is None:
        raise ValueError(f"a value file whose heading has the ranges of the {kind}; it has none")
    if kind == "profile":
        return _length(kind, gear) / (place(kind, ends.last, gear) - place(kind, ends.first, gear))
    # heights rise where positions on the face fall
    return -HELIX_SIGN[chart.loaded] * _length(kind, gear) / (ends.end - ends.begin) / MM


def _length(kind: str, gear: Toothing) -> float:
    return gear.face_width if kind == "helix" else abs(gear.tip_roll_length - gear.form_roll_length)


def _pitch_traits(deviation_um: Sequence[float]) -> Traits:
    if not deviation_um:
        return {}
    places = np.array(deviation_um) * UM
    single = np.abs(places - np.roll(places, 1)).max()
    return {"single_pitch": float(single), "cumulative_pitch": float(np.ptp(places))}
