"""Check of the arguments of `analyze`: a request that can be computed, or one clear error."""

from __future__ import annotations

from dataclasses import replace

from bounds import Text, at_least, warn_of
from fe_contact.analysis.request.neglected_effects import neglected_effects
from fe_contact.analysis.request.plane_limits import refuse_beyond_plane
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.compliance.rounding import LARGEST_ROUNDING, least_face_width
from fe_contact.contact import ContactModel
from fe_contact.effects import LedgerEntry, compose
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh import SectorRecipe
from fe_contact.options import AnalysisOptions, OperatingPoint, TableAxes
from fe_contact.planning.cycle_cost import CycleCost
from fe_contact.planning.plan import make_plan
from host import require


def check_request(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    check_size: bool = True,
    neglect: bool = True,
) -> Checked:
    """Check all inputs of a table, without computing anything.

    Raises `InputError`: a value that cannot be used, by field name.

    Parameters
    ----------
    check_size : bool
        False leaves out the limit on the size of a table.
    neglect : bool
        False leaves out the decision about effects that a tolerance does not need, which takes some
        milliseconds of solving.

    Warns
    -----
    PlausibilityWarning
        Once for each thing about the request that is far from practice.
    """
    checked = checked_request(Request.over(pair, axes, options), check_size=check_size, neglect=neglect)
    warn_of(checked.request.findings)
    return checked


def as_checked(
    pair: ParallelAxes | Checked,
    at: TableAxes | OperatingPoint | None,
    options: AnalysisOptions,
    *,
    neglect: bool = True,
) -> Checked:
    """Check the inputs of a table or of one point, as `check_request` does; checked inputs pass unchanged.

    Raises `InputError`: a value that cannot be used, or no loads, by field name.
    """
    if isinstance(pair, Checked):
        return pair
    if at is None or isinstance(at, TableAxes):
        return check_request(pair, at or TableAxes(), options, neglect=neglect)  # no axes: no loads, refused
    # what does not show in the transmission error may show in pressures and stresses
    return check_request(pair, at.axes, options, check_size=False, neglect=False)


def checked_request(request: Request, *, check_size: bool = True, neglect: bool = True) -> Checked:
    """Compose the model of a request and refuse what it cannot hold; parameters of `check_request`.

    With a tolerance, automatic effects that it does not need are then neglected.
    """
    require("analysis")
    composed, ledger = _composed(request)
    refuse_beyond_plane(request.scene, composed, ledger)
    if neglect:
        request, composed, ledger = _without_neglected(request, composed, ledger)
    return _checked(request, composed, ledger, check_size=check_size)


def neglecting(checked: Checked) -> Checked:
    """Go on from `check_request` with `neglect` false: decide which effects the tolerance does not need."""
    request, composed, ledger = _without_neglected(checked.request, checked.model, checked.ledger)
    return checked if request is checked.request else _checked(request, composed, ledger)


def _without_neglected(
    request: Request, model: ContactModel, ledger: tuple[LedgerEntry, ...]
) -> tuple[Request, ContactModel, tuple[LedgerEntry, ...]]:
    """Neglect effects that the tolerance does not need, unless that is decided, and compose the others."""
    if not (request.neglected or request.turned_on):
        neglected = neglected_effects(request.scene, ledger, request.options.tolerance)
        if neglected:
            request = replace(request, neglected=neglected)
            return request, *_composed(request)
    return request, model, ledger


def _checked(
    request: Request, model: ContactModel, ledger: tuple[LedgerEntry, ...], *, check_size: bool = True
) -> Checked:
    """Refuse parts of a request that the composed model cannot hold."""
    if model.across_face:
        _refuse_thin_discs(request.pair, request.options.level)
    _refuse_distances(request)
    _refuse_idle_pitches(request)
    cycle = _cycle_cost(request, model) if check_size and model.period > 1 else None
    return Checked(request, model, ledger, cycle)


def _composed(request: Request) -> tuple[ContactModel, tuple[LedgerEntry, ...]]:
    """Compose the model, and return it with its ledger.

    An entry of the ledger has the choice as requested. For a neglected effect it has the verdict on the scene
    with that effect.
    """
    composed, ledger = compose(request.scene, request.choices)
    choices, overrides = request.requested_choices, {**request.neglected, **request.turned_on}
    scene = request.complete_scene
    called_for = {name: scene.effect(name).called_for(scene) for name in request.neglected}
    return composed, tuple(
        replace(
            entry,
            choice=choices.get(entry.name, "auto"),
            verdict=called_for.get(entry.name, entry.verdict),
            override=overrides.get(entry.name, ""),
        )
        for entry in ledger
    )


def _refuse_idle_pitches(request: Request) -> None:
    gears = (request.pair.pinion, request.pair.wheel)
    if request.pitches is not None and all(gear.period == 1 for gear in gears):
        bound = "left out where all teeth are alike"

        raise InputError("pitches", request.pitches, bound, "State deviations of a gear.")


def _cycle_cost(request: Request, model: ContactModel) -> CycleCost:
    """Predict the cost of the whole table; refuse one that is too long to be made."""
    plan = make_plan(request.pair, request.load, request.options, model)
    cost = CycleCost.of(request.pair, plan, model, request.alignments)
    cost.refuse_too_long()
    return cost


def _refuse_distances(request: Request) -> None:
    """Refuse a change of the center distance at which the gears do not mesh, by its place in the list."""
    for i, change in enumerate(request.center_distance_change):
        if change == 0.0:  # where the pair stands already
            continue
        try:
            request.pair.at_center_distance(request.pair.center_distance + float(change))
        except InputError as error:
            bound = Text.of(f"a change at which the gears mesh: {error.field} ", error.bound)
            field_name = f"center_distance_changes[{i}]"
            raise InputError(field_name, float(change), bound, error.suggestion) from None


def _refuse_thin_discs(pair: ParallelAxes, level: str | None) -> None:
    """Refuse discs so thin that rounding would show; where no mesh is requested, the finest counts."""
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        minimum = least_face_width(gear, getattr(SectorRecipe, level or "fine")(gear).layers)
        if gear.face_width < minimum:
            bends = "bends as a plate under the axial force of its helix" if gear.helix_angle else "gives way"
            rounding = f"rounding of its stiffness changes that by more than {LARGEST_ROUNDING:g}"
            bound = at_least(minimum, "m", note=f": a thinner disc {bends}, and {rounding}")
            remedy = "Widen the face or the bore" + (", or take a spur gear." if gear.helix_angle else ".")
            raise InputError(f"{name}.face_width", gear.face_width, bound, remedy)
