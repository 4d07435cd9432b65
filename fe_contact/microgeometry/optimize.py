"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter."""

from __future__ import annotations

import contextlib
import hashlib
import os
import struct
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bounds import engineering, written
from fe_contact.errors import SolveError
from fe_contact.microgeometry.confirmation import ConfirmedDesign, DesignStudy, confirm, design_study, rising
from fe_contact.microgeometry.design_problem import SLACK, Cancelled, DesignProblem, SearchProblem
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.optimization import (
    Optimization,
    OptimizationRequest,
    Outcome,
    Perturbation,
    excess,
    gain_of,
    outcome_of,
)
from fe_contact.microgeometry.scatter import MISALIGNMENT, Scatter
from fe_contact.microgeometry.search import (
    Cancel,
    Ended,
    Search,
    SearchRun,
    SequentialLinearProgramming,
    never,
    search_from,
)
from fe_contact.microgeometry.variables import GEARS, LENGTHS, QUANTITIES, DesignVariable
from fe_contact.options import Run
from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.ste.facts import SCHEMA_VERSION, content_hash
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, OrHere, Workers, WorkersLost, divided

# Assessed designs on disk: a search that was killed, or may use more evaluations, continues.


KEPT_FILES = 200
"""Newest files that a directory keeps: about 0.1 MB for a thousand designs each."""
_FOUND = struct.Struct("<ddQ")  # objective, violation, checksum
_POSITIONS = 8  # bytes of their digest

Figures = tuple[float, float]
REFINED = 4
"""Where they are exceeded by more, the search goes on at those positions, with a quarter of the designs."""
ROUNDS = 3
"""How often: the full analysis of another design has positions of its own, which join those of all before."""
STEP = 0.05
"""Perturbation of the optimum in parts of a variable's range, where it does not scatter."""
AT_BOUND = 1e-3
"""A variable this near to a bound, in parts of its range, lies on it."""


@dataclass(frozen=True)
class _DesignMemory:
    """Objective in m and violation of designs of one problem, `known` by their values and the positions."""

    file: Path
    known: dict[bytes, Figures] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, directory: Path, request: OptimizationRequest, evaluator: Evaluator) -> _DesignMemory:
        """Open the file of a problem; one that is damaged counts up to the damage."""
        digest = hashlib.sha256()
        contact = evaluator.contact
        for body in contact.plane or ():
            digest.update(body.matrix.tobytes())
        for solid in contact.face or ():
            digest.update(solid.blocks.tobytes())
        content = {
            "pair": written(request.pair),
            "variables": [variable.name for variable in request.variables],
            "bodies": digest.hexdigest(),
            "effects": dict(evaluator.choices),
            "load": evaluator.load.tolist(),
            "misalignment": evaluator.misalignment.tolist(),
            "scatter": request.scatter.to_json(),
            "objective": request.objective.to_json(),
            "limits": request.limits.to_json(),
        }
        key = content_hash(content, SOLVER_VERSION, SCHEMA_VERSION)
        memory = cls(directory / f"designs-{key}.bin")
        with contextlib.suppress(OSError):
            directory.mkdir(parents=True, exist_ok=True)
            files = sorted(directory.glob("designs-*.bin"), key=lambda file: file.stat().st_mtime)
            for file in files[:-KEPT_FILES]:
                file.unlink(missing_ok=True)
            memory._read(_POSITIONS + 8 * len(request.variables))
        return memory

    def find(self, values: FloatArray, position: FloatArray) -> Figures | None:
        """Return what is known of a design (d,) in m at some positions."""
        return self.known.get(_name(values, position))

    def add(self, values: FloatArray, position: FloatArray, figures: Figures) -> None:
        """Keep a design; where the file cannot be written it is kept in this process."""
        name = _name(values, position)
        self.known[name] = figures
        text = name + struct.pack("<dd", *figures)
        record = text + struct.pack("<Q", zlib.crc32(text))
        with contextlib.suppress(OSError), self.file.open("ab", buffering=0) as stream:
            stream.write(record)  # one write: whole, or the last of the file

    def _read(self, name_size: int) -> None:
        """Read whole records, and cut off what a killed writer left of one."""
        size, text = name_size + _FOUND.size, self.file.read_bytes() if self.file.exists() else b""
        whole = 0
        for begin in range(0, len(text) - size + 1, size):
            record = text[begin : begin + size]
            objective, violation, checksum = _FOUND.unpack(record[name_size:])
            if zlib.crc32(record[: name_size + 16]) != checksum:
                break
            self.known[record[:name_size]] = objective, violation
            whole = begin + size
        if whole < len(text):
            os.truncate(self.file, whole)


def _name(values: FloatArray, position: FloatArray) -> bytes:
    return hashlib.sha256(position.tobytes()).digest()[:_POSITIONS] + np.asarray(values, "<f8").tobytes()


# The best design of all searches, assessed by full analyses of it and of the design to begin with.


@dataclass(frozen=True)
class _Choice:
    """Both designs in full, and the search that the better one came from: `best` is its run of `problem`."""

    problem: DesignProblem
    start: ConfirmedDesign
    optimum: ConfirmedDesign
    runs: tuple[SearchRun, ...]
    best: int

    @property
    def run(self) -> SearchRun:
        """The search that counts."""
        return self.runs[self.best]


def _posed(study: DesignStudy, request: OptimizationRequest, memory: Path | None) -> DesignProblem:
    """Return the problem of the search, its scale the start inside the bounds.

    `memory` is a directory of designs that were assessed before. Raises `SolveError`: its contact cannot be
    solved.
    """
    problem = DesignProblem(
        study.evaluator, request.variables, request.limits, 1.0, objective=request.objective
    )
    if memory is not None:
        problem = replace(problem, memory=_DesignMemory.of(memory, request, study.evaluator))
    assessed = problem.assess(problem.place(request.own))
    if not np.isfinite(assessed.objective) or assessed.objective <= 0.0:
        raise SolveError("the contact of the start design cannot be solved at every position and load")
    return replace(problem, scale=assessed.objective)


def _choose(
    problem: DesignProblem,
    runs: tuple[SearchRun, ...],
    request: OptimizationRequest,
    study: DesignStudy,
    clock: StageClock,
    run: Run,
    cancel: Cancel,
) -> _Choice:
    """Confirm the start and the best of all runs; go on searching where that exceeds the limits after all."""
    best = min(range(len(runs)), key=lambda i: runs[i].assessed.order)
    with clock.stage("confirmation"):
        own = dict(zip(problem.names, request.own, strict=True))
        designs = own, problem.values(runs[best].place)
        seconds = len(designs) * study.decided.checked.predicted(study.decided.plan, run.cache).cpu_seconds
        shared = problem, study, run.cache
        start, optimum = divided(_to_the_end(run.workers, cancel), _confirmed, shared, designs, seconds)
    choice = _Choice(problem, start, optimum, runs, best)
    for _ in range(ROUNDS):
        if choice.optimum.violation <= SLACK or choice.run.assessed.violation > SLACK or cancel():
            break
        choice = _refined(choice, request.search, study, clock, run, cancel)
    return choice


def _confirmed(
    shared: tuple[DesignProblem, DesignStudy, Path | None], values: dict[str, float]
) -> ConfirmedDesign:
    """Analyze a design in full: one task."""
    problem, study, cache = shared
    return confirm(problem, values, study, cache)


def _refined(
    choice: _Choice, search: Search, study: DesignStudy, clock: StageClock, run: Run, cancel: Cancel
) -> _Choice:
    """Search on from a design that exceeds the limits between the positions of the search."""
    shorter = replace(
        search,
        method=SequentialLinearProgramming(sample=0),
        evaluations=max(1, search.evaluations // REFINED),
    )
    seen = choice.problem.evaluator.position, choice.optimum.harris_map.position
    evaluator = choice.problem.evaluator.at(np.union1d(*seen))
    problem = replace(choice.problem, evaluator=evaluator)
    with clock.stage("search"):
        place, workers = choice.run.place, run.workers
        further = search_from(problem, shorter, place, search.starts, cancel=cancel, workers=workers)
    with clock.stage("confirmation"):
        optimum = confirm(problem, problem.values(further.place), study, run.cache)
    return _Choice(problem, choice.start, optimum, (*choice.runs, further), len(choice.runs))


def _perturbation(best: tuple[DesignProblem, SearchRun, Scatter], variable: DesignVariable) -> Perturbation:
    """Take a step of one variable from the best design of a run to both sides: one task."""
    problem, run, scatter = best
    values = problem.values(run.place)
    step = scatter.modification.get(variable.name, STEP * (variable.high - variable.low))
    ends = max(variable.low, values[variable.name] - step), min(variable.high, values[variable.name] + step)
    changes = []
    for end in ends:
        evaluation = problem.evaluator.evaluate(values | {variable.name: end})
        changes.append(problem.objective.of(problem.evaluator.expected(evaluation)) - run.assessed.objective)
    return Perturbation(variable.name, *ends, *changes)


# The conclusion of an optimization in words: the gain, its end, and what was not tried.


def _conclusion(choice: _Choice, request: OptimizationRequest) -> tuple[Outcome, str]:
    outcome, ended = outcome_of(choice.start, choice.optimum), _ended(choice, request)
    if outcome is Outcome.LIMITS_EXCEEDED:
        over = f"{excess(choice.optimum)}{_worse(choice)}"
        return outcome, f"the best design exceeds the limits by {over}; {ended}"
    gain = gain_of(choice.start, choice.optimum)
    moved = "falls" if gain.value >= 0.0 else "rises"
    change = (
        f"expected peak-to-peak {moved} by {1e6 * abs(gain.value):.3g} µm, errors "
        f"{engineering(1e6 * gain.error, 2)} µm{_worse(choice)}"
    )
    if outcome is Outcome.IMPROVED:
        return outcome, f"{change}; {ended}"
    if outcome is Outcome.LIMITS_KEPT:
        return outcome, f"the limits are kept, which the start exceeds; {change}; {ended}"
    return outcome, f"{change}; {_why_not(choice, request, gain.error)}{ended}"


def _worse(choice: _Choice) -> str:
    """Name the torques at which the best design ripples more than the start, whether they count or not."""
    before, after = choice.start.harris_map, choice.optimum.harris_map
    worse = rising(before, after)
    if not worse.size:
        return ""
    torques = ", ".join(f"{torque:.6g}" for torque in before.torque[worse])
    most = worse[np.argmax((after.expected - before.expected)[worse])]
    change = f"{1e6 * before.expected[most]:.3g} to {1e6 * after.expected[most]:.3g} µm"
    return f"; it rises at {torques} N m, most at {before.torque[most]:.6g} N m from {change}"


def _ended(choice: _Choice, request: OptimizationRequest) -> str:
    """Say how the search ended; one that was interrupted may have had more to find in any of its starts."""
    cut = any(run.ended is Ended.CANCELLED for run in choice.runs)
    if cut or len(choice.runs) < request.search.starts:
        count = sum(run.evaluations for run in choice.runs)
        most = request.search.starts * request.search.evaluations
        return f"the search was interrupted after {count} of at most {most} designs"
    return "the search converged" if choice.run.converged else "the search used all its evaluations"


def _why_not(choice: _Choice, request: OptimizationRequest, error: float) -> str:
    if request.outside:
        return f"the start lies beyond the bounds of {', '.join(request.outside)}; "
    spread = max(run.spread for run in choice.runs)
    if choice.run.converged and spread <= error:
        return f"the variables have no influence: all designs lie within {engineering(1e6 * spread, 2)} µm; "
    return ""


def _not_tried(choice: _Choice, request: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
    """Say what the design is the best without: what did not vary, what did not scatter, what was left out."""
    names = _not_varied({variable.name for variable in request.variables})
    spread = (*((MISALIGNMENT,) if request.scatter.misalignment else ()), *request.scatter.modification)
    off = [name for name, choice_of in study.decided.checked.decided.items() if choice_of == "off"]
    bounds = _on_bounds(choice, request)
    starts = "one start" if request.search.starts == 1 else f"{request.search.starts} starts"
    untried = [
        f"wider bounds of {', '.join(bounds)}, which the optimum lies on" if bounds else "",
        f"other values of {', '.join(names)}" if names else "",
        f"scatter of anything but {', '.join(spread)}" if spread else "scatter of anything",
        f"neglected effects: {', '.join(off)}" if off else "",
        f"other searches than {starts} of {request.search.method.to_json()['method'].replace('_', ' ')}; "
        "ripple has many local minima",
        "other center distances, and torques without weight",
    ]
    return tuple(filter(None, untried))


def _not_varied(free: set[str]) -> list[str]:
    """Name the figures that stay, those of both gears once; lengths only of amounts that vary."""
    kept = {
        gear: [
            name
            for name in QUANTITIES
            if f"{gear}.{name}" not in free
            and (name not in LENGTHS or f"{gear}.{name.removesuffix('_length')}" in free)
        ]
        for gear in GEARS
    }
    both = [name for name in QUANTITIES if all(name in own for own in kept.values())]
    names = [f"{gear}.{name}" for gear, own in kept.items() for name in own if name not in both]
    return [*names, f"{', '.join(both)} of both gears"] if both else names


def _on_bounds(choice: _Choice, request: OptimizationRequest) -> list[str]:
    """Variables whose optimum lies on a bound that is not the end of what there is: nothing removed."""
    names = []
    for variable, part in zip(request.variables, np.asarray(choice.run.place), strict=True):
        low, high = part <= AT_BOUND, part >= 1.0 - AT_BOUND
        if high or (low and variable.low != 0.0):
            names.append(variable.name)
    return names


# Searches from several starts, here or by workers; cancelled, what they found so far is kept.


def search_all(
    problem: SearchProblem,
    search: Search,
    own: tuple[float, ...],
    run: Run,
    cancel: Cancel,
) -> tuple[SearchRun, ...]:
    """Search from every start; `own` is the design to begin with, m.

    At least one run: where the search is cancelled before any has ended, that of the design to begin with.
    """
    from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

    first = problem.place(own)
    others = qmc.Sobol(first.size, rng=search.seed).random_base2((search.starts - 1).bit_length())[
        1 : search.starts
    ]
    begins = list(enumerate([first, *others]))
    alone = search.starts == 1 or isinstance(run.workers, InProcess)
    search_from_each = _here if alone else _remotely
    runs = search_from_each(problem, search, begins, run, cancel)
    return tuple(runs) or (SearchRun(first, problem.assess(first), 1, Ended.CANCELLED, 0.0),)


def _here(
    problem: SearchProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    runs: list[SearchRun] = []
    for index, start in begins:
        if cancel():
            break

        def report(part: float, index: int = index) -> None:
            run.progress("search", (index + part) / search.starts)

        runs.append(search_from(problem, search, start, index, report, cancel, workers=run.workers))
    return runs


def _remotely(
    problem: SearchProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    """Let workers search; cancelled, keep what is there: a Ctrl-C may have ended some of them."""
    runs: list[SearchRun] = []
    try:
        for result in run.workers.run(_search_one, (problem, search), begins):
            runs.append(result)
            run.progress("search", len(runs) / search.starts)
            if cancel():
                break
    except Exception:
        if not cancel():
            raise
    return runs


def _to_the_end(workers: Workers, cancel: Cancel) -> Workers:
    """Return who does what follows a search: this process once that is cancelled."""
    if cancel() or isinstance(workers, InProcess):
        return InProcess()

    def told(lost: WorkersLost) -> None:
        if not cancel():
            raise lost

    return OrHere(workers, told)


def _search_one(shared: tuple[SearchProblem, Search], begin: tuple[int, FloatArray]) -> SearchRun:
    """Search from one start: one task; an interrupted worker gives what it has."""
    return search_from(*shared, begin[1], begin[0], ending=(Cancelled, KeyboardInterrupt))


def optimize(
    request: OptimizationRequest,
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    cancel: Cancel = never,
    memory: Path | None = None,
) -> Optimization:
    """Minimize the expected peak-to-peak transmission error over torques under scatter.

    The compliance of both gears is computed once; every design is a contact solve with other gaps. The best
    design and the start design are analyzed in full at the end, and the gain is stated with the errors of
    both.

    Parameters
    ----------
    request : OptimizationRequest
    run : Run
        Its workers run the searches, one per start; of a single start the designs and walks that do not wait
        for each other. They analyze the designs at the end.
    cancel : callable
        Asked before every design whether to end the search: the best so far is then analyzed in full, and
        the reason says so. Remote workers end their starts first.
    memory : Path, optional
        Directory of assessed designs: a search that was killed, or is repeated with more evaluations,
        continues with an identical result. Only for searches in this process.

    Raises
    ------
    InputError
        A value that cannot be used, by field name; a variable whose effect is off.
    MeshError, SolveError
        No acceptable mesh, or the contact of one of both designs cannot be solved.
    """
    clock = StageClock(run.workers.cost)
    torques = request.torques, request.further_torques
    study = design_study(request.space, *torques, clock, run, request.checked, request.limits)
    with clock.stage("search"):
        problem = _posed(study, request, memory)
        runs = search_all(problem, request.search, request.own, run, cancel)
    choice = _choose(problem, runs, request, study, clock, run, cancel)
    run.progress("confirmation", 1.0)
    with clock.stage("sensitivity"):
        place = choice.problem, choice.run, request.scatter
        workers = _to_the_end(run.workers, cancel)
        aside = tuple(divided(workers, _perturbation, place, request.variables))
    return _result(request, study, choice, aside, clock)


def _result(
    request: OptimizationRequest,
    study: DesignStudy,
    choice: _Choice,
    aside: tuple[Perturbation, ...],
    clock: StageClock,
) -> Optimization:
    outcome, reason = _conclusion(choice, request)
    return Optimization(
        outcome=outcome,
        reason=reason,
        variables=request.variables,
        torque=study.torque,
        misalignment=study.evaluator.misalignment,
        nodes=study.evaluator.nodes,
        start=choice.start,
        optimum=choice.optimum,
        runs=choice.runs,
        best_run=choice.best,
        sensitivity=aside,
        not_tried=_not_tried(choice, request, study),
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in choice.runs)},
        asked=request.to_json(study),
    )
