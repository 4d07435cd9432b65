"""The content of the page, by what was read."""

from __future__ import annotations

import math
from dataclasses import replace

from fe_contact.ste import PairFacts
from service.report.dynamic_part import dynamic_alarms, dynamic_headlines, dynamic_making, dynamic_results
from service.report.flank_part import flank_alarms, flank_headlines, flank_making, flank_results_section
from service.report.inputs import Inputs
from service.report.page import Headline, Page, Section
from service.report.sensitivity import sensitivity_figure
from service.report.static_part import static_alarms, static_headlines, static_making, static_results


def page_of(read: Inputs) -> Page:
    """Put the page together: what is implausible, results, how they were made.

    A study alone has its own page.
    """
    page = _page_of(read)
    return replace(page, alarms=(*(f"Implausible: {text}" for text in read.warnings), *page.alarms))


def _page_of(read: Inputs) -> Page:
    """Put the page together, without what the files warn of."""
    if read.only_page is not None:
        return read.only_page
    database, flanks, run = read.database, read.flanks, read.run
    headlines: list[Headline] = []
    results: list[Section] = []
    making: list[Section] = []
    alarms: list[str] = []
    if database is not None:
        headlines += static_headlines(database, nominal_force(read))
        results += static_results(database)
        making += static_making(database)
        alarms += static_alarms(database)
    if flanks is not None:
        headlines += flank_headlines(flanks)
        results += flank_results_section(flanks)
        making += flank_making(flanks, alone=database is None)
        alarms += flank_alarms(flanks, database)
    if read.studies:
        results.append(Section("Sensitivity", figures=(sensitivity_figure(read.studies),)))
    for study in read.pages:
        headlines += study.headlines
        results += study.sections
    if run is not None:
        headlines += dynamic_headlines(run)
        results += dynamic_results(run)
        making += dynamic_making(run)
        alarms += dynamic_alarms(run)
    return Page(_title(read), _lead(read), tuple(headlines), (*results, *making), tuple(alarms))


def nominal_force(read: Inputs) -> float | None:
    """Return the normal force in N that the run's load asks of the database's pair; None where it idles."""
    if read.run is None or read.database is None or read.run.nominal_force[0] <= 0.0:
        return None
    return float(read.run.nominal_force[0]) / math.cos(read.database.facts.base_helix_angle)


def _title(read: Inputs) -> str:
    """Name the pair, or the run."""
    facts = pair_facts(read)
    if facts is None:
        if read.studies or read.pages:
            return "Studies of gear pairs" if read.pages else "Sensitivity of gear pairs"
        return "Dynamics of geared shafts"
    pinion, wheel = facts.teeth
    return f"Gear pair {pinion}/{wheel}, internal" if facts.internal else f"Gear pair {pinion}/{wheel}"


def pair_facts(read: Inputs) -> PairFacts | None:
    """Return the facts of the pair, if anything but a run was read."""
    source = read.database or (read.flanks.scene if read.flanks is not None else None)
    return None if source is None else source.facts


def _lead(read: Inputs) -> str:
    """Say in one line what was computed."""
    parts = []
    facts = pair_facts(read)
    if facts is not None:
        parts.append(
            f"center distance {1e3 * facts.center_distance:.6g} mm, "
            f"face width {1e3 * facts.face_width:.6g} mm, base pitch {1e3 * facts.base_pitch:.5g} mm"
        )
    if read.run is not None:
        parts.append(f"{read.run.time[-1]:.6g} s of motion at {read.run.sample_rate:.6g} samples per second")
    return "; ".join(parts)
