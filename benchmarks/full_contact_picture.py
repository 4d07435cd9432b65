"""The picture on top of docs/accuracy.md: error against CPU time, our tables beside full contact."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.full_contact_cases import FullContactCase, full_contact_cases
from benchmarks.full_contact_coverage import quantities, reference
from fe_contact import analyze
from fe_contact.full_contact import solve_full_contact
from fe_contact.types import FloatArray
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel
from lineofaction.report.drawing.image import png

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "accuracy.png"
CASES = ("20/20", "20/20, 30 um over 3.5 mm", "24/72, ring", "35/42, tall teeth")
LEVELS = ("draft", "standard", "fine")
TIMED = (0.0, 0.3)
"""Positions at which full contact is timed."""


def draw() -> None:
    """Measure four pairs and write the picture."""
    cases = [case for case in full_contact_cases() if case.name in CASES]
    lines = [_lines(case, palette.category(i)) for i, case in enumerate(cases)]
    panels = tuple(
        Panel(
            Axis("CPU time, s, of curves under three loads", "log"),
            Axis(f"error of {name}, % of the mean", "log"),
            tuple(line for pair in lines for line in pair[q]),
            title=name.capitalize(),
        )
        for q, name in enumerate(("the mean", "peak-to-peak"))
    )
    words = "Tables of 0.6 to 10 CPU s are within 0.2 % of full contact, which takes 50 to 150 CPU s."
    PICTURE.write_bytes(
        png(Figure("accuracy", "Error against CPU time, plane strain", words, words, panels, None))
    )


def _lines(case: FullContactCase, color: str) -> list[list[Line]]:
    """Return the lines of mean and of peak-to-peak: three levels, and full contact's own error."""
    position, exact, error = reference(case.name)
    truth = quantities(position, exact)
    seconds, off = [], []
    for level in LEVELS:
        table = analyze(case.pair, normal_forces=case.forces, model="plane_strain", level=level)
        found = np.array([table.curve(force=force, at=position).ste for force in table.force]).T
        off.append(np.max(np.abs(quantities(position, found) - truth)[:2] / truth[0], axis=1))
        seconds.append(float(table.metadata.receipt["cpu_seconds"]))
    timed = solve_full_contact(case.pair, [float(t) for t in table.torque], list(TIMED), estimate_error=True)
    peer = float(np.mean(timed.cpu_seconds)) * position.size
    own = float(np.max(error.mean(axis=0) / truth[0]))
    return [_pair_of_lines(case.name, color, seconds, np.array(off)[:, q], peer, own) for q in range(2)]


def _pair_of_lines(
    name: str, color: str, seconds: list[float], off: FloatArray, peer: float, own: float
) -> list[Line]:
    """Return one pair's levels as a line and full contact as a point."""
    levels = Line(f"{name}: draft, standard, fine", np.array(seconds), 100.0 * off, color, markers=True)
    at = np.array([peer]), np.array([100.0 * own])
    return [levels, Line(f"{name}: full contact", *at, color, width=0.0, markers=True)]
