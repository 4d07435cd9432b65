"""The title block of a report: its subject, and verdicts on the required figures."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path

from fe_contact.solver_version import software_versions
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import read_table, validated
from lineofaction.gearbox.schemas.report import ReportInput, Requirement
from lineofaction.report.drawing.page import Headline, Page, TitleBlock

_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_VALUE = re.compile(rf"({_NUMBER}) ?(.*)")
_BAND = re.compile(rf"± ({_NUMBER})|({_NUMBER}|none) to ({_NUMBER}|none)")


def about_of(file: Path) -> ReportInput:
    """Return the table ``[report]`` of a file; raises `BadInput`: it has none, or one that is not so."""
    table = read_table(file)
    if "report" not in table:
        raise BadInput.of("--about", str(file), "a TOML file with a table [report]")
    return validated(ReportInput, table["report"])


def titled(page: Page, about: ReportInput | None) -> Page:
    """Return a page under its title block; as it is without one.

    A requirement of no main result is an alarm.
    """
    if about is None:
        return page
    named = {name: getattr(about, name) for name in ("project", "number", "revision", "author")}
    rows = {("drawing" if name == "number" else name): text for name, text in named.items() if text}
    rows |= {
        "date": date.today().isoformat(),
        "made with": f"lineofaction {software_versions()['lineofaction']}",
    }
    requirements = [one for line in about.requirements if (one := Requirement.of(line)) is not None]
    verdicts = tuple(line for one in requirements for line in _verdicts(one, page.headlines))
    unmet = tuple(
        f"Required, but no main result of this report: {one.text}"
        for one in requirements
        if not _meant(one, page.headlines)
    )
    corner = " ".join(text for text in (about.number, about.revision) if text)
    block = TitleBlock(tuple(rows.items()), verdicts, corner)
    return replace(page, title=about.title or page.title, alarms=(*unmet, *page.alarms), block=block)


def _meant(required: Requirement, headlines: Sequence[Headline]) -> list[tuple[Headline, float]]:
    """Return the main results that a requirement names, in its unit."""
    values = ((one, _VALUE.match(one.value)) for one in headlines)
    return [
        (one, float(value[1]))
        for one, value in values
        if one.name.lower().startswith(required.figure.lower()) and value and value[2] == required.unit
    ]


def _verdicts(required: Requirement, headlines: Sequence[Headline]) -> list[str]:
    """Return a sentence for each result: met, not met, or open where its error leaves it so."""
    verdicts = []
    for one, value in _meant(required, headlines):
        low, high, band = _band(one, value)
        met = value <= required.limit if required.maximum else value >= required.limit
        verdict = "Open within the error" if low < required.limit < high else "Met" if met else "Not met"
        limit = f"{'at most' if required.maximum else 'at least'} {required.limit:g} {required.unit}".rstrip()
        result = f"{one.value.removesuffix(required.unit).strip()}{band} {required.unit}".rstrip()
        verdicts.append(f"{verdict}: {one.name} is {result}; required is {limit}.")
    return verdicts


def _band(headline: Headline, value: float) -> tuple[float, float, str]:
    """Return the ends of a remark's error or bounds, and its words; infinite: no end."""
    band = _BAND.match(headline.remark)
    if band is None:
        return value, value, ""
    if band[1]:
        return value - float(band[1]), value + float(band[1]), f" {band[0]}"
    low, high = (math.inf if end == "none" else float(end) for end in band.groups()[1:])
    return (-low if math.isinf(low) else low), high, f" ({band[0]})"
