"""A request with the model and the mesh that were decided for it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.ripple import expected_curves
from fe_contact.planning import (
    FaceDiscretization,
    MeshChoice,
    MeshOption,
    NodeRule,
    Plan,
    Prediction,
    expected_error,
    make_plan,
    predict_run,
)
from fe_contact.planning.effort import effort
from fe_contact.types import Json


@dataclass(frozen=True)
class Decided:
    """A request with its model and mesh.

    Attributes
    ----------
    checked : Checked
        With the chosen model, and a ledger that says why.
    mesh : MeshChoice
    plan : Plan
    wished : Decided, optional
        What the tolerance needs, where the time does not allow it.
    """

    checked: Checked
    mesh: MeshChoice
    plan: Plan
    wished: Decided | None = None

    def in_slices(self, count: int) -> Decided:
        """Return the same model and mesh in another number of slices; itself in the plane."""
        if not isinstance(self.plan.discretization, FaceDiscretization):
            return self
        made = self.plan.discretization.in_slices(count)
        mesh = replace(self.mesh, option=replace(self.mesh.option, slices=made.slices))
        return replace(self, mesh=mesh, plan=replace(self.plan, discretization=made))

    @property
    def usual_nodes(self) -> NodeRule:
        """The rule by which positions are placed before any refinement."""
        return self._plan(self.plan.level, None).nodes

    def refined(self, level: str, slices: int, nodes: NodeRule, reason: str) -> Decided:
        """Return the same model on another mesh, in other slices, with its positions placed by `nodes`."""
        plan = replace(self._plan(level, slices), nodes=nodes)
        request, model = self.checked.request, self.checked.model
        error = expected_error(request.pair, plan, expected_curves(self.checked))
        work = effort(request.pair, plan, model, request.alignments)
        option = MeshOption(level, plan.discretization.slices, error, work)
        return replace(self, mesh=MeshChoice(option, True, reason), plan=plan)

    def predicted(self, cache: Path | None) -> Prediction:
        """Predict what the run costs, with the compliances that are in the cache."""
        request = self.checked.request
        return predict_run(request.pair, self.plan, self.checked.model, request.alignments, cache)

    def _plan(self, level: str, slices: int | None) -> Plan:
        request = self.checked.request
        return make_plan(request.pair, request.load, request.options, self.checked.model, level, slices)

    def to_json(self) -> Json:
        """Return what was chosen, as plain JSON."""
        return {"model": model_name(self.checked)} | self.mesh.to_json()


def model_name(checked: Checked) -> str:
    """Name the model of a request in words."""
    if checked.model.across_face:
        return "three dimensions"
    if checked.request.options.model == "plane_stress":
        return "plane stress"
    corrected = "plane strain corrected for the finite width"
    return corrected if checked.model.finite_width else "plane strain"
