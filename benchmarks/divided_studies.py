"""Studies by one process and by two: wall time of fresh verbs by turns, and the CPU time of dividing."""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from benchmarks.boxed_scene import boxed_scene
from benchmarks.figures import Figure
from lineofaction.gearbox.subjects import scene_inputs

SUBJECT = "studies by two processes"
TARGET = 0.6
"""Wall time of two processes over that of one."""
TURNS = 2
_EXAMPLES = Path(__file__).parents[1] / "examples"
_SPUR, _SCENE = _EXAMPLES / "palermo_spur_20_20.toml", _EXAMPLES / "palermo_scene.toml"


def figures() -> Iterator[Figure]:
    """Yield of every study wall seconds by one process, and parts of them and of the CPU time by two."""
    with tempfile.TemporaryDirectory() as folder:
        for title, verb in _verbs(Path(folder)):
            _spent(verb, 1, folder)  # gears are condensed, code is compiled
            turns = [(_spent(verb, 1, folder), _spent(verb, 2, folder)) for _ in range(TURNS)]
            alone = median(one[0] for one, _ in turns)
            wall, cpu = (median(two[k] / one[k] for one, two in turns) for k in (0, 1))
            yield Figure(SUBJECT, f"{title}: one process", alone, "s")
            yield Figure(SUBJECT, f"{title}: two processes, part of that", wall, "-", TARGET)
            yield Figure(SUBJECT, f"{title}: CPU time of two processes over that of one", cpu, "-")


def _verbs(folder: Path) -> Iterator[tuple[str, list[str]]]:
    unit, boxed = folder / "unit", folder / "boxed.json"
    rexs = _EXAMPLES / "two_stage" / "two_stage.rexs"
    _run(["open", str(rexs), "--out", str(unit)], folder)
    yield "deflect, two stages", ["deflect", str(unit / "scene.toml"), str(unit / "load_cases.toml")]
    yield "optimize, spur", ["optimize", str(_SPUR), str(_EXAMPLES / "optimize_tip_relief.toml")]
    yield "ablate, spur", ["ablate", str(_SPUR)]
    yield "ablate, scene", ["ablate", str(_SCENE)]
    boxed.write_text(json.dumps(boxed_scene(scene_inputs(_SCENE))["scene"]), encoding="utf-8")
    speeds = ["--speed-rpm", "600,900,1200", "--orders", "2", "--no-band"]
    yield "noise by boundary elements", ["noise", str(boxed), *speeds, "--boundary-elements"]


def _spent(verb: list[str], workers: int, folder: str) -> tuple[float, float]:
    """Return wall and CPU seconds of a verb; what a search keeps of the turn before is removed."""
    shutil.rmtree(Path(folder) / "lineofaction" / "searches", ignore_errors=True)
    began, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    _run([*verb, "--workers", str(workers)], Path(folder))
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _run(verb: list[str], cache: Path) -> None:
    environment = os.environ | {"XDG_CACHE_HOME": str(cache)}
    environment.pop("LINEOFACTION_CACHE", None)
    program = [sys.executable, "-m", "lineofaction.cli", *verb]
    subprocess.run(program, check=True, env=environment, stdout=subprocess.DEVNULL)
