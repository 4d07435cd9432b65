"""Choice of the model by a tolerance or a time budget, among the models that can hold the scene.

A spur pair with nothing acting across its face may be computed in the plane, in the plane corrected for its
finite width, or in three dimensions: the cheapest that is expected to meet the request is taken. An
explicit model, or an explicit choice of one of the two effects that decide about the model, is obeyed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from bounds import engineering
from fe_contact.analysis.request.expected_curves import expected_curves
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.effects.influence.estimate import estimate_influence
from fe_contact.options import LEVELS, AnalysisOptions
from fe_contact.planning.cost_model import Prediction, effort
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.expected_curves import ExpectedCurves
from fe_contact.planning.expected_error import expected_error
from fe_contact.planning.plan import NodeRule, Plan
from fe_contact.planning.planned import MeshChoice, MeshOption, chosen_mesh, mesh_options
from fe_contact.types import Json

WIDTH_SHARE = 0.8
"""Part of the tolerance that the estimated change by the finite width may reach: estimates for
peak-to-peak are 0.8 of the measured change in the median (docs/lab/index.md)."""

TRIED_WORK = 0.1
"""Largest work of a mesh that is tried first, over the work of the mesh that is expected to be needed."""


class _Choice(NamedTuple):
    """A request with a model, and the mesh chosen for it."""

    checked: Checked
    mesh: MeshChoice

    @property
    def decision(self) -> Decision:
        """The choice with its plan."""
        return Decision(*self, self.checked.plan(self.mesh.level, self.mesh.slices))


@dataclass(frozen=True)
class Decision:
    """A request with its model and mesh."""

    checked: Checked
    """Request with the chosen model, and a ledger that states the reason."""
    mesh: MeshChoice
    plan: Plan
    wished: Decision | None = None
    """Decision that the tolerance needs, where the time does not allow it."""
    behind: Decision | None = None
    """Decision that is expected to follow, where a mesh that may miss the tolerance is tried first."""

    @property
    def passes(self) -> tuple[Decision, ...]:
        """The request and the request that is expected to follow it."""
        return (self,) if self.behind is None else (self, self.behind)

    def in_slices(self, count: int) -> Decision:
        """Return the same model and mesh in another number of slices; itself in the plane."""
        if not isinstance(self.plan.discretization, FaceDiscretization):
            return self
        discretization = self.plan.discretization.in_slices(count)
        mesh = replace(self.mesh, option=replace(self.mesh.option, slices=discretization.slices))
        return replace(self, mesh=mesh, plan=replace(self.plan, discretization=discretization))

    @property
    def usual_nodes(self) -> NodeRule:
        """The rule by which positions are placed before any refinement."""
        return self.checked.plan(self.plan.level).nodes

    def refined(self, level: str, slices: int, nodes: NodeRule, reason: str) -> Decision:
        """Return the same model on another mesh, in other slices, with its positions placed by `nodes`."""
        plan = replace(self.checked.plan(level, slices), nodes=nodes)
        request, model = self.checked.request, self.checked.model
        curves = expected_curves(self.checked)
        error = expected_error(request.pair, plan, curves, model_chosen=request.model_chosen)
        work = effort(request.pair, plan, model, request.alignments)
        option = MeshOption(level, plan.discretization.slices, error, work)
        return replace(self, mesh=MeshChoice(option, met=True, reason=reason), plan=plan)

    def predicted(self, cache: Path | None) -> Prediction:
        """Predict the cost of the run, with the compliances that are in the cache."""
        return self.checked.predicted(self.plan, cache)

    def to_json(self) -> Json:
        """Return the chosen model and mesh as plain JSON."""
        return {"model": self.checked.model_name} | self.mesh.to_json()


def decide(
    checked: Checked, cache: Path | None = None, *, keep_model: bool = False, tried: bool = False
) -> Decision:
    """Choose model, mesh and slices by the accuracy of a request.

    Parameters
    ----------
    cache : Path, optional
        Directory of compliances and of what is known of the host: a time depends on them.
    keep_model : bool
        Choose mesh and slices only: the request is for more than the transmission error.
    tried : bool
        The run measures its errors and is refined where they are too large. So a mesh that is expected to
        miss the tolerance is tried first where it costs next to nothing (`TRIED_WORK`). The expected cost of
        all passes never falls as the tolerance becomes tighter.
    """
    options = checked.request.options
    if options.tolerance is not None and options.time_budget is not None:
        return _within_time(checked, cache, keep_model=keep_model, tried=tried)
    models = [checked] if keep_model else alternative_requests(checked)
    curves = expected_curves(checked) if _has_goal(checked) or checked.model.across_face else None
    chosen = _best(_meshes(models, curves, cache))
    trial = _trial(models, chosen.mesh, curves) if tried and options.tolerance is not None else None
    if trial is None:
        return chosen.decision
    model, option = trial
    dearer = f"{chosen.checked.model_name}, {chosen.mesh.option.name}"
    reason = f"expected error {option.error.text}, tried first: at most a tenth of the work of {dearer}"
    first = _Choice(model, MeshChoice(option, chosen.mesh.met, reason))
    return replace(first.decision, behind=chosen.decision)


def _trial(
    models: Sequence[Checked], choice: MeshChoice, curves: ExpectedCurves | None
) -> tuple[Checked, MeshOption] | None:
    """Return the most exact mesh whose cost is negligible against the chosen one, with its model, or None.

    Costs are compared at the usual positions, without those that a tolerance asks for: so a mesh that is
    tried before a dearer one costs no less. The uncorrected plane is left out, since a tighter tolerance
    would not try it.
    """
    usual = [_options(model, curves, usual=True) for model in models[-2:]]
    works = [option.effort for options in usual for option in options if option.name == choice.option.name]
    cheap = [
        (model, option)
        for model, usual_options in zip(models[-2:], usual, strict=True)
        for option, usual_option in zip(_options(model, curves), usual_options, strict=True)
        if usual_option.effort <= TRIED_WORK * max(works)
    ]
    return min(cheap, key=lambda trial: trial[1].error.reducible, default=None)


def _options(checked: Checked, curves: ExpectedCurves | None, *, usual: bool = False) -> list[MeshOption]:
    """Return all meshes of a model, at the positions for its tolerance or at the `usual` ones."""
    request, options = checked.request, checked.request.options
    options = replace(options, tolerance=None) if usual else options
    arguments = request.pair, request.load, options, checked.model, request.alignments
    return mesh_options(*arguments, curves, model_chosen=request.model_chosen)


def _within_time(checked: Checked, cache: Path | None, *, keep_model: bool, tried: bool) -> Decision:
    """Choose a mesh that meets the tolerance within the time budget; else the most exact within it."""
    options = checked.request.options
    budget = options.time_budget or 0.0

    def chosen(relaxed: AnalysisOptions) -> Decision:
        """Decide by one of the two goals, and return the decision for the options with both."""
        request = replace(checked.request, options=relaxed)
        decision = decide(replace(checked, request=request), cache, keep_model=keep_model, tried=tried)
        request = replace(decision.checked.request, options=options)
        return replace(decision, checked=replace(decision.checked, request=request))

    wished = chosen(replace(options, time_budget=None))
    seconds = wished.predicted(cache).cpu_seconds
    if seconds <= budget:
        return wished
    fits = chosen(replace(options, tolerance=None))
    option = fits.mesh.option
    # with the tolerance among its options, its error is stated relative to the scale of the tolerance
    fits = fits.refined(option.level, option.slices, fits.plan.nodes, fits.mesh.reason)
    needs = f"{wished.mesh.option.name} is predicted to take {engineering(seconds, 2)} CPU s of {budget:.3g}"
    error = f"expected error {fits.mesh.option.error.text}"
    mesh = MeshChoice(fits.mesh.option, met=False, reason=f"{needs}; {fits.mesh.reason}, {error}")
    return replace(fits, mesh=mesh, wished=wished)


def _meshes(models: Sequence[Checked], curves: ExpectedCurves | None, cache: Path | None) -> list[_Choice]:
    """Return the mesh of each model; not of three dimensions where the coarsest one in the plane will do."""
    choices: list[_Choice] = []
    for model in models:
        coarsest_will_do = any(mesh.met and mesh.level == LEVELS[0] for _, mesh in choices)
        if not (model.model.across_face and coarsest_will_do):
            choices.append(_Choice(model, _mesh(model, curves, cache)))
    return choices


def _has_goal(checked: Checked) -> bool:
    options = checked.request.options
    return options.tolerance is not None or options.time_budget is not None


def alternative_requests(checked: Checked) -> list[Checked]:
    """Return the request with every model that may replace its own; itself where the model is fixed."""
    request = checked.request
    face, width = request.model_effects
    overridden = set(request.model_effects) & {*request.neglected, *request.turned_on}
    if not _has_goal(checked) or request.model_chosen or overridden or checked.model.across_face:
        return [checked]
    plain = replace(request, neglected={**request.neglected, width: "left out"})
    solid = replace(request, turned_on={**request.turned_on, face: "taken"})
    flat = [_rechecked(plain)] if _width_is_small(checked) else []
    return [*flat, checked, _rechecked(solid)]


def next_model(checked: Checked) -> Decision | None:
    """Return the request in the next more exact model that is expected to meet its tolerance.

    None where there is none, or where the caller chose the model or one of the effects that decide about it.
    """
    request, model_effects = checked.request, checked.request.model_effects
    if checked.model.across_face or request.model_chosen:
        return None
    neglected = {name: text for name, text in request.neglected.items() if name not in model_effects}
    turned_on = {name: text for name, text in request.turned_on.items() if name not in model_effects}
    face, width = model_effects
    curves = expected_curves(checked)
    for name in (width, face) if width in request.neglected else (face,):
        model = _rechecked(replace(request, neglected=neglected, turned_on={**turned_on, name: "taken"}))
        choice = _Choice(model, _mesh(model, curves, None))
        if choice.mesh.met:
            return _with_reasons(choice).decision
    return None


def _width_is_small(checked: Checked) -> bool:
    """Whether the influence of the finite width on this very case is estimated to be within the tolerance.

    Where a modification has made the ripple small, it changes by more than the mean. The expected error of
    plane strain, which is that of usual cases, does not contain this.
    """
    tolerance = checked.request.options.tolerance
    if tolerance is None:
        return True
    _, width = checked.request.model_effects
    influence = estimate_influence(*checked.assessing(width), width, tolerance.least_scale)
    return influence is not None and influence.largest <= WIDTH_SHARE * tolerance.relative


def _rechecked(request: Request) -> Checked:
    return checked_request(request, neglect=False)


def _mesh(checked: Checked, curves: ExpectedCurves | None, cache: Path | None) -> MeshChoice:
    request = checked.request
    arguments = request.pair, request.load, request.options, checked.model, request.alignments
    return chosen_mesh(*arguments, cache, curves, model_chosen=request.model_chosen)


def _best(choices: Sequence[_Choice]) -> _Choice:
    """Return the cheapest that meets a tolerance, the most exact that meets a time, else the most exact."""
    if len(choices) == 1:
        return choices[0]
    good = [choice for choice in choices if choice.mesh.met]
    by_time = choices[0].checked.request.options.time_budget is not None
    if good and not by_time:
        return _with_reasons(min(good, key=lambda choice: choice.mesh.option.effort))
    return _with_reasons(min(good or choices, key=lambda choice: choice.mesh.option.error.reducible))


def _with_reasons(choice: _Choice) -> _Choice:
    """Return a choice whose ledger states why an effect of the model is neglected, or turned on."""
    request, error = choice.checked.request, choice.mesh.option.error
    total, plane, method = (engineering(100.0 * e, 2) for e in (error.total, error.plane, error.method))
    text = f"expected error {total} %, of which the plane {plane} % and the method {method} %"
    neglected, turned_on = dict(request.neglected), dict(request.turned_on)
    for reasons in (neglected, turned_on):
        for name in request.model_effects:
            # the choice itself has switched the effect, not the caller
            if reasons.get(name) in ("taken", "left out"):
                reasons[name] = f"{reasons[name]} for the requested accuracy: {text}"
    if (neglected, turned_on) == (dict(request.neglected), dict(request.turned_on)):
        return choice
    return choice._replace(checked=_rechecked(replace(request, neglected=neglected, turned_on=turned_on)))
