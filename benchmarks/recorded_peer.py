"""Full contact that was solved once and recorded: rows of case, axes, STE and its error in um."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "tests" / "reference"
VALUES = ("ste_um", "error_um")


def recorded(name: str, case: str, axes: Sequence[str]) -> dict[tuple[float, ...], tuple[float, float]]:
    """Return STE of the peer and its own error in m by the values of the axes."""
    with (FOLDER / name).open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == case]
    return {
        tuple(float(row[axis]) for axis in axes): (1e-6 * float(row[VALUES[0]]), 1e-6 * float(row[VALUES[1]]))
        for row in rows
    }


def record(name: str, axes: Sequence[str], rows: Iterable[tuple[str, Sequence[float], float, float]]) -> None:
    """Write rows of case, values of the axes, STE and error in m, each as soon as it is solved."""
    with (FOLDER / name).open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("case", *axes, *VALUES))
        for case, at, ste, error in rows:
            writer.writerow((case, *(f"{n:g}" for n in at), f"{1e6 * ste:.6f}", f"{1e6 * error:.6f}"))
            file.flush()
