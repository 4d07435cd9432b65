"""The sound of a scene: map over speed and frequency, orders, third octaves, bearings, the loudest points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dynamics.acoustics import OrderPower, a_weighting, sound_power_level
from dynamics.noise import LoudPoint, RadiatedSound, loudest
from lineofaction.gearbox.convert.effects import model_lines
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, HeatMap, Line, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.surface_view import surface_panels
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page
from lineofaction.report.studies.noise_model_table import model_tables
from lineofaction.report.studies.noise_over_time import (
    force_words,
    of_run,
    row_axis,
    third_octaves_over_time,
    total_line,
)
from lineofaction.report.studies.noise_region_table import most, region_table

# Figures of a radiated sound.


RPM = np.pi / 30.0
DEPTH = 60.0
"""dB shown below the loudest."""
LINES, SHOWN = 160, 6
"""Cells of the map in frequency; lines of orders and bearings."""


def sound_map(sound: RadiatedSound, table: Table, words: Sequence[str]) -> Figure:
    """Draw the A-weighted level over speed and frequency."""
    orders, (x, along) = sound.orders, row_axis(sound.speed, sound.facts)
    forces = "linear: mean mesh stiffness, no loss of contact"
    if of_run(sound.facts) is not None:
        forces = "with the amplitudes of the run"
    return Figure(
        key="sound_map",
        title="Sound power over speed and frequency",
        caption="A-weighted sound power level re 1 pW of each order as in a steady state, "
        f"{forces}. Colors end {DEPTH:g} dB below the loudest.",
        alternative=" ".join(f"Loudest: {text}." for text in words) or "Nothing radiates.",
        content=(Panel(x, Axis("frequency, Hz"), shade=_cells(orders, along)),),
        table=table,
    )


def _cells(orders: OrderPower, speed: FloatArray) -> HeatMap:
    """Add up the orders in cells of speed and frequency, up to the highest that is shown.

    They are tall enough that lines of orders are not broken.
    """
    top, steps = float(orders.frequency.max()), np.abs(np.diff(orders.frequency, axis=1))
    height = max(top / LINES, float(steps.max(initial=0.0)))
    edges = np.arange(0.0, top + 2.0 * height, height)
    cell = np.digitize(orders.frequency, edges) - 1
    power = np.zeros((edges.size - 1, speed.size))
    np.add.at(power, (cell, np.broadcast_to(np.arange(speed.size), cell.shape)), orders.weighted_power)
    level = sound_power_level(power)
    most = float(level.max())
    z = np.where(level < most - DEPTH, np.nan, level)
    shown = int(np.flatnonzero(np.any(level >= most - DEPTH, axis=1)).max(initial=0)) + 1
    middle = 0.5 * (edges[1:] + edges[:-1])
    return HeatMap(speed, middle[:shown], z[:shown], "sound power level, dB(A)", most, most - DEPTH)


def _level_over_speed(sound: RadiatedSound) -> Figure:
    """Draw the total and the loudest orders over speed."""
    orders, (x, speed) = sound.orders, row_axis(sound.speed, sound.facts)
    level, total = orders.weighted_level, orders.total_weighted_level
    shown = sorted(int(k) for k in np.argsort(-level.max(axis=1), kind="stable")[:SHOWN])
    floor = float(total.max()) - DEPTH
    lines = (
        Line("total", speed, _above(total, floor), palette.INK, width=2.2),
        *(
            Line(f"order {order:.4g}", speed, _above(level[h], floor), palette.category(k), width=1.4)
            for k, (h, order) in enumerate(zip(shown, sound.order[shown], strict=True))
        ),
    )
    if (whole := total_line(sound.speed, sound.facts)) is not None:
        lines += (Line("all of the run", whole[0], _above(whole[1], floor), palette.MUTED, width=1.4),)
    at = int(total.argmax())
    return Figure(
        key="sound_levels",
        title="Sound power of the orders over speed",
        caption=f"Orders add up in power. The {SHOWN} loudest are shown.",
        alternative=f"The total is largest at {_rpm(sound, at)}: {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=_levels_table(sound, level, total),
    )


def third_octaves(sound: RadiatedSound) -> Figure:
    """Draw the levels of the bands: at the loudest speed, and the largest over all speeds."""
    center, power = sound.orders.third_octaves()
    weighting = a_weighting(center)[:, None]
    level = sound_power_level(power) + weighting
    at = int(sound.orders.total_weighted_level.argmax())
    floor = float(level.max()) - DEPTH
    edges = np.append(center, center[-1] * 10.0**0.1) * 10.0**-0.05
    speed = number(float(sound.speed[at]) / RPM, 4)
    lines = tuple(
        Line(name, np.repeat(edges, 2)[1:-1], np.repeat(np.maximum(values, floor), 2), color)
        for name, values, color in (
            ("largest over speed", level.max(axis=1), palette.BLUE),
            (f"at {speed} rpm, the loudest speed", level[:, at], palette.VERMILLION),
        )
    )
    worst = int(level.max(axis=1).argmax())
    names = tuple((float(value), f"{value:g}") for value in center[:: max(center.size // 8, 1)])
    x = Axis("nominal center of the band, Hz", "log", (float(edges[0]), float(edges[-1])), names)
    rows = zip(center, level.max(axis=1), level[:, at], strict=True)
    return Figure(
        key="sound_third_octaves",
        title="Sound power in third octaves",
        caption="A band takes all of an order whose frequency lies in it (IEC 61260-1); A-weighting is that "
        "of the nominal center.",
        alternative=f"The loudest band is that at {center[worst]:g} Hz: {level[worst].max():.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=Table(
            "Third octaves",
            ("band, Hz", "largest over speed, dB(A)", f"at {speed} rpm, dB(A)"),
            tuple((f"{f:g}", f"{a:.1f}", f"{b:.1f}") for f, a, b in rows),
        ),
    )


def _bearing_levels(sound: RadiatedSound) -> Figure:
    """Draw what the force of each bearing would radiate alone."""
    (x, speed), total = row_axis(sound.speed, sound.facts), sound.orders.total_weighted_level
    alone = np.stack([_total(sound, power) for power in sound.bearing_alone])
    floor = float(total.max()) - DEPTH
    most = np.argsort(-alone.max(axis=1), kind="stable")[:SHOWN]
    lines = (
        Line("all", speed, _above(total, floor), palette.INK, width=2.2),
        *(
            Line(sound.bearing[b], speed, _above(alone[b], floor), palette.category(k), width=1.4)
            for k, b in enumerate(most)
        ),
    )
    at = int(total.argmax())
    loud = int(alone[:, at].argmax())
    without = np.stack([_total(sound, power) for power in sound.without_bearing])
    return Figure(
        key="sound_bearings",
        title="Sound power by the force of each bearing alone",
        caption="Forces of bearings are coherent: their powers do not add up, and one may be louder alone "
        "than all together.",
        alternative=f"At {_rpm(sound, at)} bearing {sound.bearing[loud]} alone radiates "
        f"{alone[loud, at]:.1f} dB(A) of {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis("sound power level, dB(A)"), lines),),
        table=Table(
            f"Bearings at {_rpm(sound, at)}",
            ("bearing", "alone, dB(A)", "all without it, dB(A)"),
            tuple(
                (name, f"{alone[b, at]:.1f}", f"{without[b, at]:.1f}") for b, name in enumerate(sound.bearing)
            ),
        ),
    )


def _panel_intensity(sound: RadiatedSound, where: str, table: Table) -> Figure | None:
    """Draw the intensity on the hulls at the loudest point, `where`; None where it was not looked at."""
    panels = sound.panels
    if panels is None:
        return None
    hull, value = panels.hull, 1e3 * panels.intensity
    least, largest = (number(float(end), 2) for end in (value.min(), value.max()))
    return Figure(
        key="sound_panels",
        title=f"Sound intensity on the surface: {where}",
        caption="Active intensity normal to the hull that the radiation model takes: openings are covered, "
        "fine details rounded off. Negative: takes power that other panels radiate.",
        alternative=f"The intensity is between {least} and {largest} mW/m².",
        content=surface_panels(
            hull.nodes, hull.triangles, np.zeros_like(hull.nodes), value, "intensity, mW/m²", "outer hull"
        ),
        table=table,
    )


def _total(sound: RadiatedSound, power: FloatArray) -> FloatArray:
    """Return the A-weighted level of all orders of a power (S, H), (S,), dB(A)."""
    return OrderPower(sound.frequency.T, np.maximum(power.T, 0.0)).total_weighted_level


def _levels_table(sound: RadiatedSound, level: FloatArray, total: FloatArray) -> Table:
    """Where the total and each order are loudest."""
    rows = [("total", f"{total.max():.1f}", number(float(sound.speed[total.argmax()]) / RPM, 5), "")]
    for h, order in enumerate(sound.order):
        at = int(level[h].argmax())
        speed = number(float(sound.speed[at]) / RPM, 5)
        rows.append((f"{order:.4g}", f"{level[h, at]:.1f}", speed, number(float(sound.frequency[at, h]), 5)))
    head = ("order", "dB(A)", "speed, rpm", "frequency, Hz")
    return Table("Largest level of each order", head, tuple(rows))


def _rpm(sound: RadiatedSound, row: int) -> str:
    return f"{number(float(sound.speed[row]) / RPM, 4)} rpm"


def _above(level: FloatArray, floor: float) -> FloatArray:
    return np.where(level < floor, np.nan, level)


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
    panels = _panel_intensity(sound, where(points[0]), region_table(sound)) if points else None
    figures = (
        sound_map(sound, _loudest_table(sound), sentences(sound)),
        _level_over_speed(sound),
        third_octaves(sound),
        _bearing_levels(sound),
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
