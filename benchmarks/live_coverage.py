"""Do the errors of live answers cover? Other flanks, loads and alignments against the finest solution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from benchmarks.assessed import Assessed, coverage_figures, coverage_table
from benchmarks.error_coverage import PAGE, SHARED
from benchmarks.figures import Figure
from benchmarks.finest_solution import finest_plan, solved_finely
from benchmarks.marked_section import replace_section
from benchmarks.pair_cases import M, PairCase, face_cases, plane_cases
from benchmarks.stored_runs import FILE, errors_by_source, quantities, together
from fe_contact import FlankModification, analyze
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.types import FloatArray

SECTION, SUBJECT = "live answers", "stated errors of live answers against the finest solution"
FOLDER = FILE.parent / "live"
_COVERAGE = 90.0
LOADS = (0.25, 0.5, 1.5)
LEVELS = ("draft", "standard")
PLAIN = FlankModification()


@dataclass(frozen=True)
class Question:
    """Flanks of both gears, and a misalignment in m."""

    pinion: FlankModification = PLAIN
    wheel: FlankModification = PLAIN
    misalignment: float = 0.0

    def pair(self, plain: ParallelAxes) -> Any:
        """Return a pair with these flanks."""
        gears = {name: replace(getattr(plain, name), modification=getattr(self, name)) for name in _GEARS}
        return replace(plain, **gears)  # type: ignore[call-arg]


_GEARS = ("pinion", "wheel")
_SHORT = FlankModification(tip_relief=10e-6, tip_relief_length=0.5 * M)
_LONG = FlankModification(tip_relief=25e-6, tip_relief_length=0.9 * M)
_ROUND = FlankModification(profile_crowning=8e-6)
_LEAD = FlankModification(helix_crowning=10e-6, tip_relief=8e-6, tip_relief_length=0.6 * M)
PROFILES = {
    "plain": Question(),
    "short tip relief on both": Question(_SHORT, _SHORT),
    "long tip relief": Question(_LONG),
    "profile crowning": Question(_ROUND),
}
ACROSS = {
    "misaligned": Question(misalignment=12e-6),
    "crowned, relieved, misaligned": Question(_LEAD, PLAIN, 12e-6),
}


@dataclass(frozen=True)
class Bodies:
    """Gears that questions are asked of; `options` are of `analyze`."""

    case: PairCase
    plain: ParallelAxes
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def forces(self) -> list[float]:
        """Normal forces, N, up to that of the table."""
        return replace(self.case, loads=LOADS).forces

    @property
    def questions(self) -> dict[str, Question]:
        """Questions by name. In the plane nothing acts across the face."""
        return PROFILES | (ACROSS if self.options else {})


def figures() -> list[Figure]:
    """Return the coverage."""
    return coverage_figures(assessed(), SUBJECT, _COVERAGE)


@cache
def assessed() -> tuple[Assessed, ...]:
    """Assess all answers."""
    return tuple(found for bodies in all_bodies() for found in study(bodies))


def all_bodies() -> list[Bodies]:
    """Return the pairs of the shared cases, each once and without its modifications."""
    found: dict[str, Bodies] = {}
    for case, options in [(case, {}) for case in plane_cases()] + [
        (c, {"model": "3d"}) for c in face_cases()
    ]:
        plain = Question().pair(case.pair)
        found.setdefault(repr((plain, options)), Bodies(case, plain, options))
    return list(found.values())


def study(bodies: Bodies, levels: Sequence[str] = LEVELS) -> Iterator[Assessed]:
    """Hold the live answers of a pair against the finest solution of the same flanks."""
    exact = _exact(bodies)
    for level in levels:
        live = _condensed(bodies, level)
        torques = live.checked.request.torque
        for name, question in bodies.questions.items():
            table = live.table(question.pair(bodies.plain), torques, question.misalignment)
            value, stated = quantities(table), together(errors_by_source(table), *SHARED)
            mesh = f"{'over the face' if bodies.options else 'corrected plane'}, {level}"
            yield Assessed(f"{bodies.case.name}: {name}", mesh, value, stated, np.abs(value - exact[name]))


def _exact(bodies: Bodies) -> dict[str, FloatArray]:
    """Return the quantities of every question of the finest solution, (5, loads) in m."""
    contact: PairContact | None = None
    found = {}
    for name, question in bodies.questions.items():
        checked = check_request(
            question.pair(bodies.plain),
            TableAxes(normal_forces=bodies.forces, misalignments=(question.misalignment,)),
            AnalysisOptions(level="fine", effects={"corner_contact": "on"}, **bodies.options),
        )
        if contact is None:
            contact = pair_contact(checked.request.pair, finest_plan(checked), FOLDER)
        found[name] = solved_finely(checked, replace(contact, pair=checked.request.pair))
    return found


def _condensed(bodies: Bodies, level: str) -> CondensedPair:
    """Analyze the plain pair and fetch its bodies, as the service does."""
    wish = {"normal_forces": bodies.forces, "level": level, "positions": 32, "cache": FOLDER}
    table = analyze(bodies.plain, **wish, **bodies.options)
    found = condensed_pair(bodies.plain, table, {}, FOLDER)
    if found is None:
        raise RuntimeError(f"the compliance of {bodies.case.name} is not in {FOLDER}, where it was put")
    return found


def publish(found: Sequence[Assessed], machine: Mapping[str, str]) -> None:
    """Write the section of accuracy.md."""
    groups = {"all": list(found)}
    groups |= {mesh: [one for one in found if one.level == mesh] for mesh in sorted({o.level for o in found})}
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    text = f"{head(found)}\n{coverage_table(groups)}\nMeasured with {versions}.\n"
    replace_section(PAGE, SECTION, text)


def head(found: Sequence[Assessed]) -> str:
    """Say what was assessed."""
    return (
        f"{len(all_bodies())} pairs on two meshes, {len(PROFILES)} profiles, over the face {len(ACROSS)} "
        f"more that are crowned or misaligned: {len(found)} answers of {len(LOADS)} loads.\n"
    )
