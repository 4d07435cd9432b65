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
from fe_contact.planning import CycleCost, cycle_cost, make_plan, refuse_long_cycle


def check_request(
    pair: ParallelAxes,
    axes: TableAxes,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    *,
    whole_table: bool = True,
    spare: bool = True,
) -> Checked:
    """Check all inputs of a table, without computing anything.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    axes : TableAxes
    options : AnalysisOptions
    whole_table : bool
        False leaves out the limit on the size of a table.
    spare : bool
        False leaves out the decision about effects that a tolerance does not need, which takes some
        milliseconds of solving.

    Warns
    -----
    PlausibilityWarning
        Once for each thing about the request that is far from practice.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    """
    checked = check_asked(Request.over(pair, axes, options), whole_table=whole_table, spare=spare)
    warn_of(checked.request.findings)
    return checked


def check_point(pair: ParallelAxes, point: OperatingPoint, options: AnalysisOptions) -> Checked:
    """Check the inputs of one load and one alignment, as `check_request` does."""
    # what does not show in the transmission error may show in pressures and stresses
    return check_request(pair, point.axes, options, whole_table=False, spare=False)


def check_asked(request: Request, *, whole_table: bool = True, spare: bool = True) -> Checked:
    """Compose the model of a request and refuse what it cannot hold; parameters of `check_request`.

    With a tolerance, automatic effects that it does not need are then neglected.
    """
    composed, ledger = _composed(request)
    refuse_beyond_plane(request.scene, composed, ledger)
    if spare and not (request.neglected or request.turned_on):
        request = replace(
            request, neglected=neglected_effects(request.scene, ledger, request.options.tolerance)
        )
        composed, ledger = _composed(request) if request.neglected else (composed, ledger)
    if composed.across_face:
        _refuse_thin_discs(request.pair, request.options.level)
    _refuse_distances(request)
    _refuse_idle_pitches(request)
    cycle = _cycle_cost(request, composed) if whole_table and composed.period > 1 else None
    return Checked(request, composed, ledger, cycle)


def _composed(request: Request) -> tuple[ContactModel, tuple[LedgerEntry, ...]]:
    """Compose the model; the ledger says what was requested, and of what is neglected what the scene held."""
    composed, ledger = compose(request.scene, request.choices)
    choices, overrides = request.asked_choices, {**request.neglected, **request.turned_on}
    scene = request.whole_scene
    whole = {name: scene.effect(name).called_for(scene) for name in request.neglected}
    return composed, tuple(
        replace(
            entry,
            choice=choices.get(entry.name, "auto"),
            verdict=whole.get(entry.name, entry.verdict),
            override=overrides.get(entry.name, ""),
        )
        for entry in ledger
    )


def _refuse_idle_pitches(request: Request) -> None:
    """Refuse a number of pitches where all of them are alike."""
    gears = (request.pair.pinion, request.pair.wheel)
    if request.pitches is not None and all(gear.pitch_deviation.neutral for gear in gears):
        bound = "left out where all teeth are alike"
        raise InputError("pitches", request.pitches, bound, "Give a gear its pitch deviations.")


def _cycle_cost(request: Request, model: ContactModel) -> CycleCost:
    """Predict the cost of the whole table; refuse one that is too long to be made."""
    plan = make_plan(request.pair, request.load, request.options, model)
    alignments = request.misalignment.size * request.center_distance_change.size
    cost = cycle_cost(request.pair, plan, model.period, alignments)
    refuse_long_cycle(cost)
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
        least = least_face_width(gear, getattr(SectorRecipe, level or "fine")(gear).layers)
        if gear.face_width < least:
            bends = "bends as a plate under the axial force of its helix" if gear.helix_angle else "gives way"
            rounding = f"rounding of its stiffness changes that by more than {LARGEST_ROUNDING:g}"
            bound = at_least(least, "m", note=f": a thinner disc {bends}, and {rounding}")
            advice = "Widen the face or the bore" + (", or take a spur gear." if gear.helix_angle else ".")
            raise InputError(f"{name}.face_width", gear.face_width, bound, advice)
