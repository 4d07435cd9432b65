"""Plausibility of cases: findings of the library in the fields and units of the file.

The names of all fields, and what complaints need, are loaded with the first finding or complaint.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from bounds import Unit, finding_of
from bounds.types import Json
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.loading import load, on_demand
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.units import factor, unit_name


def case_warnings(case: CheckedCase) -> list[Json]:
    """Return warnings about implausible values of a case, before anything is computed.

    Raises `BadInput`: no such pair, or a complaint about an order that no part of the pair causes.
    """
    if case.case.complaint is not None:
        load("lineofaction.gearbox.convert.complaint:complaint_of_case")(case.case)
    pair, axes = case.pair, case.axes
    alignments = axes.misalignment, axes.center_distance_change
    findings = pair_findings(pair, axes.load(pair), *alignments, loads_as=axes.loads_as)
    return phrased_for(case.case, [finding.to_json() for finding in findings])


def phrased_for(case: Case, findings: Iterable[Json]) -> list[Json]:
    """Return findings of a library about a case in its fields and units."""
    return in_boundary_terms(findings, _field_in(case))


def in_boundary_terms(findings: Iterable[Json], name: Callable[[str], str]) -> list[Json]:
    """Return findings of a library, as plain JSON in SI, in the fields and units of the boundary."""
    return unique(_phrased(content, name) for content in findings)


def unique(warnings: Iterable[Json]) -> list[Json]:
    """Return warnings without repetitions, as of two gears of the case's one material."""
    return list({warning["message"]: warning for warning in warnings}.values())


def _phrased(content: Json, name: Callable[[str], str]) -> Json:
    finding, field = finding_of(content), name(content["field"])
    unit = Unit(unit_name(field) or finding.unit, factor(field))
    scaled = {
        key: None if content[key] is None else float(f"{content[key] / unit.factor:.12g}")
        for key in ("value", "low", "high")
    }
    return {**content, **scaled, "field": field, "unit": unit.plain, "message": finding.message(field, unit)}


def _field_in(case: Case) -> Callable[[str], str]:
    """Return a function from a field to its name in the case; both gears may share a material."""
    case_field = on_demand("lineofaction.gearbox.convert.boundary_names:case_field")

    def field(name: str) -> str:
        boundary: str = case_field(name)
        for gear in ("pinion", "wheel"):
            of_gear, shared = f"pair.{gear}.material.", "material."
            if boundary.startswith(of_gear) and getattr(case.pair, gear).material is None:
                return shared + boundary.removeprefix(of_gear)
        return boundary

    return field
