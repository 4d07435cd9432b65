"""Whether a case can be computed: what a schema cannot check and a request can afford."""

from __future__ import annotations

from dataclasses import replace

from fe_contact.analysis.request import Request, axis, load_levels, refuse_beyond_plane
from fe_contact.effects import EFFECTS, compose
from fe_contact.errors import InputError
from fe_contact.geometry import GearPair
from fe_contact.planning import Accuracy
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.schemas import Case


def check_case(case: Case) -> GearPair:
    """Return the pair of a case that can be computed.

    Raises
    ------
    BadInput
        No such pair, or a wish that no plan can meet.
    """
    pair = gear_pair(case)
    with boundary_errors():
        request = _request(case, pair)
        model, _ = compose(request.scene, request.choices, EFFECTS)
        if not model.across_face:
            refuse_beyond_plane(request.scene)
        _check_center_distances(request)
    return pair


def _request(case: Case, pair: GearPair) -> Request:
    """Return what the analysis will be asked, checked."""
    given = analysis_arguments(case)
    return Request(
        pair,
        load_levels(pair, given["torques"], given["normal_forces"]),
        Accuracy(
            given["tolerance"], given["time_budget"], given["level"], given["model"], given["positions"]
        ),
        axis("misalignments", given["misalignments"]),
        axis("center_distance_changes", given["center_distance_changes"]),
        given["effects"],
    )


def _check_center_distances(request: Request) -> None:
    """Refuse a change of the centre distance at which the gears do not mesh, by its place in the list."""
    for index, change in enumerate(request.center_distance_change):
        try:
            replace(request.pair, center_distance=request.pair.center_distance + float(change))
        except InputError as error:
            bound = f"a change at which the gears mesh: {error.field} {error.bound}"
            field = f"center_distance_changes[{index}]"
            raise InputError(field, float(change), bound, error.suggestion) from None
