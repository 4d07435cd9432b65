"""Cost of searches for designs by their sound, and the gain of the best design of the two-stage unit."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.figures import Figure
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.types import FloatArray
from host import cpu_seconds
from host.directories import cache_home
from lineofaction.gearbox.studies.change.question import flank_mesh
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.optimize import Inputs
from lineofaction.gearbox.studies.optimize.run import request_of
from lineofaction.gearbox.studies.optimize.sound_problem import HeardProblem
from lineofaction.gearbox.studies.optimize.sound_search import misalignments, sound_problem
from lineofaction.gearbox.workbench import tabled
from model_studies.workers import InProcess

SUBJECT = "two-stage unit, flanks of its second stage by what is heard"
UNIT = Path(__file__).parents[1] / "examples" / "two_stage" / "unit.py"
DRAWN, DESIGNS = 40, 1000
BUDGET, QUIETER = 600.0, 5.0
"""Limits: CPU seconds of all `DESIGNS`, and fall of the level at the loudest speed, dB."""
AMOUNTS = ("tip_relief", "profile_crowning", "profile_slope", "profile_form", "helix_crowning", "helix_slope")
GRADIENT = 2.0
"""Cost of a level with its gradient by `AMOUNTS` of both gears, over that of the level."""


def figures() -> list[Figure]:
    """Return what designs cost once the gears are known, and levels by whole analyses of the unit."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, str(UNIT), "-o", folder, "--quick"]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env=os.environ)
        rows = {line[:44].strip(): line[44:].split() for line in done.stdout.splitlines()}
        before, after = map(float, rows["loudest of all speeds"])
        costs, gradient = _costs(Path(folder)), _gradient(Path(folder))
    return [
        *costs,
        Figure(SUBJECT, "level and gradient by 12 amounts over the level", gradient, "", GRADIENT),
        Figure(SUBJECT, "loudest of all speeds before, tables deflected anew", before, "dB(A)"),
        Figure(SUBJECT, "loudest of all speeds after, tables deflected anew", after, "dB(A)"),
        Figure(SUBJECT, "louder by the flanks, whole analyses", after - before, "dB", -QUIETER),
    ]


def _costs(folder: Path) -> list[Figure]:
    """Return the cost of `DESIGNS` designs, with what is solved once, by `DRAWN` of them."""
    began = cpu_seconds()
    problem = _problem(folder)
    once = cpu_seconds() - began
    nominal = replace(problem, evaluator=replace(problem.evaluator, nodes=ONE_NODE))
    workers, few = InProcess(), problem.rough(16)
    ways: dict[str, Callable[[FloatArray], object]] = {
        "16 positions": lambda point: few.evaluated(few.values(point)),
        "16 positions, derivatives": lambda point: few.linearize(point, workers),
        "64 positions": lambda point: nominal.evaluated(nominal.values(point)),
        "64 positions, derivatives": lambda point: nominal.linearize(point, workers),
    }
    drawn = np.random.default_rng(0).random((DRAWN, len(problem.names)))
    rows = [Figure(SUBJECT, "tables, deflection and transfer functions, once", once, "CPU s")]
    for name, assess in ways.items():
        assess(drawn[0])  # loads code
        began = cpu_seconds()
        for point in drawn:
            assess(point)
        each = (cpu_seconds() - began) / DRAWN
        rows.append(Figure(SUBJECT, f"{DESIGNS} designs, {name}", DESIGNS * each, "CPU s", BUDGET - once))
    return rows


def _gradient(folder: Path) -> float:
    """Return the median ratio of a level with its gradient to the level, in turn at drawn designs."""
    variables = {gear: {f"{name}_um": [0.0, 5.0] for name in AMOUNTS} for gear in ("pinion", "wheel")}
    whole = _problem(folder, variables)
    problem, ratios = replace(whole, evaluator=replace(whole.evaluator, nodes=ONE_NODE)), []
    workers = InProcess()
    for point in np.random.default_rng(1).random((DRAWN, len(problem.names))):
        began = cpu_seconds()
        problem.evaluated(problem.values(point))
        between = cpu_seconds()
        problem.linearize(point, workers)
        ratios.append((cpu_seconds() - between) / (between - began))
    return float(np.median(ratios))


def _problem(folder: Path, variables: dict[str, Any] | None = None) -> HeardProblem:
    """Return the problem that the example searched, or one of other variables; its gears are known."""
    own = tomllib.loads((folder / "deflected" / "study.toml").read_text("utf-8"))
    study = Inputs.model_validate(own if variables is None else own | {"variables": variables})
    subject, question = tabled(folder / "before" / "cased.toml"), study.heard
    assert question is not None
    mesh = flank_mesh(subject.inputs, question.mesh)
    assert mesh.case is not None
    means = Means(cache_home(), lambda _stage, _part: None)
    skew = misalignments(subject, mesh, question, means)
    return sound_problem(subject, mesh, question, request_of(mesh.case, study), skew, means).problem
