"""The sound of a scene: map over speed and frequency, orders, third octaves, bearings, the loudest points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from dynamics.noise import LoudPoint, RadiatedSound, loudest
from lineofaction.gearbox.convert.run_effects import model_lines
from lineofaction.report.drawing.figure import Figure, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page
from lineofaction.report.studies.bearing_force_words import force_words, of_run
from lineofaction.report.studies.noise_drawings import (
    RPM,
    bearing_levels,
    level_over_speed,
    panel_intensity,
    sound_map,
    third_octaves,
)
from lineofaction.report.studies.noise_model_table import model_tables
from lineofaction.report.studies.noise_over_time import third_octaves_over_time
from lineofaction.report.studies.noise_region_table import most, region_table

# Tables of the bands of a sound, and of what 1 dB costs.


Json = dict[str, Any]
SHOWN_ORDERS, SHOWN_CAUSES = 6, 3
BAND_HEAD = ("largest over the speeds", "dB(A)", "from", "to", "most by, dB")
COST_HEAD = ("figure", "value", "step", "change, dB", "two steps, dB", "for -1 dB about", "linear within")


def _uncertainty_tables(facts: Json) -> Iterator[Table]:
    """Yield the tables of what was computed."""
    if facts["band"] is not None:
        yield _band_table(facts["band"])
    if facts["sensitivities"]:
        yield _cost_table(facts["sensitivities"])


def _band_table(band: Json) -> Table:
    """List the bands of the total and of the loudest orders."""
    loudest = sorted(band["orders"], key=lambda row: -row["largest"]["level_db_a"])[:SHOWN_ORDERS]
    rows = [("all orders", band["largest_total"])]
    rows += [(f"order {row['order']:.4g}", row["largest"]) for row in loudest]
    return Table(
        "Bands over the ranges of what is guessed",
        BAND_HEAD,
        tuple(_band_row(*row) for row in rows),
    )


def _band_row(name: str, level: Json) -> tuple[str, ...]:
    ends = (level[key] for key in ("level_db_a", "low_db_a", "high_db_a"))
    return (name, *(f"{end:.1f}" for end in ends), ", ".join(_causes(level)))


def _causes(level: Json) -> Iterator[str]:
    """Yield the contributions that widen a band most."""
    below, above = level["below_db"], level["above_db"]
    names = sorted(above, key=lambda name: -max(below[name], above[name]))
    for name in names[:SHOWN_CAUSES]:
        if max(below[name], above[name]) > 0.0:
            yield f"{name.replace('_', ' ')} -{below[name]:.1f} +{above[name]:.1f}"


def _cost_table(rows: list[Json]) -> Table:
    """List what steps change of the largest level, the largest change first."""
    caption = "What 1 dB costs: largest level of all orders; factors are on what the scene states"
    return Table(caption, COST_HEAD, tuple(_cost(row) for row in rows))


def _cost(row: Json) -> tuple[str, ...]:
    """Describe a sensitivity."""
    unit = f" {row['unit'].replace('um', 'µm')}" if row["unit"] else ""
    needed, reach = row["for_one_db_less"], row["linear_range"]
    beyond = "" if row["linear"] else " (beyond the linear range)"
    return (
        row["figure"],
        f"{number(row['value'], 4)}{unit}",
        f"{number(row['step'], 3)}{unit}",
        f"{row['change_db']:+.2f}",
        f"{row['change_of_two_steps_db']:+.2f}",
        "nothing does" if needed is None else f"{needed:+.3g}{unit}{beyond}",
        "any" if reach is None else f"{number(reach, 2)}{unit}",
    )


HEAD = (
    "order",
    "speed, rpm",
    "frequency, Hz",
    "dB(A)",
    "mode",
    "mode, Hz",
    "share of the mode, %",
    "bearing",
    "alone, dB(A)",
    "without it, dB(A)",
)


def _loudest_table(sound: RadiatedSound) -> Table:
    return Table("Loudest points, A-weighted", HEAD, tuple(_row(point) for point in loudest(sound)))


def _row(point: LoudPoint) -> tuple[str, ...]:
    return (
        f"{point.order:.4g}",
        number(point.speed / RPM, 5),
        number(point.frequency, 5),
        f"{point.weighted_level:.1f}" + ("" if point.in_contact else " (flanks part)"),
        f"{point.mode}",
        number(point.natural_frequency, 5),
        number(100.0 * point.mode_share, 2),
        point.bearing,
        f"{point.bearing_level:.1f}",
        f"{point.level_without_bearing:.1f}",
    )


def sentences(sound: RadiatedSound) -> tuple[str, ...]:
    """Say what radiates at the loudest point, and through what; nothing in silence."""
    return tuple(
        f"{where(point)}: {point.weighted_level:.1f} dB(A) through mode {point.mode} of {point.mode_housing} "
        f"({number(point.natural_frequency, 4)} Hz); bearing {point.bearing} alone "
        f"{point.bearing_level:.1f} dB(A); {most(sound)}"
        for point in loudest(sound, 1)
    )


def where(point: LoudPoint) -> str:
    """Say order, speed and frequency of a point."""
    return f"order {point.order:.4g} at {number(point.speed / RPM, 4)} rpm, {number(point.frequency, 4)} Hz"


def headlines(sound: RadiatedSound) -> tuple[Headline, ...]:
    """Return the loudest speed, the loudest order, and where flanks part."""
    total, points = sound.orders.total_weighted_level, loudest(sound, 1)
    at = int(total.argmax())
    where = f"at {number(float(sound.speed[at]) / RPM, 4)} rpm, all orders"
    if (band := sound.facts["band"]) is not None:
        total_band = band["largest_total"]
        where += f"; {total_band['low_db_a']:.1f} to {total_band['high_db_a']:.1f} over the ranges of guesses"
    shown = [Headline("sound power level", f"{total[at]:.1f} dB(A)", where)]
    shown += [
        Headline("loudest order", f"{point.weighted_level:.1f} dB(A)", words)
        for point, words in zip(points, sentences(sound), strict=True)
    ]
    parting = sound.speed[~sound.in_contact] / RPM
    if parting.size:
        first = f"from {number(float(parting[0]), 4)} rpm on"
        shown.append(Headline("flanks part at", f"{parting.size} of {sound.speed.size} speeds", first))
    return tuple(shown)


def _figures(sound: RadiatedSound) -> tuple[Figure, ...]:
    points = loudest(sound, 1)
    panels = panel_intensity(sound, where(points[0]), region_table(sound)) if points else None
    figures = (
        sound_map(sound, _loudest_table(sound), sentences(sound)),
        level_over_speed(sound),
        third_octaves(sound),
        bearing_levels(sound),
        panels,
    )
    shown = tuple(figure for figure in figures if figure is not None)
    if sound.facts.get("over_time") is None:
        return shown
    return (*shown, third_octaves_over_time(sound.facts))


def limits(sound: RadiatedSound) -> Iterator[tuple[str, str]]:
    """Say of each housing by what model it radiates, what others say, and what the answer does not hold."""
    yield from force_words(sound.facts)
    for name in sound.housing:
        yield from _radiation_limits(sound, name)
    parting = sound.speed[~sound.in_contact] / RPM
    if parting.size:
        where = f"{parting[0]:.5g} to {parting[-1]:.5g} rpm"
        what = "see loa steady" if of_run(sound.facts) is None else "their impacts are in the run's total"
        yield "flanks lift off", f"at {parting.size} of {sound.speed.size} speeds, {where}: {what}"


def _radiation_limits(sound: RadiatedSound, housing: str) -> Iterator[tuple[str, str]]:
    about, compared = sound.facts["radiation"][housing], sound.facts["models"][housing]
    resolved, valid, highest = about["resolved_frequency"], about["valid_frequency"], sound.frequency.max()
    yield (
        housing,
        f"{about['model_name'].replace('_', ' ')}, outer hull {number(about['area'], 3)} m², "
        f"{number(about['inner_area'], 3)} m² of inner walls left out",
    )
    if highest > resolved > 0.0:
        words = "which the mesh does not resolve, equivalent radiated power"
        yield f"above {number(resolved, 3)} Hz", words
    if highest > valid:
        words = "0.7 of the highest mode kept, modes are missing: keep more"
        yield f"above {number(valid, 3)} Hz", words
    for model, reason in compared.get("left_out", {}).items():
        yield f"without {model.replace('_', ' ')}", reason


def _text(sound: RadiatedSound) -> Iterator[Table | str]:
    """Yield the loudest points, what the levels rest on, bands, sensitivities and the cost."""
    yield _loudest_table(sound)
    yield region_table(sound)
    yield from sentences(sound)
    yield from (f"{what}: {words}" for what, words in limits(sound))
    yield from model_tables(sound)
    yield from _uncertainty_tables(sound.facts)
    yield from (f"no sensitivity to {name}: {why}" for name, why in _missing(sound))
    yield from cost_tables(sound.facts)
    yield from model_lines(sound.facts)


def _missing(sound: RadiatedSound) -> tuple[tuple[str, str], ...]:
    """Return the figures without a sensitivity, and why."""
    return tuple(sound.facts["sensitivities_left_out"].items())


def page(sound: RadiatedSound) -> Page:
    """Return the report: figures, bands and sensitivities, effects, and what the levels rest on."""
    whole = dynamics_page("Sound power", _figures(sound), headlines(sound), sound.facts)
    tables = tuple(_uncertainty_tables(sound.facts))
    if missing := _missing(sound):
        tables += (Table("No sensitivity", ("to", "because"), missing),)
    bands = (Section("Bands, and what 1 dB costs", tables=tables),) if tables else ()
    rests = Table("Radiation models, and what the levels do not hold", ("what", "how"), tuple(limits(sound)))
    accuracy = Section("Accuracy of the levels", tables=(rests, *model_tables(sound)), part=Part.ACCURACY)
    return replace(whole, sections=(*whole.sections, *bands, accuracy))


PAGE = Presentation(
    lambda sound: sound_map(sound, _loudest_table(sound), sentences(sound)),
    page,
    _text,
)
