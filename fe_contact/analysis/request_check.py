"""From what `analyze` was asked to a request that can be computed, or one clear error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bounds import Text, at_least, warn_of
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.neglected_effects import neglected_effects
from fe_contact.analysis.plane_limits import refuse_beyond_plane
from fe_contact.analysis.request import Checked, Request
from fe_contact.analysis.table_axes import axis, load_levels
from fe_contact.checks import integer
from fe_contact.compliance.rounding import LARGEST_ROUNDING, least_face_width
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, LedgerEntry, compose
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh import SectorRecipe
from fe_contact.planning import Accuracy, CycleCost, cycle_cost, make_plan, refuse_long_cycle
from fe_contact.types import FloatArray

LARGEST_PERIOD = 1_000_000


def check_request(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    pitches: int | None = None,
    misalignments: Sequence[float] | FloatArray = (0.0,),
    center_distance_changes: Sequence[float] | FloatArray = (0.0,),
    effects: Mapping[str, str] | None = None,
    whole_table: bool = True,
    receipt: str = "full",
    on_violation: str = "repeat",
    spare: bool = True,
) -> Checked:
    """Check everything that `analyze` is given, without computing anything.

    Parameters are its; `whole_table` = False leaves out the limit on the size of a table, `spare` = False the
    decision about effects that a tolerance does not need, which takes some milliseconds of solving.

    Warns
    -----
    PlausibilityWarning
        Once for each thing about the request that is far from practice.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    """
    request = Request(
        pair,
        load_levels(pair, torques, normal_forces),
        Accuracy(AllowedError.given(tolerance), time_budget, level, model, positions, receipt),
        axis("misalignments", misalignments),
        axis("center_distance_changes", center_distance_changes),
        dict(effects or {}),
        None if pitches is None else integer("pitches", pitches, 1, LARGEST_PERIOD),
        on_violation,
        loads_as="normal_forces" if torques is None else "torques",
    )
    checked = check_asked(request, whole_table=whole_table, spare=spare)
    warn_of(request.findings, stacklevel=4)
    return checked


def check_one_load(
    pair: ParallelAxes,
    torque: float | None,
    normal_force: float | None,
    misalignment: float,
    center_distance_change: float,
    *,
    tolerance: AllowedError | float | None,
    level: str | None,
    time_budget: float | None,
    model: str,
    effects: Mapping[str, str] | None,
    on_violation: str = "repeat",
) -> Checked:
    """Check what is asked of one load (N m or N, exactly one) and alignment (m), as `check_request` does."""
    return check_request(
        pair,
        torques=None if torque is None else [torque],
        normal_forces=None if normal_force is None else [normal_force],
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        misalignments=[misalignment],
        center_distance_changes=[center_distance_change],
        effects=effects,
        on_violation=on_violation,
        whole_table=False,
        spare=False,  # what does not show in the transmission error may show in pressures and stresses
    )


def check_asked(request: Request, *, whole_table: bool = True, spare: bool = True) -> Checked:
    """Compose the model of a request and refuse what it cannot hold; parameters of `check_request`.

    With a tolerance, automatic effects that it does not need are then neglected.
    """
    composed, ledger = _composed(request)
    refuse_beyond_plane(request.scene, composed)
    if spare and not (request.neglected or request.turned_on):
        request = replace(
            request, neglected=neglected_effects(request.scene, ledger, request.accuracy.tolerance)
        )
        composed, ledger = _composed(request) if request.neglected else (composed, ledger)
    if composed.across_face:
        _refuse_thin_discs(request.pair, request.accuracy.level)
    _refuse_distances(request)
    _refuse_idle_pitches(request)
    cycle = _cycle_cost(request, composed) if whole_table and composed.period > 1 else None
    return Checked(request, composed, ledger, cycle)


def _composed(request: Request) -> tuple[ContactModel, tuple[LedgerEntry, ...]]:
    """Compose the model; the ledger says what was requested, and of what is neglected what the scene held."""
    composed, ledger = compose(request.scene, request.choices, EFFECTS)
    asked, overrides = request.asked_choices, {**request.neglected, **request.turned_on}
    whole = {
        effect.name: effect.called_for(request.whole_scene)
        for effect in EFFECTS
        if effect.name in request.neglected
    }
    return composed, tuple(
        replace(
            entry,
            choice=asked.get(entry.name, "auto"),
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
    plan = make_plan(request.pair, request.load, request.accuracy, model)
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
