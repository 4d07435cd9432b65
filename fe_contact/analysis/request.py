"""What `analyze` was asked, checked and in one frozen object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from fe_contact.checks import increasing, positive, within
from fe_contact.effects import ContactScene, FaceLoadDistribution
from fe_contact.errors import InputError
from fe_contact.geometry import GearPair
from fe_contact.planning import Accuracy
from fe_contact.types import FloatArray, Json

LARGEST_DEVIATION = 0.01
"""m; larger values of an axis are micrometres given as metres."""


@dataclass(frozen=True)
class Request:
    """A checked request.

    Attributes
    ----------
    pair : GearPair
    load : ndarray
        Normal forces F_bn in N, increasing.
    accuracy : Accuracy
    misalignment, center_distance_change : ndarray
        Table axes, m.
    effects : mapping
        Effect name to "on", "off" or "auto".
    """

    pair: GearPair
    load: FloatArray
    accuracy: Accuracy
    misalignment: FloatArray
    center_distance_change: FloatArray
    effects: Mapping[str, str] = field(default_factory=dict)

    @property
    def torque(self) -> FloatArray:
        """Torques on the driving gear in N m."""
        return self.pair.torque(self.load)

    @property
    def scene(self) -> ContactScene:
        """What the effects judge by."""
        return ContactScene(self.pair, self.torque, self.misalignment, self.center_distance_change)

    @property
    def choices(self) -> dict[str, str]:
        """Choice of each effect; an explicit model decides about the face load distribution."""
        asked = {"3d": "on", "plane_strain": "off", "plane_stress": "off"}.get(self.accuracy.model)
        return dict(self.effects) | ({FaceLoadDistribution.name: asked} if asked else {})

    def to_json(self) -> Json:
        """Return plain JSON in SI units: what decides the result."""
        return {
            "pair": asdict(self.pair),
            "normal_force": self.load.tolist(),
            "accuracy": asdict(self.accuracy),
            "misalignment": self.misalignment.tolist(),
            "center_distance_change": self.center_distance_change.tolist(),
            "effects": dict(sorted(self.effects.items())),
        }


def load_levels(
    pair: GearPair, torques: Sequence[float] | FloatArray | None, forces: Sequence[float] | FloatArray | None
) -> FloatArray:
    """Return the load levels as normal forces.

    Raises
    ------
    InputError
        Both or neither given, or not increasing and above zero.
    """
    if (torques is None) == (forces is None):
        raise InputError(
            "torques", torques, "given, or normal_forces instead", "Give exactly one of the two."
        )
    name, given = ("torques", torques) if torques is not None else ("normal_forces", forces)
    levels = increasing(name, given if given is not None else ())
    positive(
        f"{name}[0]", float(levels[0]), "Loads start above zero; the no-load curve is always in the table."
    )
    return pair.normal_force(levels) if torques is not None else levels


def axis(name: str, values: Sequence[float] | FloatArray) -> FloatArray:
    """Return a table axis in m, increasing.

    Raises
    ------
    InputError
        Not increasing, not finite, or larger than 1 cm: micrometres given as metres.
    """
    levels = increasing(name, values)
    for i, value in enumerate(levels):
        within(f"{name}[{i}]", float(value), -LARGEST_DEVIATION, LARGEST_DEVIATION, "In m: 30 um is 3e-5.")
    return levels


def refuse_beyond_plane(scene: ContactScene) -> None:
    """Refuse what a plane model cannot hold, naming the field."""
    pair, advice = scene.pair, "Use the 3-D model for it."
    if pair.pinion.helix_angle != 0.0:
        raise InputError("pinion.helix_angle", pair.pinion.helix_angle, "0 for a plane model", advice)
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if gear.modification.varies_along_face:
            bound = "constant along the face for a plane model"
            raise InputError(f"{name}.modification", gear.modification, bound, advice)
    if np.any(scene.misalignment != 0.0):
        raise InputError("misalignments", scene.misalignment.tolist(), "[0.0] for a plane model", advice)
