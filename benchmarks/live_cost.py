"""Cost of a live answer for the service: CPU time of a slider's preview and of the whole answer at rest."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.figures import Figure
from host import cpu_seconds
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.subjects import case_of
from lineofaction.gearbox.tabled_scene import database_of
from service.live.answer import answer_of
from service.live.order import LiveOrder
from service.routes.queries import STE

_EXAMPLES = Path(__file__).parents[1] / "examples"
PAIRS = {
    "helical_ev_23_67": ("helical 23/67 in 18 slices", 120.0),
    "wind_turbine_high_speed": ("helical, high-speed stage of a wind turbine", 3000.0),
}
"""Example to its name and its torque in N m."""
_ANSWERS = 30
_TARGET_MS = 50.0


def figures() -> list[Figure]:
    """Analyze both pairs, then move the tip relief of the pinion step by step, as a slider does."""
    with tempfile.TemporaryDirectory() as folder:
        return [figure for name in PAIRS for figure in _of_pair(name, Path(folder))]


def _of_pair(name: str, folder: Path) -> Iterator[Figure]:
    table = database_of(CheckedCase(case_of(_EXAMPLES / f"{name}.toml")), folder)
    table.to_netcdf(folder / f"{name}.nc")
    words, torque = PAIRS[name]
    for preview, what, target in (
        (True, "a preview with its pressure and passage", _TARGET_MS),
        (False, "the whole answer, with its errors", None),
    ):
        ask = {"torque_n_m": [torque], "flanks": True, "passage": True, "preview": preview}
        spent = [_spent_ms(_order(name, folder, ask, 5.0 + 0.2 * step)) for step in range(_ANSWERS + 1)]
        yield Figure(words, f"{what}, median of {_ANSWERS}", median(spent[1:]), "ms CPU", target)


def _order(name: str, folder: Path, ask: dict[str, Any], relief_um: float) -> LiveOrder:
    pinion = {"tip_relief_um": relief_um, "tip_relief_length_mm": 0.8}
    files = {"file": str(folder / f"{name}.nc"), "cache": str(folder / "compliance")}
    return LiveOrder(STE, {"key": name, **files, "question": {**ask, "pinion": pinion}})


def _spent_ms(order: LiveOrder) -> float:
    """Return the CPU time of an answer with its JSON, ms."""
    begin = cpu_seconds()
    answer = answer_of(order)
    if answer.kind != "answer":
        raise RuntimeError(answer.body.decode() or answer.kind)
    return 1e3 * (cpu_seconds() - begin)
