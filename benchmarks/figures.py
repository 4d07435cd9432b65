"""One measured figure, and tables of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A measured value with its target: at most `limit`, or no target."""

    subject: str
    what: str
    value: float
    unit: str
    limit: float | None = None

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None without a target."""
        return None if self.limit is None else self.value <= self.limit


def markdown(figures: Sequence[Figure]) -> str:
    """Return one table of all figures."""
    head = "| subject | what | measured | target | met |\n|---|---|---:|---:|---|"
    return head + "\n" + "\n".join(_row(figure) for figure in figures) + "\n"


def _row(figure: Figure) -> str:
    """One figure as a row."""
    unit = "" if figure.unit == "-" else f" {figure.unit}"
    target = "" if figure.limit is None else f"at most {figure.limit:g}{unit}"
    met = {True: "yes", False: "**no**", None: ""}[figure.met]
    return f"| {figure.subject} | {figure.what} | {figure.value:.3g}{unit} | {target} | {met} |"
