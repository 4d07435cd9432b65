"""A peer beside the fidelities of an accuracy study: another way to the same numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from lineofaction.report.drawing.figure import FloatArray


@dataclass(frozen=True)
class Peer:
    """n points of a program that is no fidelity of the study: CPU seconds, relative errors by their names.

    `name` stands in the legend, `titles` and `mark` in the table, `note` beside each point. A line joins the
    points unless its `width` is 0.
    """

    name: str
    titles: tuple[str, ...]
    time: FloatArray
    errors: Mapping[str, FloatArray]
    mark: str
    color: str
    width: float
    note: str = ""
