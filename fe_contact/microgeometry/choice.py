"""The best design of all searches, assessed by full analyses of it and of the design to begin with."""

from __future__ import annotations

import contextlib
import hashlib
import os
import struct
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bounds import written
from fe_contact.errors import SolveError
from fe_contact.microgeometry.confirmation import ConfirmedDesign, DesignStudy, confirm
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.optimization import OptimizationRequest, Perturbation
from fe_contact.microgeometry.scatter import Scatter
from fe_contact.microgeometry.search import Cancel, Search, SearchRun, search_from
from fe_contact.microgeometry.search_method import SequentialLinearProgramming
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.stage_clock import StageClock
from fe_contact.ste.facts import SCHEMA_VERSION, content_hash
from fe_contact.types import FloatArray

# Assessed designs on disk: a search that was killed, or may use more evaluations, continues.


KEPT_FILES = 200
"""Newest files that a directory keeps: about 0.1 MB for a thousand designs each."""
_FOUND = struct.Struct("<ddQ")  # objective, violation, checksum
_POSITIONS = 8  # bytes of their digest

Figures = tuple[float, float]


@dataclass(frozen=True)
class _DesignMemory:
    """Objective in m and violation of designs of one problem, by their values and the positions.

    Attributes
    ----------
    file : Path
    known : dict
        What is in it.
    """

    file: Path
    known: dict[bytes, Figures] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, directory: Path, request: OptimizationRequest, evaluator: Evaluator) -> _DesignMemory:
        """Open the file of a problem; one that is damaged counts up to the damage."""
        content = {
            "pair": written(request.pair),
            "variables": [variable.name for variable in request.variables],
            "bodies": _digest_of_bodies(evaluator),
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
            _prune(directory)
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


def _digest_of_bodies(evaluator: Evaluator) -> str:
    """Digest of the compliance of both gears: its bits decide those of the objective."""
    digest = hashlib.sha256()
    contact = evaluator.contact
    for body in contact.plane or ():
        digest.update(body.matrix.tobytes())
    for solid in contact.face or ():
        digest.update(solid.blocks.tobytes())
    return digest.hexdigest()


def _prune(directory: Path) -> None:
    """Remove the oldest files."""
    files = sorted(directory.glob("designs-*.bin"), key=lambda file: file.stat().st_mtime)
    for file in files[:-KEPT_FILES]:
        file.unlink(missing_ok=True)


SLACK = 0.005
"""Limits exceeded by less, in parts of them, are kept: the full analysis has more positions than a search."""
REFINED = 4
"""Where they are exceeded by more, the search goes on at those positions, with a quarter of the designs."""
ROUNDS = 3
"""How often: the full analysis of another design has positions of its own, which join those of all before."""
STEP = 0.05
"""Perturbation of the optimum in parts of a variable's range, where it does not scatter."""


@dataclass(frozen=True)
class Choice:
    """Both designs in full, and the search that the better one came from.

    Attributes
    ----------
    problem : DesignProblem
        By which `run` was assessed.
    start, optimum : ConfirmedDesign
    runs : tuple of SearchRun
    best : int
        Index of the run of the optimum.
    """

    problem: DesignProblem
    start: ConfirmedDesign
    optimum: ConfirmedDesign
    runs: tuple[SearchRun, ...]
    best: int

    @property
    def run(self) -> SearchRun:
        """The search that counts."""
        return self.runs[self.best]


def posed(study: DesignStudy, request: OptimizationRequest, memory: Path | None) -> DesignProblem:
    """Return the problem of the search, its scale the start inside the bounds.

    `memory` is a directory of designs that were assessed before.

    Raises
    ------
    SolveError
        Its contact cannot be solved.
    """
    problem = DesignProblem(study.evaluator, request.variables, request.objective, request.limits, 1.0)
    if memory is not None:
        problem = replace(problem, memory=_DesignMemory.of(memory, request, study.evaluator))
    assessed = problem.assess(problem.place(request.own))
    if not np.isfinite(assessed.objective) or assessed.objective <= 0.0:
        raise SolveError("the contact of the start design cannot be solved at every position and load")
    return replace(problem, scale=assessed.objective)


def choose(
    problem: DesignProblem,
    runs: tuple[SearchRun, ...],
    request: OptimizationRequest,
    study: DesignStudy,
    clock: StageClock,
    cache: Path | None,
    cancel: Cancel,
) -> Choice:
    """Confirm the start and the best of all runs; go on searching where that exceeds the limits after all.

    Parameters
    ----------
    problem : DesignProblem
    runs : tuple of SearchRun
    request : OptimizationRequest
    study : DesignStudy
    clock : StageClock
    cache : Path, optional
    cancel : callable
    """
    best = min(range(len(runs)), key=lambda i: runs[i].assessed.order)
    with clock.stage("confirmation"):
        start = confirm(problem, dict(zip(problem.names, request.own, strict=True)), study, cache)
        optimum = confirm(problem, problem.values(runs[best].place), study, cache)
    choice = Choice(problem, start, optimum, runs, best)
    for _ in range(ROUNDS):
        if choice.optimum.violation <= SLACK or choice.run.assessed.violation > SLACK or cancel():
            break
        choice = _refined(choice, request.search, study, clock, cache, cancel)
    return choice


def _refined(
    choice: Choice, search: Search, study: DesignStudy, clock: StageClock, cache: Path | None, cancel: Cancel
) -> Choice:
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
        run = search_from(problem, shorter, choice.run.place, search.starts, cancel=cancel)
    with clock.stage("confirmation"):
        optimum = confirm(problem, problem.values(run.place), study, cache)
    return Choice(problem, choice.start, optimum, (*choice.runs, run), len(choice.runs))


def perturbation(
    problem: DesignProblem, run: SearchRun, scatter: Scatter, variable: DesignVariable
) -> Perturbation:
    """Take a step of one variable from the best design of a run to both sides."""
    values = problem.values(run.place)
    step = scatter.modification.get(variable.name, STEP * (variable.high - variable.low))
    ends = max(variable.low, values[variable.name] - step), min(variable.high, values[variable.name] + step)
    changes = []
    for end in ends:
        evaluation = problem.evaluator.evaluate(values | {variable.name: end})
        changes.append(problem.objective.of(problem.evaluator.expected(evaluation)) - run.assessed.objective)
    return Perturbation(variable.name, *ends, *changes)
