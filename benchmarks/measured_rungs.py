"""Every way to the table of a case, measured once: time, values, stated errors; kept on disk.

A study of many cases takes most of an hour: what has been measured is kept in ``out/bench/rungs`` and read
from there. A file is of one case and one rung, named by the content of both; to measure anew delete it.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.finest_rung import finest
from benchmarks.honesty_cases import HonestyCase
from fe_contact.analysis import check_request
from fe_contact.analysis.compute_database import compute_database
from fe_contact.analysis.decided import Decided
from fe_contact.analysis.model_choice import decide
from fe_contact.analysis.pair_contact import pair_contact
from fe_contact.analysis.warm_up import warm_up
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray, Json

ROOT = Path(__file__).parents[1] / "out" / "bench"
VERSION = 2  # raise it whenever the solver gives other numbers
TRUTH = "truth"


@dataclass(frozen=True)
class RungOf:
    """Model, mesh level and slices (0: the usual ones)."""

    model: str
    level: str
    slices: int = 0

    @property
    def name(self) -> str:
        """In words."""
        return f"{self.model} {self.level}" + (f", {self.slices} slices" if self.slices else "")


@dataclass(frozen=True)
class Measured:
    """One rung on one case.

    Attributes
    ----------
    value, stated : ndarray, shape (3, loads)
        Mean, peak-to-peak and first harmonic, and the errors their table states, m.
    seconds : dict
        CPU seconds by stage of a run that computes its compliances.
    kept : dict
        The same of a run that finds them in the cache.
    receipt : dict
        Parts of it: errors by source, prediction, positions.
    """

    value: FloatArray
    stated: FloatArray
    seconds: dict[str, float]
    kept: dict[str, float]
    receipt: Json

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds of the whole run."""
        return sum(self.seconds.values())

    def to_json(self) -> Json:
        """Return plain JSON."""
        return asdict(self) | {"value": self.value.tolist(), "stated": self.stated.tolist()}

    @classmethod
    def from_json(cls, content: Json) -> Measured:
        """Read what `to_json` wrote."""
        arrays = {name: np.array(content[name]) for name in ("value", "stated")}
        return cls(**(content | arrays))


def truth(case: HonestyCase, model: str | None = None) -> FloatArray:
    """Return mean, peak-to-peak and first harmonic of the finest rung, (3, loads) in m."""
    name = TRUTH if model is None else f"{TRUTH} {model}"

    def measure() -> Json:
        return {"value": finest(case, _cache(case, name), model).rows.tolist()}

    return np.array(_kept(case, name, measure)["value"])


def measured(case: HonestyCase, rung: RungOf) -> Measured:
    """Return what a rung gives on a case."""
    return Measured.from_json(_kept(case, rung.name, lambda: _measure(case, rung).to_json()))


def _measure(case: HonestyCase, rung: RungOf) -> Measured:
    """Run a rung; its compliances are timed apart, and shared with other slices of the same mesh."""
    warm_up(across_face=True)
    made = decided_rung(case, rung)
    folder = _cache(case, f"{rung.model} {rung.level}")
    fresh = _compliance_seconds(made, folder)
    table = compute_database(made.checked, made.checked.request.to_json(), _silent, folder, made)
    receipt = table.metadata.receipt
    kept = {name: stage["cpu_seconds"] for name, stage in receipt["stages"].items()}
    seconds = {name: value + fresh.get(name, 0.0) for name, value in kept.items()}
    skew = float(table.misalignment[0])
    curves = [table.curve(force=force, misalignment=skew) for force in case.forces]
    found = [[c.mean, c.peak_to_peak, c.harmonics[0]] for c in curves]
    shown = {name: receipt[name] for name in ("curve_error", "prediction", "not_estimated")}
    shown |= {"positions": int(table.position.size), "memory": receipt["peak_memory_bytes"]}
    return Measured(
        np.array([[one.value for one in row] for row in found]).T,
        np.array([[one.error for one in row] for row in found]).T,
        seconds,
        kept,
        shown,
    )


def decided_rung(case: HonestyCase, rung: RungOf) -> Decided:
    """Return the request of a case with the discretisation of a rung; positions are placed adaptively."""
    options: dict[str, Any] = {name: value for name, value in case.options.items() if name != "positions"}
    options["model"] = "auto" if rung.model == "corrected" else rung.model
    found = decide(check_request(case.pair, normal_forces=case.forces, level=rung.level, **options))
    return found.in_slices(rung.slices) if rung.slices else found


def _compliance_seconds(made: Decided, folder: Path) -> dict[str, float]:
    """CPU seconds of the compliances, computed afresh or as they were when they were."""
    file = folder / "seconds.json"
    if not file.exists():
        clock = StageClock()
        for stage, coarse in (("compliance", False), ("error estimate", True)):
            with clock.stage(stage):
                pair_contact(made.checked.request.pair, made.plan, folder, coarse)
        file.write_text(json.dumps(clock.seconds), encoding="utf-8")
    return dict(json.loads(file.read_text(encoding="utf-8")))


def _kept(case: HonestyCase, name: str, measure: Any) -> Json:
    """Read a measurement, or make and keep it."""
    file = ROOT / "rungs" / f"{_key(case, name)}.json"
    if not file.exists():
        sys.stderr.write(f"  {case.name}: {name}\n")
        file.parent.mkdir(parents=True, exist_ok=True)
        content = {"case": case.name, "rung": name} | {"found": measure()}
        part = file.with_suffix(".part")
        part.write_text(json.dumps(content, indent=1), encoding="utf-8")
        part.replace(file)
    return dict(json.loads(file.read_text(encoding="utf-8"))["found"])


def _key(case: HonestyCase, name: str) -> str:
    """Content of a case and a rung."""
    options = {key: value for key, value in case.options.items() if key != "positions"}
    text = repr([VERSION, case.pair, case.forces, sorted(options.items()), name])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _cache(case: HonestyCase, name: str) -> Path:
    """Directory of the compliances of one mesh of a case."""
    folder = ROOT / "compliances" / _key(case, name)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _silent(stage: str, fraction: float) -> None:
    """Report no progress."""


def needs_face(case: HonestyCase) -> bool:
    """Whether only three dimensions hold what is in the case, or it asks for them."""
    return decided_rung(case, RungOf(case.options.get("model", "auto"), "draft")).checked.model.across_face


def rungs_of(*, across_face: bool) -> Iterator[RungOf]:
    """Yield the rungs that are measured."""
    if not across_face:
        yield from (RungOf("plane_strain", "draft"), RungOf("corrected", "draft"))
        yield from (RungOf("corrected", "standard"), RungOf("corrected", "fine"))
        yield from (RungOf("3d", "draft"), RungOf("3d", "standard"))
    else:
        yield from (RungOf("3d", level, n) for level in ("draft", "standard") for n in (15, 23))
