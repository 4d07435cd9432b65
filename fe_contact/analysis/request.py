"""What `analyze` was asked, checked and in one frozen object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property

from bounds import Finding
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, FaceLoadDistribution, FiniteWidth, LedgerEntry, compose
from fe_contact.effects.neglect import WITHOUT
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.planning import Accuracy, CycleCost
from fe_contact.plausibility import pair_findings
from fe_contact.types import FloatArray, Json

ON_VIOLATION = ("repeat", "fail", "report")


@dataclass(frozen=True)
class Request:
    """A checked request.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    load : ndarray
        Normal forces F_bn in N, increasing.
    accuracy : Accuracy
    misalignment, center_distance_change : ndarray
        Table axes, m.
    effects : mapping
        Effect name to "on", "off" or "auto".
    pitches : int, optional
        Base pitches that the table shall cover where teeth differ; None: until all repeats.
    on_violation : str
        What to do where an assumption of the run turns out wrong: "repeat", "fail" or "report".
    neglected, turned_on : mapping of str to str
        Automatic effects that are neglected because the accuracy does not need them, or on because a run
        without them showed that it does, and why.
    loads_as : str
        How the caller gave the load: "torques" or "normal_forces".
    """

    pair: ParallelAxes
    load: FloatArray
    accuracy: Accuracy
    misalignment: FloatArray
    center_distance_change: FloatArray
    effects: Mapping[str, str] = field(default_factory=dict)
    pitches: int | None = None
    on_violation: str = "repeat"
    neglected: Mapping[str, str] = field(default_factory=dict)
    turned_on: Mapping[str, str] = field(default_factory=dict)
    loads_as: str = "torques"

    def __post_init__(self) -> None:
        if self.on_violation not in ON_VIOLATION:
            raise InputError("on_violation", self.on_violation, f"one of {', '.join(ON_VIOLATION)}")

    @property
    def torque(self) -> FloatArray:
        """Torques on the driving gear in N m."""
        return self.pair.torque(self.load)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is implausible about it."""
        axes = self.misalignment, self.center_distance_change
        return pair_findings(self.pair, self.load, *axes, loads_as=self.loads_as)

    @property
    def alignments(self) -> tuple[int, int]:
        """Numbers of misalignments and of center distances."""
        return self.misalignment.size, self.center_distance_change.size

    @property
    def whole_scene(self) -> ContactScene:
        """What the effects assess by, before any was neglected."""
        alignments = self.misalignment, self.center_distance_change
        return ContactScene(self.pair, self.torque, *alignments, pitches=self.pitches)

    @property
    def scene(self) -> ContactScene:
        """What the effects assess by: what is neglected is not in it."""
        scene = self.whole_scene
        for name in self.neglected:
            scene = WITHOUT[name](scene)
        return scene

    @property
    def asked_choices(self) -> dict[str, str]:
        """Choice of each effect; an explicit model decides about the face and its finite width."""
        asked = {"3d": "on", "plane_strain": "off", "plane_stress": "off"}.get(self.accuracy.model)
        if asked is not None:
            return dict(self.effects) | {FaceLoadDistribution.name: asked, FiniteWidth.name: "off"}
        if self.effects.get(FaceLoadDistribution.name) == "on":
            return dict(self.effects) | {FiniteWidth.name: "off"}
        return dict(self.effects)

    @property
    def choices(self) -> dict[str, str]:
        """Choice of each effect, those that are neglected or turned on included."""
        decided = dict.fromkeys(self.neglected, "off") | dict.fromkeys(self.turned_on, "on")
        return self.asked_choices | decided

    def to_json(self) -> Json:
        """Return plain JSON in SI units: what decides the result."""
        return {
            "pair": asdict(self.pair),
            "normal_force": self.load.tolist(),
            "accuracy": asdict(self.accuracy),
            "misalignment": self.misalignment.tolist(),
            "center_distance_change": self.center_distance_change.tolist(),
            "effects": dict(sorted(self.effects.items())),
            "pitches": self.pitches,
            "on_violation": self.on_violation,
        }


@dataclass(frozen=True)
class Checked:
    """A request that can be computed, with the model its effects compose and their ledger.

    `cycle` is what a table over several base pitches costs, None for one pitch.
    """

    request: Request
    model: ContactModel
    ledger: tuple[LedgerEntry, ...]
    cycle: CycleCost | None = None

    @property
    def decided(self) -> dict[str, str]:
        """Every effect "on" or "off", as the whole request decides it."""
        return {entry.name: "on" if entry.on else "off" for entry in self.ledger}

    def assessing(self, name: str) -> tuple[ContactScene, dict[str, str]]:
        """Return the scene and the decisions by which the influence of an effect is estimated.

        Those of a neglected effect are of the scene with everything in it: without it there may be no model
        left that can show it.
        """
        request = self.request
        if name not in request.neglected:
            return request.scene, self.decided
        _, ledger = compose(request.whole_scene, request.asked_choices, EFFECTS)
        return request.whole_scene, {entry.name: "on" if entry.on else "off" for entry in ledger}
