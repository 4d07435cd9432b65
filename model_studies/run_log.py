"""The log of predicted and measured cost, which improves the prediction of the next run.

Each line of the file is one stage of one run. The correction of a stage is the median of measured over
predicted time of its last runs, in logarithms. Two made-up runs that went as predicted are added: with them a
single odd run changes little, while many runs that agree prevail.
"""

from __future__ import annotations

import json
import math
import statistics
from collections import Counter
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from host.directories import atomic_file

FILE = "run-log.jsonl"
LAST = 40
"""Number of last runs of a stage that count."""
_MADE_UP = 2
_SHORTEST = 0.02
"""Shortest stage whose cost corrects predictions, s. Shorter ones read from the cache, or call libraries."""
_LARGEST_FILE = 32_000
"""Size in bytes above which only runs that count stay in the log: every run reads it."""


def corrections(cache: Path | None) -> dict[str, float]:
    """Return the correction of every stage that has been run: a factor on its predicted time."""
    if cache is None:
        return {}
    try:
        state = (cache / FILE).stat()
    except OSError:
        return {}
    return dict(_corrections(cache / FILE, state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=8)
def _corrections(file: Path, changed: int, size: int) -> tuple[tuple[str, float], ...]:
    """Return the corrections of a file in its state of this time and size.

    The state is the key of the cache: one plan predicts a run many times, once for every effect.
    """
    ratios: dict[str, list[float]] = {}
    for stage, ratio in _lines(file):
        ratios.setdefault(stage, []).append(math.log(ratio))
    made_up = [0.0] * _MADE_UP
    return tuple(
        (stage, math.exp(statistics.median([*logs[-LAST:], *made_up]))) for stage, logs in ratios.items()
    )


def record(cache: Path | None, predicted: Mapping[str, float], measured: Mapping[str, float]) -> None:
    """Add the stages of a run to the log.

    Parameters
    ----------
    cache : Path, optional
        Directory of the log; None: nothing is kept.
    predicted, measured : mapping
        CPU seconds by stage, predicted without corrections; stages in only one of the two, or shorter than
        20 ms, are left out.
    """
    if cache is None:
        return
    lines = [
        json.dumps({"stage": stage, "predicted": predicted[stage], "measured": measured[stage]})
        for stage in predicted.keys() & measured.keys()
        if min(predicted[stage], measured[stage]) >= _SHORTEST
    ]
    try:
        cache.mkdir(parents=True, exist_ok=True)
        file = cache / FILE
        if file.exists() and file.stat().st_size > _LARGEST_FILE:
            _shorten(file)
        with file.open("a", encoding="utf-8") as stream:
            stream.write("".join(f"{line}\n" for line in lines))
    except OSError:
        return


def _shorten(file: Path) -> None:
    """Keep the last runs of each stage, in their order; lines that cannot be read go."""
    counts: Counter[str] = Counter()
    kept: list[str] = []
    for line in reversed(file.read_text(encoding="utf-8", errors="replace").splitlines()):
        entry = _entry(line)
        if entry is not None and counts[entry[0]] < LAST:
            counts[entry[0]] += 1
            kept.append(line)
    with atomic_file(file) as draft:
        draft.write_text("".join(f"{line}\n" for line in reversed(kept)), encoding="utf-8")


def _lines(file: Path) -> list[tuple[str, float]]:
    """Return stage and measured over predicted time of every line that can be read."""
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return []
    return [entry for entry in map(_entry, text.splitlines()) if entry is not None]


def _entry(line: str) -> tuple[str, float] | None:
    """Return stage and measured over predicted time of a line; None where it cannot be read."""
    try:
        entry = json.loads(line)
        stage, ratio = entry["stage"], float(entry["measured"]) / float(entry["predicted"])
    except (ValueError, KeyError, TypeError, ZeroDivisionError):
        return None
    return (stage, ratio) if isinstance(stage, str) and math.isfinite(ratio) and ratio > 0.0 else None
