"""Changes are those of the figures; the worst known error counts."""

from dataclasses import dataclass, field

import numpy as np

from bounds.types import FloatArray, Json
from model_studies import EffectAblation, FidelityResult, Figures, Frontier, in_unit


@dataclass(frozen=True)
class Shift:
    """An estimate."""

    size: float

    def to_json(self) -> Json:
        return {"size_m": self.size}


@dataclass(frozen=True)
class Waves(Figures):
    amplitudes: FloatArray = field(metadata=in_unit("n"))


@dataclass(frozen=True)
class Toggled(EffectAblation[Waves, Shift]):
    """An effect."""


@dataclass(frozen=True)
class Found(FidelityResult):
    FIGURES = ("far", "near")

    far: float = float("nan")
    near: float = float("nan")


@dataclass(frozen=True)
class Study(Frontier[Found]):
    count: int


WITH = Waves(np.array([3.0, 4.0]), np.array([1.0, 2.0]), 6.0, np.array([[7.0, 8.0]]))
WITHOUT = Waves(np.array([2.0, 6.0]), np.array([1.5, 2.0]), 2.0, np.array([[7.5, 7.0]]))
EFFECT = Toggled("slip", True, "it is there", WITH, WITHOUT, Shift(0.5))
STUDY = Study((Found("a", "A", 1.0, 0.5), Found("b", "B", 2.0, 0.1, 0.2)), {"c": "why"}, None, "a", 7)


def test_changes_are_without_less_with():
    assert EFFECT.mean_change.tolist() == [-1.0, 2.0]
    assert EFFECT.peak_to_peak_change.tolist() == [0.5, 0.0]
    assert EFFECT.change("amplitudes").tolist() == [[0.5, -1.0]]
    assert EFFECT.cost_ratio == 3.0
    assert EFFECT.toggled is WITHOUT
    assert Toggled("slip", False, "", WITH, WITHOUT, None).toggled is WITH


def test_the_worst_known_error_counts():
    first, second = STUDY.results
    assert (first.error, first.errors) == (0.5, {"far": 0.5})
    assert second.error == 0.2
    assert np.isnan(Found("x", "X", 1.0).error)
    assert STUDY.reference is second
