"""Whether a case can be computed: what a schema cannot check and a request can afford."""

from __future__ import annotations

from fe_contact.analysis.request import load_levels, refuse_beyond_plane
from fe_contact.effects import EFFECTS
from fe_contact.effects.composer import check_choices
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
    given = analysis_arguments(case)
    with boundary_errors():
        Accuracy(given["tolerance"], given["time_budget"], given["level"], given["model"], given["positions"])
        check_choices(given["effects"], EFFECTS)
        load_levels(pair, given["torques"], given["normal_forces"])
        refuse_beyond_plane(pair, given["misalignments"], given["center_distance_changes"])
    return pair
