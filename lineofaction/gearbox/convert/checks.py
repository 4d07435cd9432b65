"""Whether a case can be computed: what a schema cannot check and a request can afford."""

from __future__ import annotations

from bounds import warn_of
from fe_contact.geometry import ParallelAxes
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.case import analysis_options, boundary_errors, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case

THICK = 10.0
"""Face widths from bore to root up to which `check_request` refuses no disc: rounding leaves less than a
tenth of what it allows."""


def check_case(case: Case, *, whole_table: bool = True) -> ParallelAxes:
    """Return the pair of a case that can be computed; `whole_table` as for `check_request`.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    """
    from fe_contact.analysis import check_request  # noqa: PLC0415 (start-up time)

    pair = gear_pair(case)
    with boundary_errors():
        check_request(pair, table_axes(case), analysis_options(case), whole_table=whole_table, spare=False)
    return pair


def check_plain_case(case: Case) -> ParallelAxes:
    """Return the pair of a case of loads alone, as `check_case` does, without what computes.

    A case with default accuracy and effects, one alignment and equal teeth is refused for its loads, or for
    a disc that is too thin; whether one may be is decided here.
    """
    pair = gear_pair(case)
    if any(
        gear.face_width * THICK < abs(gear.root_radius - gear.held_radius)
        for gear in (pair.pinion, pair.wheel)
    ):
        return check_case(case)
    with boundary_errors():
        axes = table_axes(case)
        load = axes.load(pair)
        alignments = axes.misalignment, axes.center_distance_change
        warn_of(pair_findings(pair, load, *alignments, loads_as=axes.loads_as))
    return pair
