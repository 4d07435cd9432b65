"""Is an asked tolerance kept, and at what price? `tolerance = 0.01` on many pairs, against the finest rung.

Each case runs as a caller's would: with all its passes and nothing in the cache.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.figures import Figure
from benchmarks.held_out_cases import held_out_face_cases, held_out_plane_cases
from benchmarks.honesty_cases import HonestyCase, face_cases, plane_cases
from benchmarks.marked_section import replace_section
from benchmarks.measured_rungs import RungOf, measured, needs_face, rungs_of, truth
from fe_contact import AllowedError, analyze
from fe_contact.types import FloatArray

PAGE = Path(__file__).parents[1] / "docs" / "accuracy.md"
SECTION = "tolerance"
TOLERANCE = 0.01
SUBJECT = f"tolerance = {TOLERANCE:g} against the finest rung"
_MET, _PRICE = 90.0, 2.5
REFERENCE = RungOf("3d", "standard")
"""What the plane is held against: it errs by less than 0.3 %, and agrees with the finest plane to as much."""


@dataclass(frozen=True)
class Ran:
    """A run under the tolerance.

    Attributes
    ----------
    rung : RungOf
        Model, mesh and slices of the pass whose table it gave.
    passes : int
    stated : bool
        Whether its receipt says that the tolerance is met.
    value : ndarray, shape (2, loads)
        Mean and peak-to-peak, m.
    seconds : float
        CPU seconds of all passes.
    """

    rung: RungOf
    passes: int
    stated: bool
    value: FloatArray
    seconds: float


@dataclass(frozen=True)
class Kept:
    """A promise on one case.

    Attributes
    ----------
    case : str
    held_out : bool
        Whether no constant was fitted to the case.
    rung : str
        Model, mesh and slices that the run ended with.
    passes : int
        In which it got there.
    stated : bool
        Whether its receipt says that the tolerance is met.
    error : float
        True relative error of mean and peak-to-peak, the worst over the loads.
    seconds : float
        CPU seconds of all passes.
    cheapest : str
        The quickest rung that met the tolerance, empty if none did.
    least : float
        Its CPU seconds, NaN if there is none.
    """

    case: str
    held_out: bool
    rung: str
    passes: int
    stated: bool
    error: float
    seconds: float
    cheapest: str
    least: float

    @property
    def met(self) -> bool:
        """Whether the tolerance was met."""
        return self.error <= TOLERANCE

    @property
    def price(self) -> float:
        """Time over that of the cheapest rung that met it; NaN if none did."""
        return self.seconds / self.least


def figures() -> list[Figure]:
    """Return the counts."""
    return counts(study())


@cache
def study() -> tuple[Kept, ...]:
    """Judge every case; what is measured already is not measured again."""
    known = [*plane_cases(), *face_cases()]
    held_out = [*held_out_plane_cases(), *held_out_face_cases()]
    run(known[0])  # what is loaded and compiled at first use is no part of a price
    return tuple(judge(case, held_out=case in held_out) for case in [*known, *held_out])


def judge(case: HonestyCase, *, held_out: bool) -> Kept:
    """Ask for the tolerance, and hold what the run gives against the finest rung."""
    ran = run(case)
    across_face = needs_face(case)
    exact = truth(case) if across_face else measured(case, REFERENCE).value
    beside = [RungOf("3d", "standard", 23), RungOf("3d", "fine")] if ran.rung.level == "fine" else []
    tried = {one: measured(case, one) for one in dict.fromkeys([*rungs_of(across_face=across_face), *beside])}
    good = [one for one, found in tried.items() if relative_error(found.value, exact) <= TOLERANCE]
    best = min(good, key=lambda one: tried[one].cpu_seconds, default=None)
    return Kept(
        case.name,
        held_out,
        ran.rung.name,
        ran.passes,
        ran.stated,
        relative_error(ran.value, exact),
        ran.seconds,
        best.name if best else "",
        tried[best].cpu_seconds if best else float("nan"),
    )


def run(case: HonestyCase) -> Ran:
    """Run a case under the tolerance, with nothing in the cache."""
    options: dict[str, Any] = {name: value for name, value in case.options.items() if name != "positions"}
    with tempfile.TemporaryDirectory() as folder:
        table = analyze(
            case.pair, normal_forces=case.forces, tolerance=TOLERANCE, **options, cache=Path(folder)
        )
    receipt, skew = table.metadata.receipt, float(table.misalignment[0])
    curves = [table.curve(force=force, misalignment=skew) for force in case.forces]
    value = np.array([[curve.mean.value, curve.peak_to_peak.value] for curve in curves]).T
    kept = next(one for one in receipt["passes"] if one["kept"])
    met = bool(receipt["tolerance"]["met"])
    return Ran(rung_of(kept), len(receipt["passes"]), met, value, receipt["cpu_seconds"])


def rung_of(kept: dict[str, Any]) -> RungOf:
    """Name model, mesh and slices of a pass as the study does."""
    if kept["model"] == "three dimensions":
        return RungOf("3d", kept["level"], kept["slices"])
    return RungOf("corrected" if "corrected" in kept["model"] else "plane_strain", kept["level"])


def relative_error(value: FloatArray, exact: FloatArray) -> float:
    """Largest error of mean and peak-to-peak over the loads, in parts of the size the tolerance counts by."""
    return float(np.max(np.abs(value[:2] - exact[:2]) / AllowedError(TOLERANCE).scale(exact[:2])))


def counts(found: Sequence[Kept]) -> list[Figure]:
    """Return how often the tolerance was met, and at what price."""
    rows = [Figure(SUBJECT, "cases", float(len(found)), "-")]
    for name, part in (("", found), (" (held out)", [one for one in found if one.held_out])):
        price = np.array([one.price for one in part])
        known = price[np.isfinite(price)]
        missed = 100.0 * float(np.mean([not one.met for one in part]))
        dear = 100.0 * float(np.mean(known > _PRICE))
        wrong = 100.0 * float(np.mean([one.stated and not one.met for one in part]))
        rows += [
            Figure(SUBJECT, f"not met{name}", missed, "% of cases", 100.0 - _MET),
            Figure(
                SUBJECT, f"median price{name}", float(np.median(known)), "x the cheapest that met it", _PRICE
            ),
            Figure(SUBJECT, f"price above {_PRICE:g}{name}", dear, "% of cases", 100.0 - _MET),
            Figure(SUBJECT, f"stated to be met and not met{name}", wrong, "% of cases", 100.0 - _MET),
        ]
    return rows


def markdown(found: Sequence[Kept]) -> str:
    """Return the section of docs/accuracy.md."""
    known = [one for one in found if np.isfinite(one.price)]
    lines = [
        f"`tolerance = {TOLERANCE:g}` on {len(found)} cases at two or three loads each, "
        f"{sum(one.held_out for one in found)} of them held out of the fits (marked *), no effect spared:",
        f"met in {_share(one.met for one in found)}, of those held out in "
        f"{_share(one.met for one in found if one.held_out)};",
        f"median price {np.median([one.price for one in known]):.2g} times the cheapest rung that met it, "
        f"at most {_PRICE:g} times in {_share(one.price <= _PRICE for one in known)}, "
        f"worst {max(one.price for one in known):.2g}.",
        "",
        "| case | ended with | passes | true error, % | CPU s | cheapest that met it | CPU s | price |",
        "|---|---|---:|---:|---:|---|---:|---:|",
    ]
    for one in found:
        error = f"{100.0 * one.error:.2g}" if one.met else f"**{100.0 * one.error:.2g}**"
        promise = "" if one.stated else " (not met by its receipt)"
        price = f"{one.price:.2g}" if np.isfinite(one.price) else "-"
        name = f"{one.case}*" if one.held_out else one.case
        best = f"{one.cheapest or 'none'} | {one.least:.2g}"
        ended = f"{one.rung}{promise} | {one.passes}"
        lines.append(f"| {name} | {ended} | {error} | {one.seconds:.2g} | {best} | {price} |")
    return "\n".join(lines) + "\n"


def _share(found: Any) -> str:
    """Per cent of what is true."""
    return f"{100.0 * np.mean(list(found)):.0f} %"


def publish(found: Sequence[Kept]) -> None:
    """Write the section of the page between its marks."""
    replace_section(PAGE, SECTION, markdown(found))
