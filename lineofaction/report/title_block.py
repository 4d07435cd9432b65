"""The title block of a report: its subject, and verdicts on the required figures.

A requirement names a main result of the report, a limit and its unit.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import read_table, validated
from lineofaction.gearbox.schemas.report import ReportInput, Requirement
from lineofaction.report.drawing.page import Headline, Page, TitleBlock

HASH_DIGITS = 12
"""Digits of a hash that tell two reports apart."""
_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_VALUE = re.compile(rf"({_NUMBER}) ?(.*)")
_BAND = re.compile(rf"± ({_NUMBER})|({_NUMBER}|none) to ({_NUMBER}|none)")


def about_of(file: Path) -> ReportInput:
    """Return the table ``[report]`` of a file; raises `BadInput`: it has none, or one of another form."""
    table = read_table(file)
    if "report" not in table:
        raise BadInput.of("--about", str(file), "a TOML file with a table [report]")
    return validated(ReportInput, table["report"])


def titled(page: Page, about: ReportInput | None) -> Page:
    """Return a page under its title block; without `about` the block has date, program and hash alone.

    A requirement that names no main result is an alarm. Without requirements the main result stands as a
    sentence.
    """
    about = ReportInput() if about is None else about
    fields = {"project": about.project, "drawing": about.number, "revision": about.revision}
    fields |= {"author": about.author, "date": date.today().isoformat()}
    rows = {name: text for name, text in fields.items() if text}
    rows["made with"] = f"lineofaction {version('lineofaction')}"
    if page.records:
        rows["hash of the report"] = hash_of(page.records)
    parsed = (Requirement.of(line) for line in about.requirements)
    requirements = [requirement for requirement in parsed if requirement is not None]
    verdicts, alarms = [], []
    for required in requirements:
        of_required = _verdicts(required, page.headlines)
        verdicts += of_required
        if not of_required:
            alarms.append(f"Required, but no main result of this report: {required.text}")
    corner = " ".join(text for text in (about.number, about.revision) if text)
    block = TitleBlock(tuple(rows.items()), tuple(verdicts) or _main_result(page.headlines), corner)
    return replace(page, title=about.title or page.title, alarms=(*alarms, *page.alarms), block=block)


def hash_of(records: Mapping[str, Any]) -> str:
    """Return the first digits of the SHA-256 of what the files of a report say of their making."""
    content = json.dumps(records, sort_keys=True, default=str).encode("utf-8")
    return hashlib.sha256(content).hexdigest()[:HASH_DIGITS]


def _main_result(headlines: Sequence[Headline]) -> tuple[str, ...]:
    """Return the first main result with a number as a sentence, for a report without requirements."""
    for headline in headlines:
        match = _VALUE.match(headline.value)
        if match is not None:
            _, _, band = _band(headline, float(match[1]))
            size = headline.value.removesuffix(match[2]).strip()
            result = f"{size}{band} {match[2]}".rstrip()
            name = f"{headline.name[:1].upper()}{headline.name[1:]}"
            return (f"{name} is {result}; no requirement is stated.",)
    return ()


def _meant(requirement: Requirement, headlines: Sequence[Headline]) -> list[tuple[Headline, float]]:
    """Return the main results that a requirement names and that are in its unit, with their values."""
    results = []
    for headline in headlines:
        value = _VALUE.match(headline.value)
        is_named = headline.name.lower().startswith(requirement.figure.lower())
        if is_named and value and value[2] == requirement.unit:
            results.append((headline, float(value[1])))
    return results


def _verdicts(requirement: Requirement, headlines: Sequence[Headline]) -> list[str]:
    """Return a sentence for each result: met, not met, or open where the limit lies within its error."""
    verdicts = []
    for headline, value in _meant(requirement, headlines):
        low, high, band = _band(headline, value)
        is_met = value <= requirement.limit if requirement.maximum else value >= requirement.limit
        verdict = "Met" if is_met else "Not met"
        if low < requirement.limit < high:
            verdict = "Open within the error"
        if is_met and not band:
            verdict = "Open, no error is stated"
        side = "at most" if requirement.maximum else "at least"
        limit = f"{side} {requirement.limit:g} {requirement.unit}".rstrip()
        result = f"{headline.value.removesuffix(requirement.unit).strip()}{band} {requirement.unit}".rstrip()
        verdicts.append(f"{verdict}: {headline.name} is {result}; required is {limit}.")
    return verdicts


def _band(headline: Headline, value: float) -> tuple[float, float, str]:
    """Return the ends of the error or bounds in a remark, infinite for no end, and their text."""
    band = _BAND.match(headline.remark)
    if band is None:
        return value, value, ""
    if band[1]:
        return value - float(band[1]), value + float(band[1]), f" {band[0]}"
    low, high = (math.inf if end == "none" else float(end) for end in band.groups()[1:])
    return (-low if math.isinf(low) else low), high, f" ({band[0]})"
