"""An effect: one optional piece of physics that can be switched on or off.

An effect is a class in a file of its own: its decision, its contribution to the contact model, its parts that
act across the face, and the scene without it. The code that composes the contact model knows no effect by
name and applies effects in any order. An effect that has nothing to contribute is *neutral*: with it the
results are bit-identical. A *plane* model is a transverse section: nothing in it changes across the face.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ContactScene:
    """Pair, loads and axes of a table, by which effects decide."""

    pair: ParallelAxes
    torque: FloatArray
    """Torques on the driving gear, N m."""
    registry: Sequence[Effect]
    """All effects that the analysis knows."""
    misalignment: FloatArray = field(default_factory=lambda: np.zeros(1))
    """Misalignments of the table axis, m: growth of the gap over the common face width in the plane of
    action, zero at its middle.
    """
    center_distance_change: FloatArray = field(default_factory=lambda: np.zeros(1))
    """Changes of the center distance on the table axis, m."""
    pitches: int | None = None
    """Number of base pitches of the table where teeth differ; None: until the contact of all teeth repeats.
    """

    @property
    def largest_misalignment(self) -> float:
        """The misalignment that is largest in magnitude, m; of two with the same magnitude the positive."""
        return float(max(self.misalignment, key=lambda growth: (abs(growth), growth)))

    def effect(self, name: str) -> Effect:
        """Return the effect of a name."""
        return next(effect for effect in self.registry if effect.name == name)

    @property
    def gears(self) -> dict[str, Toothing]:
        """Both gears by name."""
        return {"pinion": self.pair.pinion, "wheel": self.pair.wheel}

    def with_gears(self, change: Callable[[Toothing], dict[str, object]]) -> ContactScene:
        """Return the scene with some fields of both gears changed."""
        changed: Any = {name: replace(gear, **change(gear)) for name, gear in self.gears.items()}  # type: ignore[arg-type]
        return replace(self, pair=replace(self.pair, **changed))

    @property
    def at_nominal_load(self) -> ContactScene:
        """The scene at the load at which effects are sized: the highest, up to which a table is made."""
        return replace(self, torque=self.torque[-1:])


@dataclass(frozen=True)
class Verdict:
    """The decision on an effect in a scene."""

    on: bool
    """Whether the scene calls for the effect."""
    reason: str
    """The reason of the decision, in words of an engineer."""
    neutral: bool = False
    """Whether the scene holds nothing that the effect could add: on or off is the same."""


class Effect:
    """An effect. Its defaults are those of an effect on the gap that a plane model can hold.

    Terms of `needs` and `adds` are for example "position", "load", "gap", "coupling", "table axis".
    """

    name: ClassVar[str]
    needs: ClassVar[tuple[str, ...]]
    """Terms of the model that the effect reads."""
    adds: ClassVar[tuple[str, ...]]
    """Terms of the model that the effect adds."""
    cost: ClassVar[str]
    """Cost of the effect, in words."""
    sources: ClassVar[tuple[str, ...]]
    """Literature and standards behind the effect."""
    valid_for: ClassVar[str]
    """Range in which the effect may be used, in words."""
    of_bodies: ClassVar[bool] = False
    """Whether the effect is in the finite elements of the bodies."""
    brings: ClassVar[str] = ""
    """Key of what this effect alone brings, by which other code finds the effect (`named`): a field of
    `ContactModel`, a direction of flank modifications, or an axis of the table."""

    def called_for(self, scene: ContactScene) -> Verdict:
        """Assess whether `scene` needs this effect, and why."""
        raise NotImplementedError

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Return `model` with this effect in it."""
        raise NotImplementedError

    def across_face(self, scene: ContactScene) -> str | None:
        """Return why the effect acts across the face, so that a plane cannot hold it; None: it does not."""
        return None

    def refuse_plane(self, scene: ContactScene) -> None:
        """Refuse parts of the effect that a plane model cannot hold, by field name; raises `InputError`."""

    def without(self, scene: ContactScene) -> ContactScene | None:
        """Return the scene as if there were nothing for the effect.

        None: the effect is never neglected within a tolerance, because it costs nothing or because the
        estimate of its influence is too coarse.
        """
        return None

    def extent(self, scene: ContactScene) -> Extent:
        """Return bounds of the change of the transmission error without the effect, at any position.

        A gap shifts the transmission error by no more than its bounds, also at single positions that a sample
        of positions misses. An effect without gaps acts alike at all positions; its bounds are empty.
        """
        model = self.contribute(scene, ContactModel())
        extent = sum((term.extent(scene.pair) for term in model.gaps), Extent())
        for term in model.tooth_gaps:
            teeth = np.arange((scene.pair.pinion, scene.pair.wheel)[term.gear].teeth)
            gaps = term.extents.at(term.tooth(teeth))
            extent += Extent(float(np.min(gaps.low)), float(np.max(gaps.high)))
        return extent

    def estimable(self, scene: ContactScene) -> bool:
        """Whether the slice model can estimate its influence."""
        return True


def named(registry: Sequence[Effect], brings: str) -> str:
    """Return the name of the effect whose `brings` is the key given; empty where there is none."""
    return next((effect.name for effect in registry if effect.brings == brings), "")


def across_face(scene: ContactScene) -> list[str]:
    """Return the parts of the scene that act across the face, in words."""
    pair = scene.pair
    reasons = []
    if pair.pinion.helix_angle != 0.0:
        reasons.append(f"helix angle {np.degrees(pair.pinion.helix_angle):.4g}°")
    reasons += [reason for effect in scene.registry if (reason := effect.across_face(scene))]
    if pair.pinion.face_width != pair.wheel.face_width or pair.axial_offset != 0.0:
        reasons.append("unequal or offset faces")
    return reasons
