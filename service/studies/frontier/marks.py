"""What the accuracy studies of cases and scenes say alike of their fidelities."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from service.report.figure import number


class Fidelity(Protocol):
    """One fidelity that was run."""

    @property
    def name(self) -> str:
        """Key."""

    @property
    def title(self) -> str:
        """In words."""

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds."""

    @property
    def error(self) -> float:
        """Largest relative difference to the finest."""


class Study(Protocol):
    """An accuracy study of a case or a scene; the finest fidelity comes last."""

    @property
    def results(self) -> Sequence[Fidelity]:
        """Fidelities that were run."""

    @property
    def knee(self) -> str | None:
        """Name of the one at the knee."""

    @property
    def chosen(self) -> str | None:
        """Name of the one that was chosen."""


def mark(found: Study, name: str) -> str:
    """Return what a fidelity is: knee, chosen, reference."""
    marks = (("knee", found.knee), ("chosen", found.chosen), ("reference", found.results[-1].name))
    return ", ".join(mark for mark, marked in marks if marked == name)


def marked_name(found: Study, name: str) -> str:
    """Return the name of a fidelity with its marks."""
    marks, words = mark(found, name), name.replace("_", " ")
    return f"{words} ({marks})" if marks else words


def per_cent(value: float) -> str:
    """Write a relative error in per cent; nothing if it is not known."""
    return number(100.0 * value, 2) if np.isfinite(value) else ""


def quickest(found: Study) -> str:
    """Say the quickest fidelities below one per cent and one per mille."""
    parts = []
    for limit, text in ((0.01, "1 %"), (0.001, "0.1 %")):
        good = [each for each in found.results[:-1] if each.error <= limit]
        if good:
            best = min(good, key=lambda each: each.cpu_seconds)
            parts.append(f"within {text}: {best.title}, {number(best.cpu_seconds, 2)} CPU s")
    return f"Quickest rung {'; '.join(parts)}." if parts else "No rung comes within 1 % of the finest."
