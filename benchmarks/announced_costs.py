"""Announced cost and time left of verbs against what they took, each in a process and a cache of its own."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

WITHIN = 1.5
"""Largest factor between an announcement and what was paid, and between times left."""
AFTER = 0.2
"""Fraction of the work from which on the time left is read."""
LONG = 3.0
"""CPU seconds that a work takes at least for its time left to count."""
_EXAMPLES = Path(__file__).parents[1] / "examples"
_DRAFT = ["--set", "accuracy.level=draft", "--set", "accuracy.positions=16"]
_SPEEDS = ["--speed-rpm", "300:6000:40"]
_PLANE, _FACE, _SCENE = (
    str(_EXAMPLES / name)
    for name in ("palermo_spur_20_20.toml", "helical_ev_23_67.toml", "palermo_scene.toml")
)
_SHAFTS = str(_EXAMPLES / "flexible_shafts_scene.toml")
VERBS: dict[str, list[str]] = {
    "analyze, plane": ["analyze", _PLANE],
    "analyze": ["analyze", _FACE, *_DRAFT],
    "flank": ["flank", _FACE, *_DRAFT],
    "root-stress": ["root-stress", _PLANE],
    "ablate": ["ablate", _FACE, *_DRAFT],
    "frontier": ["frontier", _PLANE],
    "sensitivity": ["sensitivity", _FACE, *_DRAFT],
    "optimize": ["optimize", _FACE, *_DRAFT],
    "optimize, plane": ["optimize", _PLANE, str(_EXAMPLES / "optimize_tip_relief.toml")],
    "scatter": ["scatter", _FACE, "--samples", "64", *_DRAFT],
    "sweep": ["sweep", _FACE, "--over", "torque,tip_relief=0:16:4", *_DRAFT],
    "modes": ["modes", _SCENE, *_SPEEDS],
    "response": ["response", _SCENE, *_SPEEDS],
    "steady": ["steady", _SCENE, "--speed-rpm", "1000:4000:4"],
    "simulate": ["simulate", _SCENE, "--set", "run.duration_s=0.2"],
    "study": ["study", _SCENE, str(_EXAMPLES / "study_torque_speed.toml")],
    "deflect": ["deflect", _SHAFTS],
}
"""Arguments of a verb by what is measured of it; small inputs, nothing in the cache."""
_CODE = """
import contextlib, importlib, io, os, re, sys, time
sys.argv = ["loa", *{arguments!r}, "-o", {output!r}]
from lineofaction.cli import commands, run_study
from lineofaction.gearbox.stages import PacedFraction
times = []
def recorded(module):
    own = module.progress_bar
    @contextlib.contextmanager
    def bar(stages=(), *more, **other):
        paced, began = PacedFraction(stages) if stages else None, time.process_time()
        def report(stage, fraction):
            done = fraction if paced is None else paced.at(stage, fraction, time.process_time())
            if done is not None:
                times.append([time.process_time() - began, done])
        yield report
        times.append([time.process_time() - began, 1.0])
    module.progress_bar = bar
for name in ("run_study", "simulate", "analyze"):
    recorded(importlib.import_module("lineofaction.cli." + name))
said = io.StringIO()
with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
    try:
        commands.main()
    except SystemExit as end:
        assert not end.code, said.getvalue()
about = re.search(r"about ([\\d.]+) CPU s", said.getvalue().replace("\\n", " "))
measured = {{"announced": about and float(about[1]), "times": times}}
"""


def figures() -> list[Figure]:
    """Return by verb the factor between announcement and cost, and between times left; then the medians."""
    rows, announced, left = [], [], []
    for name, arguments in VERBS.items():
        found = _measured(arguments)
        paid = found["process_cpu_seconds"]
        if found["announced"] is not None:
            announced.append(_factor(found["announced"], paid))
            rows.append(Figure(name, "announced over paid", found["announced"] / paid, "x"))
            rows.append(Figure(name, "factor between announced and paid", announced[-1], "x", WITHIN))
        if (factor := left_factor(found["times"])) is not None:
            left.append(factor)
            rows.append(Figure(name, "factor between times left after a fifth", factor, "x", WITHIN))

    for what, factors in (("announced and paid", announced), ("times left", left)):
        if factors:
            rows.append(Figure(f"{len(factors)} verbs", f"median factor, {what}", median(factors), "x"))
    return rows


def _measured(arguments: list[str]) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        code = _CODE.format(arguments=arguments, output=str(Path(folder) / "result.nc"))
        return measure(code, XDG_CACHE_HOME=folder)


def left_factor(times: list[list[float]]) -> float | None:
    """Return the factor between the time left that is stated and that is taken after the first fifth.

    `times`: CPU seconds and the fraction done, in order; None: the work is short, or has no fraction there.
    """
    end = times[-1][0] if times else 0.0
    for passed, done in times:
        if AFTER <= done < 1.0 and end > LONG:
            return _factor(passed * (1.0 - done) / done, max(end - passed, 1e-3))
    return None


def _factor(one: float, other: float) -> float:
    """Return the factor between two numbers, >= 1."""
    small, large = sorted((max(one, 1e-3), max(other, 1e-3)))
    return large / small
