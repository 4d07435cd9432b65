"""Is a tolerance kept, and at what price? `tolerance = 0.01` on drawn pairs, as a caller runs it.

Each case runs with all its passes and nothing in the cache.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from benchmarks.drawn_pairs import assessed_pairs, fresh_pairs
from benchmarks.figures import Figure
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.pair_cases import PairCase
from benchmarks.stored_runs import finest_run, table_run
from fe_contact import AllowedError
from fe_contact.ste.curve_errors import METHOD
from fe_contact.types import FloatArray

PAGE, SECTION = MEASURED / "accuracy.md", "tolerance"
ALLOWED = AllowedError(0.01)
SUBJECT = f"tolerance = {ALLOWED.relative:g} against the finest solution"
LEVELS = ("draft", "standard")
"""The cheapest is one of these or the run itself."""
_MET, _PRICE, _PRICED = 95.0, 2.5, 90.0


@dataclass(frozen=True)
class ToleranceRun:
    """A run of one case under the tolerance."""

    name: str
    ended: str
    """Mesh and slices of the final table."""
    passes: int
    met: bool
    """Whether the receipt states that the tolerance is met."""
    stated: float
    true: float
    """`stated`, `true`: Largest stated and true error of mean and peak-to-peak over the loads, relative to
    the allowed error. The stated error is the part that a tolerance bounds: it leaves out `METHOD`, which no
    mesh lowers.
    """
    seconds: float
    """CPU seconds of all passes."""
    least_stated: float
    least_true: float
    """`least_stated`, `least_true`: Cost of the quickest run whose stated, or whose true errors are within
    the tolerance; NaN if there is none.
    """
    reason: str = "met"
    """Why the passes ended."""

    @property
    def price(self) -> float:
        """Time over that of the cheapest by stated errors."""
        return self.seconds / self.least_stated

    @property
    def price_in_truth(self) -> float:
        """Time over that of the cheapest by true errors, which nobody knows beforehand."""
        return self.seconds / self.least_true


def figures() -> list[Figure]:
    """Return the counts."""
    return counts(assessed())


@cache
def assessed() -> tuple[ToleranceRun, ...]:
    """Run and assess every case; runs are stored."""
    return tuple(assess(case) for case in (*assessed_pairs(), *fresh_pairs()))


def assess(case: PairCase) -> ToleranceRun:
    """Hold a run under the tolerance, and the levels, against the true values."""
    run, exact = table_run(case, tolerance=ALLOWED.relative), finest_run(case)
    tried = [run, *(table_run(case, level=level) for level in LEVELS)]
    stated = [one.seconds for one in tried if used(one.stated(METHOD), one.value) <= 1.0]
    true = [one.seconds for one in tried if used(one.value - exact, exact) <= 1.0]
    last = next(one for one in run.receipt["passes"] if one["kept"])
    across = f", {last['slices']} slices" if last["slices"] > 1 else ""
    return ToleranceRun(
        case.name,
        last["level"] + across,
        len(run.receipt["passes"]),
        bool(run.receipt["tolerance"]["met"]),
        used(run.stated(METHOD), run.value),
        used(run.value - exact, exact),
        run.seconds,
        min(stated, default=float("nan")),
        min(true, default=float("nan")),
        run.receipt["tolerance"]["reason"],
    )


def used(error: FloatArray, value: FloatArray) -> float:
    """Return the largest error of mean and peak-to-peak over the allowed error."""
    return float(np.max(np.abs(error[:2]) / ALLOWED.of(value[:2])))


def counts(found: Sequence[ToleranceRun]) -> list[Figure]:
    """Return how often the tolerance is met, whether that is true, and what it costs."""
    missed = 100.0 - _MET
    figures = {
        "not met as measured": ([not one.met for one in found], missed),
        "said to be met where more is stated": ([one.met and one.stated > 1.0 for one in found], 0.0),
        "true error beyond the tolerance": ([one.true > 1.0 for one in found], missed),
        f"price above {_PRICE:g} times the cheapest by stated errors": (
            _dear(_prices(found)),
            100.0 - _PRICED,
        ),
        f"price above {_PRICE:g} times the cheapest by true errors": (_dear(_prices_in_truth(found)), None),
    }
    rows = [Figure(SUBJECT, name, _per_cent(cases), "%", limit) for name, (cases, limit) in figures.items()]
    return [Figure(SUBJECT, "cases", float(len(found)), "-"), *rows]


def _prices(found: Sequence[ToleranceRun]) -> list[float]:
    """Return the prices of the cases that have one."""
    return [one.price for one in found if np.isfinite(one.price)]


def _prices_in_truth(found: Sequence[ToleranceRun]) -> list[float]:
    """Return the same by true errors."""
    return [one.price_in_truth for one in found if np.isfinite(one.price_in_truth)]


def _dear(prices: Sequence[float]) -> list[bool]:
    """Whether prices are above what is aimed at."""
    return [price > _PRICE for price in prices]


def markdown(found: Sequence[ToleranceRun]) -> str:
    """Return the section of accuracy.md."""
    lines = [
        f"| {len(found)} pairs | |",
        "|---|---:|",
        f"| met, says the receipt | {_per_cent(one.met for one in found):.0f} % |",
        f"| met, and more is stated | {_per_cent(one.met and one.stated > 1.0 for one in found):.0f} % |",
        f"| true error within the tolerance | {_per_cent(one.true <= 1.0 for one in found):.0f} % |",
        f"| price by stated errors | {_price_cell(_prices(found))} |",
        f"| price by true errors | {_price_cell(_prices_in_truth(found))} |",
        "",
        "| pair | ended with | passes | stated, % | true, % | CPU s | price: stated | true |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
        *map(_row, found),
    ]
    return "\n".join(lines) + "\n"


def _price_cell(prices: Sequence[float]) -> str:
    """Median, how many are low enough, and the worst."""
    low = 100.0 - _per_cent(_dear(prices))
    return f"median {np.median(prices):.2g}, at most {_PRICE:g} in {low:.0f} %, worst {max(prices):.2g}"


def _row(one: ToleranceRun) -> str:
    """One run; bold what is beyond the tolerance. Where the floor counts it stands for 1 %."""
    errors = (100.0 * ALLOWED.relative * part for part in (one.stated, one.true))
    cells = [f"{error:.2g}" if error <= 100.0 * ALLOWED.relative else f"**{error:.2g}**" for error in errors]
    ended = one.ended if one.met else f"{one.ended} (not met)"
    prices = [f"{price:.2g}" if np.isfinite(price) else "-" for price in (one.price, one.price_in_truth)]
    row = [one.name, ended, f"{one.passes}", *cells, f"{one.seconds:.2g}", *prices]
    return "| " + " | ".join(row) + " |"


def _per_cent(found: Iterable[bool]) -> float:
    """Return the percentage of true values."""
    return 100.0 * float(np.mean(list(found)))


def publish(found: Sequence[ToleranceRun]) -> None:
    """Write the section of the page between its marks."""
    replace_section(PAGE, SECTION, markdown(found))
