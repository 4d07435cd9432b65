"""What `analyze` was asked, checked and in one frozen object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from fe_contact.checks import finite, increasing, positive
from fe_contact.errors import InputError
from fe_contact.geometry import GearPair
from fe_contact.planning import Accuracy
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class Request:
    """A checked request.

    Attributes
    ----------
    pair : GearPair
    load : ndarray
        Normal forces F_bn in N, increasing.
    accuracy : Accuracy
    effects : mapping
        Effect name to "on", "off" or "auto".
    """

    pair: GearPair
    load: FloatArray
    accuracy: Accuracy
    effects: Mapping[str, str] = field(default_factory=dict)

    @property
    def torque(self) -> FloatArray:
        """Torques on the driving gear in N m."""
        return self.pair.torque(self.load)

    def to_json(self) -> Json:
        """Return plain JSON in SI units: what decides the result."""
        return {
            "pair": asdict(self.pair),
            "normal_force": self.load.tolist(),
            "accuracy": asdict(self.accuracy),
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


def refuse_beyond_plane(
    pair: GearPair, misalignments: Sequence[float], center_distance_changes: Sequence[float]
) -> None:
    """Refuse what a plane model cannot hold, naming the field."""
    if pair.pinion.helix_angle != 0.0:
        raise InputError(
            "pinion.helix_angle",
            pair.pinion.helix_angle,
            "0 for a plane model",
            "Helical gears need the 3-D model.",
        )
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if gear.modification.varies_along_face:
            raise InputError(
                f"{name}.modification", gear.modification, "constant along the face for a plane model",
                "Helix crowning, helix slope and end relief need the 3-D model.",
            )  # fmt: skip
    for name, values in (
        ("misalignments", misalignments),
        ("center_distance_changes", center_distance_changes),
    ):
        array = np.asarray([finite(f"{name}[{i}]", v) for i, v in enumerate(values)])
        if array.size != 1 or array[0] != 0.0:
            raise InputError(name, list(values), "[0.0] for a plane model", "This axis needs the 3-D model.")
