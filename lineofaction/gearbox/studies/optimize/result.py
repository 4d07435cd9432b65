"""Quietest flanks of a mesh in a scene: levels before and after the search, and figures that get worse."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from bounds import engineering
from bounds.brief import brief
from bounds.types import Json
from fe_contact.microgeometry.optimization import Outcome, excess, gain_of, outcome_of
from fe_contact.microgeometry.search import SearchRun
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.types import Estimate, FloatArray
from lineofaction.gearbox.studies.change.result import ALL, AUDIBLE, HIGH, LOW, MEDIAN
from model_studies import in_unit
from model_studies.result_record import ResultRecord
from model_studies.spread import quantiles

FALL = 25.0
"""Level in dB below the loudest line from which a line is not mentioned."""
MORE = 0.01
"""Relative rise of a pressure or a face load factor from which the rise is mentioned."""


@dataclass(frozen=True)
class HeardDesign:
    """A design under L load cases in K lines."""

    values: dict[str, float]
    """Values of the variables in m, by ``gear.quantity``."""
    objective: Estimate
    """Level that is minimized, with its error, dB."""
    level: FloatArray = field(metadata=in_unit("dB", "load_case", "line"))
    level_error: FloatArray = field(metadata=in_unit("dB", "load_case", "line"))
    """`level`, `level_error`: Levels and the errors of the contact's discretization in them, dB. Shape (L, K)
    each.
    """
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "load_case"))
    peak_to_peak_error: FloatArray = field(metadata=in_unit("m", "load_case"))
    """`peak_to_peak`, `peak_to_peak_error`: Peak-to-peak of the transmission error without scatter, and its
    error, m. Shape (L,) each."""
    pressure: FloatArray = field(metadata=in_unit("pa", "load_case"))
    """Largest Hertzian pressure at any node of the scatter, Pa. Shape (L,)."""
    face_load_factor: FloatArray
    edge_load_share: FloatArray
    """`face_load_factor`, `edge_load_share`: K_Hbeta, and share of the load at edges. Shape (L,) each."""
    parting: FloatArray
    """Largest share of the static mesh force by which flanks part at a speed, 0: they do not. Shape (L,)."""
    violation: float
    """Relative amount by which the limits are exceeded; 0: all limits hold."""
    root_stress: FloatArray = field(
        default_factory=lambda: np.full(1, np.nan), metadata=in_unit("pa", "load_case")
    )
    root_stress_error: FloatArray = field(
        default_factory=lambda: np.full(1, np.nan), metadata=in_unit("pa", "load_case")
    )
    """`root_stress`, `root_stress_error`: Largest stress in the tension roots at any node of the scatter, and
    its error, Pa; NaN without a limit on root stress. Shape (L,) each.
    """
    pressure_error: FloatArray = field(
        default_factory=lambda: np.full(1, np.nan), metadata=in_unit("pa", "load_case")
    )
    face_load_factor_error: FloatArray = field(default_factory=lambda: np.full(1, np.nan))
    """`pressure_error`, `face_load_factor_error`: Errors of the discretization; NaN: not estimated. Shape
    (L,) each.
    """


@brief
@dataclass(frozen=True)
class HeardOptimization(ResultRecord):
    """The start and the optimum of a search for the quietest flanks."""

    mesh: str
    quantity: str
    unit: str
    over_speeds: str
    over_loads: str
    """`mesh`, `quantity`, `unit`, `over_speeds`, `over_loads`: Words for the minimized figure; the unit with
    its reference.
    """
    lines: tuple[str, ...]
    """Names of the lines: `ALL` orders that count together, then the orders of the mesh."""
    variables: tuple[DesignVariable, ...]
    load_case: tuple[str, ...]
    torque: FloatArray = field(metadata=in_unit("n_m", "load_case"))
    misalignment: FloatArray = field(metadata=in_unit("m", "load_case"))
    """`torque`, `misalignment`: Torque on the driving gear of the mesh, N m, and misalignment of the mesh, m.
    Shape (L,) each."""
    speed: FloatArray = field(metadata=in_unit("rad s-1", "speed"))
    """Speed of the leading shaft, rad/s. Shape (S,)."""
    start: HeardDesign
    optimum: HeardDesign
    runs: tuple[SearchRun, ...]
    best_run: int
    tolerance_class: int
    pairs: FloatArray = field(metadata=in_unit("dB", "design", "pair"))
    """Levels of start and optimum with the same deviations within the tolerance class, dB; empty without a
    class. Shape (2, N).
    """
    case: Json
    """Case of the mesh, as a case file has it."""
    cost: Json
    """Evaluations, and CPU seconds by stage."""

    @property
    def gain(self) -> Estimate:
        """The fall of the level, dB; the errors of both designs are added, although they share a mesh."""
        return gain_of(self.start, self.optimum)

    @property
    def evaluations(self) -> int:
        """The number of designs that the search evaluated."""
        return sum(run.evaluations for run in self.runs)

    @property
    def outcome(self) -> Outcome:
        """The outcome of the search; designs whose levels differ by less than the errors are tied."""
        return outcome_of(self.start, self.optimum)

    @property
    def reason(self) -> str:
        """The outcome in a sentence."""
        gain, start, optimum = self.gain, self.start.objective, self.optimum.objective
        over = excess(self.optimum)
        levels = f"{start.value:.1f} to {optimum.value:.1f} {self.unit}"
        levels = f"{levels}, errors {engineering(gain.error, 2)} dB"
        sentences = {
            Outcome.IMPROVED: f"Quieter by {gain.value:.1f} dB: {levels}",
            Outcome.WITHIN_ERROR: f"A tie: the optimum cannot be told from the start, {levels}",
            Outcome.NOT_IMPROVED: f"No quieter flanks were found: {levels}",
            Outcome.LIMITS_MET: f"The limits are kept, which the start exceeds: {levels}",
            Outcome.LIMITS_EXCEEDED: f"The best design exceeds the limits by {over}: {levels}",
        }
        return sentences[self.outcome]

    def ended(self) -> str:
        """Return a sentence on the end of the search, and on the number of its starts that agree."""
        run = self.runs[self.best_run]
        ends = np.array([end for start in self.runs for end in start.ends])
        ended = "The search converged" if run.converged else f"The search ended: {run.ended.value}"
        margin = max(AUDIBLE, self.optimum.objective.error)
        agreeing = int(np.sum(ends <= ends.min(initial=np.inf) + margin))
        agree = f"; {agreeing} of {ends.size} starts end within {engineering(margin, 2)} dB of the quietest"
        return f"{ended}, {self.evaluations} designs{agree if ends.size > 1 else ''}."

    @property
    def bands(self) -> FloatArray:
        """Levels of start and optimum and their change (3, 3) that 5, 50 and 95 % of the pairs are below, dB.

        NaN without pairs.
        """
        before, after = self.pairs
        levels = np.stack([before, after, after - before])
        return quantiles(levels.T, (LOW, MEDIAN, HIGH)).T

    @property
    def louder_share(self) -> float:
        """Share of the pairs that get louder."""
        return float(np.mean(self.pairs[1] > self.pairs[0]))

    def within_tolerances(self) -> str:
        """Return a sentence on the change for pairs as made; empty without a tolerance class."""
        if not self.pairs.size:
            return ""
        (_, _, before), (_, _, after), (low, median, high) = self.bands
        return (
            f"Within class {self.tolerance_class}: {median:+.1f} dB ({low:+.1f} to {high:+.1f} dB), "
            f"{100.0 * self.louder_share:.0f} % of {self.pairs.shape[1]} pairs get louder; 95 % of them are "
            f"below {after:.1f} dB, before {before:.1f} dB."
        )

    def worse(self) -> Iterator[str]:
        """Yield figures that get worse: orders by load case, largest first, ripple, pressure, K_Hbeta."""
        before, after = self.start, self.optimum
        change = after.level - before.level
        error = before.level_error + after.level_error
        floor = max(before.level.max(), after.level.max()) - FALL
        for flat in np.argsort(-after.level, axis=None, kind="stable").tolist():
            load, line = np.unravel_index(flat, change.shape)
            threshold = max(AUDIBLE, float(error[load, line]))
            if change[load, line] >= threshold and after.level[load, line] > floor:
                name = "all orders" if self.lines[line] == ALL else f"order {self.lines[line]}"
                rise = f"{change[load, line]:+.1f} dB to {after.level[load, line]:.1f} dB"
                yield f"{name} at {self.torque[load]:.4g} N m {rise}"
        ripple = after.peak_to_peak - before.peak_to_peak
        rises = ripple > before.peak_to_peak_error + after.peak_to_peak_error
        for load in np.flatnonzero(rises).tolist():
            ends = (engineering(1e6 * design.peak_to_peak[load], 3) for design in (before, after))
            yield f"peak-to-peak STE at {self.torque[load]:.4g} N m {' to '.join(ends)} µm"
        yield from self._rising("largest pressure", before.pressure / 1e6, after.pressure / 1e6, "MPa")
        yield from self._rising("K_Hbeta", before.face_load_factor, after.face_load_factor, "")

    def _rising(self, name: str, before: FloatArray, after: FloatArray, unit: str) -> Iterator[str]:
        for load in np.flatnonzero(after > (1.0 + MORE) * before).tolist():
            ends = f"{engineering(before[load], 3)} to {engineering(after[load], 3)} {unit}".rstrip()
            yield f"{name} at {self.torque[load]:.4g} N m {ends}"

    def costs(self) -> str:
        """Return a sentence on the figures that get worse."""
        worse = list(self.worse())
        return f"Gets worse: {'; '.join(worse)}." if worse else "Nothing gets worse beyond its error."

    def partings(self) -> Iterator[str]:
        """Yield sentences on load cases in which flanks part, so that no linear response holds."""
        for name, design in (("the start", self.start), ("the optimum", self.optimum)):
            for load in np.flatnonzero(design.parting > 0.0).tolist():
                yield f"Flanks of {name} would part at {self.torque[load]:.4g} N m: no linear level holds."
