"""Whether a case can be computed: what a schema cannot check and a request can afford."""

from __future__ import annotations

from fe_contact.analysis import check_request
from fe_contact.geometry import ParallelAxes
from service.convert.case import analysis_options, boundary_errors, gear_pair, table_axes
from service.schemas import Case


def check_case(case: Case, *, whole_table: bool = True) -> ParallelAxes:
    """Return the pair of a case that can be computed; `whole_table` as for `check_request`.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    """
    pair = gear_pair(case)
    with boundary_errors():
        check_request(pair, table_axes(case), analysis_options(case), whole_table=whole_table, spare=False)
    return pair
