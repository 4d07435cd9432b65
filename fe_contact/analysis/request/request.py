"""The request to `analyze`, checked and in one frozen object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from bounds import Finding, written
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, Effect, LedgerEntry, compose, named
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.cost_model import Prediction, predict_run
from fe_contact.planning.cycle_cost import CycleCost
from fe_contact.planning.plan import Plan, make_plan
from fe_contact.planning.planned import chosen_mesh
from fe_contact.plausibility import pair_findings
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class Request:
    """A checked request."""

    pair: ParallelAxes
    load: FloatArray
    """Normal forces F_bn in N, increasing."""
    options: AnalysisOptions
    misalignment: FloatArray
    center_distance_change: FloatArray
    """`misalignment`, `center_distance_change`: Table axes, m."""
    pitches: int | None = None
    """Number of base pitches of the table where teeth differ; None: until the contact of all teeth repeats.
    """
    neglected: Mapping[str, str] = field(default_factory=dict)
    turned_on: Mapping[str, str] = field(default_factory=dict)
    """`neglected`, `turned_on`: Reason, by name of an automatic effect, why it is neglected or on.

    An effect is neglected because the accuracy does not need it, or on because a run without it showed that
    the accuracy does.
    """
    loads_as: str = "torques"
    """Kind of loads in the request: "torques" or "normal_forces"."""
    registry: Sequence[Effect] = field(default_factory=lambda: EFFECTS)
    """All effects that the request knows."""
    nodes_alone: bool = False
    """Whether the table is read at its nodes alone: nothing is inserted between them for a tolerance."""

    @classmethod
    def over(cls, pair: ParallelAxes, axes: TableAxes, options: AnalysisOptions) -> Request:
        """Return the request of a table over its axes."""
        alignments = axes.misalignment, axes.center_distance_change
        return cls(pair, axes.load(pair), options, *alignments, axes.pitches, loads_as=axes.loads_as)

    @property
    def torque(self) -> FloatArray:
        """Torques on the driving gear in N m."""
        return self.pair.torque(self.load)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Findings on implausible inputs."""
        axes = self.misalignment, self.center_distance_change
        return pair_findings(self.pair, self.load, *axes, loads_as=self.loads_as)

    @property
    def alignments(self) -> tuple[int, int]:
        """Numbers of misalignments and of center distances."""
        return self.misalignment.size, self.center_distance_change.size

    @property
    def complete_scene(self) -> ContactScene:
        """The scene with all effects, from which each effect assesses whether it is needed."""
        alignments = self.misalignment, self.center_distance_change
        return ContactScene(self.pair, self.torque, self.registry, *alignments, pitches=self.pitches)

    @property
    def scene(self) -> ContactScene:
        """The scene without the parts of neglected effects."""
        scene = self.complete_scene
        for name in self.neglected:
            scene = scene.effect(name).without(scene) or scene
        return scene

    def named(self, brings: str) -> str:
        """Return the name of the effect that brings a part of the model; empty: the registry has none."""
        return named(self.registry, brings)

    @property
    def model_effects(self) -> tuple[str, str]:
        """Names of the effects that decide about the model: the face, and the finite width of a plane."""
        return self.named("across_face"), self.named("finite_width")

    @property
    def requested_choices(self) -> dict[str, str]:
        """Choice of each effect; an explicit model decides about the face and its finite width."""
        face, width = self.model_effects
        chosen = {"3d": "on", "plane_strain": "off", "plane_stress": "off"}.get(self.options.model)
        if chosen is not None:
            return dict(self.options.effects) | {face: chosen, width: "off"}
        if self.options.effects.get(face) == "on":
            return dict(self.options.effects) | {width: "off"}
        return dict(self.options.effects)

    @property
    def model_chosen(self) -> bool:
        """Whether the caller chose the model, or one of the effects that decide about it."""
        return any(self.requested_choices.get(name, "auto") != "auto" for name in self.model_effects)

    @property
    def choices(self) -> dict[str, str]:
        """Choice of each effect, those that are neglected or turned on included."""
        overrides = dict.fromkeys(self.neglected, "off") | dict.fromkeys(self.turned_on, "on")
        return self.requested_choices | overrides

    def to_json(self) -> Json:
        """Return the inputs that decide the result as plain JSON in SI units."""
        return self.options.to_json() | {
            "pair": written(self.pair),
            "normal_force": self.load.tolist(),
            "misalignment": self.misalignment.tolist(),
            "center_distance_change": self.center_distance_change.tolist(),
            "pitches": self.pitches,
        }


@dataclass(frozen=True)
class Checked:
    """A request that can be computed, with the contact model its effects compose, and their ledger.

    `cycle` is the cost of a table over several base pitches; None: the table has one pitch.
    """

    request: Request
    model: ContactModel
    ledger: tuple[LedgerEntry, ...]
    cycle: CycleCost | None = None

    @property
    def decision(self) -> dict[str, str]:
        """Every effect "on" or "off", as the whole request decides it."""
        return {entry.name: "on" if entry.on else "off" for entry in self.ledger}

    def plan(self, level: str = "standard", slices: int | None = None) -> Plan:
        """Return the plan on meshes of a level, unless the accuracy names one; see `make_plan`."""
        request = self.request
        return make_plan(request.pair, request.load, request.options, self.model, level, slices)

    def planned(self, cache: Path | None) -> Plan:
        """Return the plan with the mesh and slices that the accuracy asks for; see `chosen_mesh`."""
        request = self.request
        choice = chosen_mesh(
            request.pair,
            request.load,
            request.options,
            self.model,
            request.alignments,
            cache,
            model_chosen=request.model_chosen,
        )
        return self.plan(choice.level, choice.slices)

    def predicted(self, plan: Plan, cache: Path | None, *, with_errors: bool = True) -> Prediction:
        """Predict the cost of the table by a plan; see `predict_run`."""
        pair, alignments = self.request.pair, self.request.alignments
        return predict_run(pair, plan, self.model, alignments, cache, with_errors=with_errors)

    @property
    def model_name(self) -> str:
        """The model in words."""
        if self.model.across_face:
            return "three dimensions"
        if self.request.options.model == "plane_stress":
            return "plane stress"
        corrected = "plane strain corrected for the finite width"
        return corrected if self.model.finite_width else "plane strain"

    def assessing(self, name: str) -> tuple[ContactScene, dict[str, str]]:
        """Return the scene and the decisions by which the influence of an effect is estimated.

        For a neglected effect they are those of the complete scene: the model without the effect may not be
        able to show its influence.
        """
        request = self.request
        if name not in request.neglected:
            return request.scene, self.decision
        _, ledger = compose(request.complete_scene, request.requested_choices)
        return request.complete_scene, {entry.name: "on" if entry.on else "off" for entry in ledger}
