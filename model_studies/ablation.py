"""Ablation: every effect of a model is toggled by itself, and its change is compared with its estimate.

The *request* is the model with its effects on or off as decided. An effect that is toggled is off if the
request has it on, and on otherwise; all others stay.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from bounds.brief import brief
from bounds.types import FloatArray, Json
from model_studies.record import in_unit, under_key
from model_studies.result_record import ResultRecord

TRIFLE = 1e-3
"""Relative change below which an effect is negligible: a report lists such effects together."""


@dataclass(frozen=True)
class Figures:
    """The figures by which variants of a model are compared. Subclasses add further arrays."""

    mean: FloatArray = field(metadata=in_unit("m", "curve"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "curve"))
    """`mean`, `peak_to_peak`: Mean and peak-to-peak of the transmission error under every load, or of every
    mesh, m. Shape (n,) each.
    """
    cpu_seconds: float
    """Measured CPU time of the variant, s."""

    @property
    def cost(self) -> float:
        """CPU seconds by which variants are compared."""
        return self.cpu_seconds


class Estimate(Protocol):
    """Estimated change by leaving an effect out."""

    def to_json(self) -> Json:
        """Return plain JSON in SI units."""


F = TypeVar("F", bound=Figures)
E = TypeVar("E", bound=Estimate)


@dataclass(frozen=True)
class EffectAblation(Generic[F, E]):
    """One effect, with the figures of the model with and without it."""

    name: str
    on: bool
    """Whether the request has it on."""
    reason: str
    """Reason of the request's decision, from the effect ledger."""
    with_effect: F
    without_effect: F
    """`with_effect`, `without_effect`: Figures of both variants; one of them is the request itself."""
    estimate: E | None
    """Estimated change by leaving the effect out; None: not known."""

    @property
    def toggled(self) -> F:
        """The figures of the request with this effect toggled."""
        return self.without_effect if self.on else self.with_effect

    @property
    def mean_change(self) -> FloatArray:
        """Change (n,) of the mean transmission error without the effect, m."""
        return self.change("mean")

    @property
    def peak_to_peak_change(self) -> FloatArray:
        """Change (n,) of the peak-to-peak transmission error without the effect, m."""
        return self.change("peak_to_peak")

    @property
    def cost_ratio(self) -> float:
        """CPU time with the effect over that without."""
        return self.with_effect.cost / self.without_effect.cost

    def change(self, figure: str) -> FloatArray:
        """Return the change of an array of the figures without the effect, in its unit."""
        without, included = (getattr(figures, figure) for figures in (self.without_effect, self.with_effect))
        return np.asarray(without - included)


A = TypeVar("A", bound=EffectAblation[Any, Any])


@brief
@dataclass(frozen=True)
class Ablation(ResultRecord, Generic[F, A]):
    """All effects of a request, each toggled by itself."""

    nominal: F
    """Figures of the request itself."""
    effects: tuple[A, ...]
    omitted: dict[str, str] = field(metadata=under_key("left_out"))
    """Effects that were not toggled, and why."""
