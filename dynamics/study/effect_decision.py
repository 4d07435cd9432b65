"""The effects of the runs of a study, decided once before them.

The decision is made at the middle of the design and at both ends of every factor, the others in the middle;
or at all points, where these are fewer. An effect that is on at any of these points is on in all runs.

Axis letters: N points of the design, D points of the decision, f factors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.effects import EFFECTS
from dynamics.errors import InputError
from dynamics.influence import Decision, Influence, decide_effects, estimate_influences
from dynamics.influence.level_change import ROUNDING, in_decibels
from dynamics.scene import Scene
from dynamics.types import BoolArray, FloatArray, Json

Part = tuple[str, str]
"""An effect and the shaft or mesh in which it is on; or a field of a scene and the name of a part in it."""
_SAMPLED = ("normal", "uniform")  # kinds of factors with a distribution


@dataclass(frozen=True)
class PointDecision:
    """The decision at one point of a study."""

    choices: Mapping[str, str]
    """``"on"``, ``"off"`` or ``"auto"``, as the scene calls, for each effect that the scene leaves open."""
    active: tuple[Part, ...]
    """Effects that are on, each with the shaft or the mesh."""
    scene_parts: tuple[Part, ...]
    """Parts of the scene."""
    reasons: Mapping[str, str]
    """Reasons for effects that are on, or off by a tolerance, by effect."""
    influences: Mapping[str, Influence]
    seconds: float = 0.0
    """CPU time of the scene and of the decision, s."""

    @classmethod
    def of(cls, scene: Scene) -> PointDecision:
        """Decide the effects of one scene."""
        decision = decide_effects(scene)
        entries = decision.system().ledger.entries
        choices = {
            effect.name: decision.scene.effects.get(effect.name, "auto")
            for effect in EFFECTS
            if scene.effects.get(effect.name, "auto") == "auto"
        }
        calls = {entry.effect: f"{entry.part}: {entry.reason}" for entry in entries if entry.on}
        return cls(
            choices=choices,
            active=tuple((entry.effect, entry.part) for entry in entries if entry.on),
            scene_parts=_scene_parts(scene),
            reasons={**calls, **decision.automatic},
            influences=dict(decision.influences),
        )

    def parts(self, effect: str) -> tuple[str, ...]:
        """Return the parts in which an effect is on."""
        return tuple(part for name, part in self.active if name == effect)

    def size(self, effect: str) -> float:
        """Return the influence of an effect, dB; -1 where it is not known."""
        return self.influences[effect].decibels if effect in self.influences else -1.0


@dataclass(frozen=True)
class StudyEffects:
    """The decision on effects that all runs of a study share."""

    points: int
    """Number of points at which effects were decided."""
    choices: Mapping[str, str]
    """``"on"`` or ``"off"`` in all runs, for effects that are not as each scene calls for them."""
    reasons: Mapping[str, str]
    """Reasons for `choices`."""
    influences: Mapping[str, Influence]
    """Largest influence of every effect at the points."""
    active: tuple[str, ...]
    """Effects that are on in all runs, in any part."""
    scene_parts: tuple[Part, ...] = ()
    """Parts of the scenes at the points."""
    seconds: float = 0.0
    """CPU time of the decision, s."""

    @classmethod
    def of(cls, points: Sequence[PointDecision]) -> StudyEffects:
        """Return the decision from those at single points."""
        choices = {name: _choice(name, points) for name in (points[0].choices if points else ())}
        choices = {name: choice for name, choice in choices.items() if choice != "auto"}
        names = dict.fromkeys(name for point in points for name in point.influences)
        largest = {name: max(points, key=lambda point: point.size(name)) for name in names}
        active = {name for point in points for name, _ in point.active}
        return cls(
            points=len(points),
            choices=choices,
            reasons={name: _reason(name, choice, points) for name, choice in choices.items()},
            influences={name: point.influences[name] for name, point in largest.items()},
            active=tuple(effect.name for effect in EFFECTS if effect.name in active),
            scene_parts=tuple(dict.fromkeys(part for point in points for part in point.scene_parts)),
            seconds=sum(point.seconds for point in points),
        )

    def decision(self, scene: Scene) -> Decision:
        """Return the decision for one run.

        The run decides by itself where its scene has a part that no scene of the decision had, or does not
        fit the decision.
        """
        if not set(_scene_parts(scene)).issubset(self.scene_parts):
            return decide_effects(scene)
        chosen = replace(scene, effects={**scene.effects, **self.choices}) if self.choices else scene
        try:
            system = assemble(chosen)
        except InputError:
            return decide_effects(scene)
        influences = self.influences
        if influences and scene.outputs.receipt == "full":
            influences = {**influences, **estimate_influences(scene)}
        return Decision(chosen, dict(self.reasons), influences, assembled=(chosen, system))

    def to_json(self) -> Json:
        """Return plain JSON: what is on, what is neglected, and the largest influence among the neglected."""
        neglected = {name: size for name, size in self.influences.items() if name not in self.active}
        largest = max(neglected, key=lambda name: neglected[name].decibels, default=None)
        return {
            "points": self.points,
            "on": list(self.active),
            "neglected": {name: _size(influence) for name, influence in neglected.items()},
            "largest": None if largest is None else {"effect": largest, **_size(neglected[largest])},
            "cpu_seconds": self.seconds,
        }


def _scene_parts(scene: Scene) -> tuple[Part, ...]:
    """Return the parts of a scene that have a name, each with the field that has it."""
    return tuple(
        (name, str(part.name))
        for name, parts in vars(scene).items()
        if isinstance(parts, tuple)
        for part in parts
        if hasattr(part, "name")
    )


def _size(influence: Influence) -> Json:
    decibels = influence.decibels if influence.decibels > in_decibels(ROUNDING) else 0.0
    return {"decibels": decibels, "unit": influence.level.unit, "words": influence.text}


def _choice(effect: str, points: Sequence[PointDecision]) -> str:
    """Return the choice for all runs: that of all points where they agree, else on where it is on at any."""
    choices = {point.choices.get(effect, "auto") for point in points}
    parts = {point.parts(effect) for point in points}
    if len(choices) == 1 and len(parts) == 1:
        return choices.pop()
    return "on" if any(parts) else "off"


def _reason(effect: str, choice: str, points: Sequence[PointDecision]) -> str:
    """Return the reason for a choice: that of the point of the largest influence among those with it."""
    with_reason = [point for point in points if effect in point.reasons]
    alike = [point for point in with_reason if bool(point.parts(effect)) == (choice == "on")]
    point = max(alike or with_reason, key=lambda point: point.size(effect))
    source = f"by the largest of {len(points)} points"
    return f"{point.reasons[effect]}; the same in all runs of the study, {source}"


def decision_points(values: FloatArray, kinds: Sequence[str]) -> FloatArray:
    """Return the points (D, f) at which effects are decided for the points `values` (N, f) of a design.

    `kinds` (f) are those of its factors. The middle of a distribution is the median of its sample, that of
    levels is one of them; values of a list change together.
    """
    if len(values) <= 1 + 2 * len(kinds):
        return np.unique(values, axis=0)
    listed = np.array([kind == "list" for kind in kinds])
    middle = np.array([_middle(column, kind) for column, kind in zip(values.T, kinds, strict=True)])
    if np.any(listed):
        entries = np.unique(values[:, listed], axis=0)
        middle[listed] = entries[len(entries) // 2]
    points = [middle]
    for factor, column in enumerate(values.T):
        together: BoolArray = listed if listed[factor] else np.arange(len(kinds)) == factor
        for end in (np.argmin(column), np.argmax(column)):
            points.append(np.where(together, values[end], middle))
    return np.unique(points, axis=0)


def _middle(column: FloatArray, kind: str) -> float:
    levels = np.unique(column)
    return float(np.median(column)) if kind in _SAMPLED else float(levels[len(levels) // 2])
