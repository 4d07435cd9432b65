"""JSON of records follows from their fields; changes are those of the figures."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bounds.types import FloatArray
from model_studies import Ablation, EffectAblation, FidelityResult, Figures, Frontier, Record, called, in_unit


@dataclass(frozen=True)
class Shift(Record):
    """An estimate."""

    size: float = field(metadata=in_unit("m"))


@dataclass(frozen=True)
class Waves(Figures):
    """Figures with amplitudes."""

    amplitudes: FloatArray = field(metadata=in_unit("n"))


@dataclass(frozen=True)
class Toggled(EffectAblation[Waves, Shift]):
    """An effect."""


@dataclass(frozen=True)
class All(Ablation[Waves, Toggled]):
    """An ablation."""

    mesh: tuple[str, ...]
    force: FloatArray = field(metadata=in_unit("n_m"))


@dataclass(frozen=True)
class Found(FidelityResult):
    """A result."""

    FIGURES = ("far", "near")

    far: float = float("nan")
    near: float = float("nan")


@dataclass(frozen=True)
class Study(Frontier[Found]):
    """A study."""

    count: int
    extra: object = field(default=None, metadata=called(None))


WITH = Waves(np.array([3.0, 4.0]), np.array([1.0, 2.0]), 6.0, np.array([[7.0, 8.0]]))
WITHOUT = Waves(np.array([2.0, 6.0]), np.array([1.5, 2.0]), 2.0, np.array([[7.5, 7.0]]))
EFFECT = Toggled("slip", True, "it is there", WITH, WITHOUT, Shift(0.5))
ABLATION = All(WITH, (EFFECT,), {"heat": "no source"}, ("first", "second"), np.array([1.0, 2.0]))
STUDY = Study(
    (Found("a", "A", 1.0, 0.5), Found("b", "B", 2.0, 0.1, 0.2)), {"c": "why"}, None, "a", 7, object()
)


def test_names_have_their_units_and_what_is_not_known_is_left_out():
    content = ABLATION.to_json()
    assert set(content) == {"nominal", "effects", "left_out", "mesh", "force_n_m"}
    assert set(content["nominal"]) == {"mean_m", "peak_to_peak_m", "cpu_seconds", "amplitudes_n"}
    study = STUDY.to_json()
    assert set(study) == {"rungs", "left_out", "knee", "chosen", "count", "reference"}
    assert study["reference"] == "b"
    assert study["rungs"][0] == {"name": "a", "title": "A", "cpu_seconds": 1.0, "far": 0.5}


def test_changes_are_without_less_with():
    content = EFFECT.to_json()
    assert content["mean_change_m"] == [-1.0, 2.0]
    assert content["peak_to_peak_change_m"] == [0.5, 0.0]
    assert content["amplitude_change_n"] == [[0.5, -1.0]]
    assert content["cost_ratio"] == 3.0
    assert EFFECT.toggled is WITHOUT
    assert Toggled("slip", False, "", WITH, WITHOUT, None).toggled is WITH


def test_the_worst_known_error_counts():
    first, second = STUDY.results
    assert (first.error, first.errors) == (0.5, {"far": 0.5})
    assert second.error == 0.2
    assert np.isnan(Found("x", "X", 1.0).error)
    assert STUDY.reference is second
