"""What an effect is: one optional piece of physics that can be switched on or off.

An effect is a frozen dataclass in a file of its own. The composer knows none by name and applies them in any
order. Neutral settings (nothing to contribute) leave the results bit-identical.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ContactScene:
    """What the effects assess by.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    torque : ndarray
        Torques on the driving gear, N m.
    misalignment : ndarray
        Misalignments of the table axis, m: growth of the gap over the common face width in the plane of
        action, zero at its middle.
    center_distance_change : ndarray
        Changes of the table axis, m.
    pitches : int, optional
        Base pitches that the table shall cover where teeth differ; None: until all repeats.
    """

    pair: ParallelAxes
    torque: FloatArray
    misalignment: FloatArray = field(default_factory=lambda: np.zeros(1))
    center_distance_change: FloatArray = field(default_factory=lambda: np.zeros(1))
    pitches: int | None = None

    @property
    def largest_misalignment(self) -> float:
        """The misalignment that is largest in size, m; of two of one size the positive one."""
        return float(max(self.misalignment, key=lambda growth: (abs(growth), growth)))

    @property
    def at_nominal_load(self) -> ContactScene:
        """The scene at the load at which effects are sized: the highest, up to which a table is made."""
        return replace(self, torque=self.torque[-1:])


@dataclass(frozen=True)
class Verdict:
    """Whether a scene calls for an effect.

    Attributes
    ----------
    on : bool
    reason : str
        Why, in words an engineer would use.
    neutral : bool
        Whether the scene holds nothing that the effect could add: on or off is the same.
    """

    on: bool
    reason: str
    neutral: bool = False


class Effect(Protocol):
    """Interface of an effect.

    Class attributes: `name`; `needs` and `adds` (terms such as "position", "load", "gap", "coupling",
    "candidates", "table axis"); `cost` in words; `sources`; `valid_for`, the range in which it may be used.
    """

    name: ClassVar[str]
    needs: ClassVar[tuple[str, ...]]
    adds: ClassVar[tuple[str, ...]]
    cost: ClassVar[str]
    sources: ClassVar[tuple[str, ...]]
    valid_for: ClassVar[str]

    def called_for(self, scene: ContactScene) -> Verdict:
        """Assess whether `scene` needs this effect, and why."""
        ...

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Return `model` with this effect in it."""
        ...
