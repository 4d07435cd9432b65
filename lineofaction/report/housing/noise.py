"""The sound of a scene: map over speed and frequency, orders, third octaves, bearings, the loudest points.

Axes of arrays: S speeds, H orders.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bounds import engineering
from bounds.types import Json
from dynamics.acoustics import OrderPower, a_weighting, sound_power_level
from dynamics.noise import LoudPoint, RadiatedSound, loudest
from lineofaction.gearbox.units import MM, RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    HeatMap,
    Line,
    Panel,
    Table,
    category_lines,
    number,
    shaded_levels,
    step_line,
)
from lineofaction.report.drawing.marks import drawn_orders, order_label, words_of_order
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.surface_view import surface_panels
from lineofaction.report.drawing.tables import amount, gigabytes
from lineofaction.report.housing.forces import (
    DEPTH,
    LABEL,
    force_rows,
    of_run,
    row_axis,
    third_octaves_over_time,
    total_line,
)
from lineofaction.report.housing.sound_bands import ends, narrowest, uncertainty_tables
from lineofaction.report.presentation import Presentation, dynamics_page, model_text
from lineofaction.report.response.excitations import excitation_figures, excitation_table

LINES, MAX_ORDERS = 160, 6
"""Cells of the map in frequency; lines of orders and bearings."""
_MODEL_HEAD = ("model", "level, dB", "stated error, dB", "CPU s", "CPU s predicted", "GB predicted")
_REGION_POINTS = 3
"""Loudest points whose regions are listed."""


def _sound_map(sound: RadiatedSound) -> Figure:
    x, along = row_axis(sound.speed, sound.metadata)
    forces = "linear: stiffness varies with position, no loss of contact"
    if of_run(sound.metadata) is not None:
        forces = "with the amplitudes of the run"
    return Figure(
        key="sound_map",
        title="Sound power over speed and frequency",
        caption="A-weighted sound power level re 1 pW of each order as in a steady state, "
        f"{forces}. Colors end {DEPTH:g} dB below the loudest.",
        alternative=" ".join(f"Loudest: {text}." for text in _sentences(sound)) or "Nothing radiates.",
        content=(Panel(x, Axis("frequency, Hz"), shade=_cells(sound.orders, along)),),
        table=_loudest_table(sound),
    )


def _cells(orders: OrderPower, speed: FloatArray) -> HeatMap:
    """Add up the orders in cells of speed and frequency, up to the highest that is shown.

    A cell is at least as tall as an order's rise from one speed to the next, so that no order's line breaks.
    """
    top = float(orders.frequency.max())
    steps = np.abs(np.diff(orders.frequency, axis=1))
    height = max(top / LINES, float(steps.max(initial=0.0)))
    edges = np.arange(0.0, top + 2.0 * height, height)
    cell = np.digitize(orders.frequency, edges) - 1
    power = np.zeros((edges.size - 1, speed.size))
    np.add.at(power, (cell, np.broadcast_to(np.arange(speed.size), cell.shape)), orders.weighted_power)
    level = sound_power_level(power)
    rows = int(np.flatnonzero(np.any(level >= float(level.max()) - DEPTH, axis=1)).max(initial=0)) + 1
    middle = 0.5 * (edges[1:] + edges[:-1])
    return shaded_levels(speed, middle[:rows], level[:rows], LABEL, DEPTH)


def _level_over_speed(sound: RadiatedSound) -> Figure:
    x, speed = row_axis(sound.speed, sound.metadata)
    level, total = sound.orders.weighted_level, sound.orders.total_weighted_level
    loudest_orders = drawn_orders(sound.order, level.max(axis=1), MAX_ORDERS, sound.metadata)
    floor = float(total.max()) - DEPTH
    names = [f"order {order_label(sound.order[h], sound.metadata)}" for h in loudest_orders]
    lines = [Line("total", speed, _above(total, floor), palette.INK, width=2.2)]
    lines += category_lines(speed, names, _above(level[loudest_orders], floor))
    over_time = total_line(sound.speed, sound.metadata)
    if over_time is not None:
        along, run_sum = over_time
        lines.append(Line("all of the run", along, _above(run_sum, floor), palette.MUTED, width=1.4))
    at = int(total.argmax())
    return Figure(
        key="sound_levels",
        title="Sound power of the orders over speed",
        caption=f"Orders add up in power. The {MAX_ORDERS} loudest are shown.",
        alternative=f"The total is largest at {_rpm(sound, at)}: {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis(LABEL), tuple(lines)),),
        table=_levels_table(sound, level, total),
    )


def _third_octaves(sound: RadiatedSound) -> Figure:
    """Draw the levels of the bands: at the loudest speed, and the largest over all speeds."""
    center, power = sound.orders.third_octaves()
    weighting = a_weighting(center)[:, None]
    level = sound_power_level(power) + weighting
    at = int(sound.orders.total_weighted_level.argmax())
    floor = float(level.max()) - DEPTH
    edges = np.append(center, center[-1] * 10.0**0.1) * 10.0**-0.05  # a band spans a tenth of a decade
    speed = number(float(sound.speed[at]) / RPM, 4)
    largest, loud = level.max(axis=1), level[:, at]
    name = f"at {speed} rpm, the loudest speed"
    lines = (
        step_line("largest over speed", edges, np.maximum(largest, floor), palette.BLUE),
        step_line(name, edges, np.maximum(loud, floor), palette.VERMILLION),
    )
    worst = int(largest.argmax())
    names = tuple((float(value), f"{value:g}") for value in center[:: max(center.size // 8, 1)])
    x = Axis("nominal center of the band, Hz", "log", (float(edges[0]), float(edges[-1])), names)
    head = ("band, Hz", "largest over speed, dB(A)", f"at {speed} rpm, dB(A)")
    rows = zip(center, largest, loud, strict=True)
    return Figure(
        key="sound_third_octaves",
        title="Sound power in third octaves",
        caption="A band takes all of an order whose frequency lies in it (IEC 61260-1); A-weighting is that "
        "of the nominal center.",
        alternative=f"The loudest band is that at {center[worst]:g} Hz: {level[worst].max():.1f} dB(A).",
        content=(Panel(x, Axis(LABEL), lines),),
        table=Table("Third octaves", head, tuple((f"{f:g}", f"{a:.1f}", f"{b:.1f}") for f, a, b in rows)),
    )


def _bearing_levels(sound: RadiatedSound) -> Figure:
    x, speed = row_axis(sound.speed, sound.metadata)
    total = sound.orders.total_weighted_level
    alone = np.stack([_total(sound, power) for power in sound.bearing_alone])
    floor = float(total.max()) - DEPTH
    drawn = np.argsort(-alone.max(axis=1), kind="stable")[:MAX_ORDERS]
    lines = (
        Line("all", speed, _above(total, floor), palette.INK, width=2.2),
        *category_lines(speed, [sound.bearing[b] for b in drawn], _above(alone[drawn], floor)),
    )
    at = int(total.argmax())
    loud = int(alone[:, at].argmax())
    without = np.stack([_total(sound, power) for power in sound.without_bearing])
    columns = {
        "bearing": lambda b: sound.bearing[b],
        "alone, dB(A)": lambda b: f"{alone[b, at]:.1f}",
        "all without it, dB(A)": lambda b: f"{without[b, at]:.1f}",
    }
    return Figure(
        key="sound_bearings",
        title="Sound power by the force of each bearing alone",
        caption="Forces of bearings are coherent: their powers do not add up, and one may be louder alone "
        "than all together.",
        alternative=f"At {_rpm(sound, at)} bearing {sound.bearing[loud]} alone radiates "
        f"{alone[loud, at]:.1f} dB(A) of {total[at]:.1f} dB(A).",
        content=(Panel(x, Axis(LABEL), lines),),
        table=Table.of(f"Bearings at {_rpm(sound, at)}", range(len(sound.bearing)), columns),
    )


def _panel_intensity(sound: RadiatedSound) -> Figure | None:
    """Draw the intensity on the hulls at the loudest point; None in silence or where it is not known."""
    panels, points = sound.panels, loudest(sound, 1)
    if panels is None or not points:
        return None
    hull = panels.hull
    value = 1e3 * panels.intensity
    at_rest = np.zeros_like(hull.nodes)
    return Figure(
        key="sound_panels",
        title=f"Sound intensity on the surface: {_where(points[0], sound.metadata)}",
        caption="Active intensity normal to the hull that the radiation model takes: openings are covered, "
        "fine details rounded off. Negative: takes power that other panels radiate.",
        alternative=f"The intensity is between {number(value.min(), 2)} and {number(value.max(), 2)} mW/m².",
        content=surface_panels(hull.nodes, hull.triangles, at_rest, value, "intensity, mW/m²", "outer hull"),
        table=_region_table(sound),
    )


def _total(sound: RadiatedSound, power: FloatArray) -> FloatArray:
    """Return the A-weighted level (S,), dB(A), of all orders of a power (S, H)."""
    return OrderPower(sound.frequency.T, np.maximum(power.T, 0.0)).total_weighted_level


def _levels_table(sound: RadiatedSound, level: FloatArray, total: FloatArray) -> Table:
    rows = [("total", f"{total.max():.1f}", number(float(sound.speed[total.argmax()]) / RPM, 5), "")]
    for h, order in enumerate(sound.order):
        peak = int(level[h].argmax())
        speed, hertz = number(float(sound.speed[peak]) / RPM, 5), number(sound.frequency[peak, h], 5)
        rows.append((order_label(order, sound.metadata), f"{level[h, peak]:.1f}", speed, hertz))
    head = ("order", "dB(A)", "speed, rpm", "frequency, Hz")
    return Table("Largest level of each order", head, tuple(rows))


def _rpm(sound: RadiatedSound, row: int) -> str:
    return f"{number(float(sound.speed[row]) / RPM, 4)} rpm"


def _above(level: FloatArray, floor: float) -> FloatArray:
    """Return levels with NaN below the floor: plots leave a gap."""
    return np.where(level < floor, np.nan, level)


def _loudest_table(sound: RadiatedSound) -> Table:
    columns = {
        "order": lambda point: order_label(point.order, sound.metadata),
        "speed, rpm": lambda point: number(point.speed / RPM, 5),
        "frequency, Hz": lambda point: number(point.frequency, 5),
        "dB(A)": lambda point: f"{point.weighted_level:.1f}" + ("" if point.in_contact else " (flanks part)"),
        "mode": lambda point: f"{point.mode}",
        "mode, Hz": lambda point: number(point.natural_frequency, 5),
        "share of the mode, %": lambda point: number(100.0 * point.mode_share, 2),
        "bearing": lambda point: point.bearing,
        "alone, dB(A)": lambda point: f"{point.bearing_level:.1f}",
        "without it, dB(A)": lambda point: f"{point.level_without_bearing:.1f}",
    }
    return Table.of("Loudest points, A-weighted", loudest(sound), columns)


def _sentences(sound: RadiatedSound) -> tuple[str, ...]:
    """Return a sentence on the loudest point: its mode, bearing and largest region; empty in silence."""
    sentences = []
    for point in loudest(sound, 1):
        region = sound.metadata["regions"][0][0]  # the largest region of the loudest point
        sentences.append(
            f"{_where(point, sound.metadata)}: {point.weighted_level:.1f} dB(A) through mode {point.mode} of "
            f"{point.mode_housing} ({number(point.natural_frequency, 4)} Hz); bearing {point.bearing} alone "
            f"{point.bearing_level:.1f} dB(A); {100.0 * region['share']:.0f} % leaves {_region_name(region)}"
        )
    return tuple(sentences)


def _where(point: LoudPoint, metadata: Json) -> str:
    speed, hertz = number(point.speed / RPM, 4), number(point.frequency, 4)
    return f"{words_of_order(point.order, metadata)}, at {speed} rpm, {hertz} Hz"


def _headlines(sound: RadiatedSound) -> tuple[Headline, ...]:
    total, points = sound.orders.total_weighted_level, loudest(sound, 1)
    at = int(total.argmax())
    where = f"at {number(float(sound.speed[at]) / RPM, 4)} rpm, all orders"
    floor, off = sound.orders.floor_level, sound.orders.total_error
    if floor is not None and off is not None:
        where += f", of it {floor[at]:.1f} dB(A) ± {engineering(float(off[at]), 2)} dB in those not listed"
    band = sound.metadata["band"]
    if band is not None:
        where += f"; {ends(band['largest_total'])} over the ranges of guesses"
        where += "".join(f"; {text}" for text in narrowest(sound.metadata))
    headlines = [Headline("sound power level", f"{total[at]:.1f} dB(A)", where)]
    if band is not None and sound.speed.size > 1:
        mean = band["mean_total"]
        level = f"{mean['level_db_a']:.1f} dB(A)"
        headlines.append(Headline("mean over the speeds", level, f"of the power, all orders; {ends(mean)}"))
    for point, text in zip(points, _sentences(sound), strict=True):
        headlines.append(Headline("loudest order", f"{point.weighted_level:.1f} dB(A)", text))
    pressure = sound.metadata.get("pressure")
    if pressure is not None:
        headlines.append(_pressure_headline(pressure, sound.metadata))
    parting = sound.speed[~sound.in_contact] / RPM
    if parting.size:
        first = f"from {number(parting[0], 4)} rpm on"
        headlines.append(Headline("flanks part at", f"{parting.size} of {sound.speed.size} speeds", first))
    return tuple(headlines)


def _pressure_headline(pressure: Json, metadata: Json) -> Headline:
    """Return the level at the microphone of the complaint's order, or without a complaint of the loudest."""
    complaint_order = metadata.get("complaint", {}).get("order", np.nan)
    marked = [row for row in pressure["orders"] if np.isclose(row["order"], complaint_order, rtol=1e-6)]
    row = marked[0] if marked else max(pressure["orders"], key=lambda row: row["level_db_a"])
    remark = f"{words_of_order(row['order'], metadata)}, at {number(row['speed_rpm'], 4)} rpm"
    if row["low_db_a"] is not None:
        remark += f"; {row['low_db_a']:.1f} to {row['high_db_a']:.1f}, the band of its sound power"
    name = f"sound pressure level at {_microphone(pressure)}"
    return Headline(name, f"{row['level_db_a']:.1f} dB(A)", remark)


def _microphone(pressure: Json) -> str:
    return f"({', '.join(f'{value:g}' for value in pressure['microphone_mm'])}) mm"


def _pressure_table(pressure: Json, metadata: Json) -> Table:
    """List the orders at the speeds at which they are loudest."""
    caption = f"Largest sound pressure level of each order at {_microphone(pressure)}"
    columns = {
        "order": lambda row: order_label(row["order"], metadata),
        "dB(A)": lambda row: f"{row['level_db_a']:.1f}",
        "from": lambda row: "" if row["low_db_a"] is None else f"{row['low_db_a']:.1f}",
        "to": lambda row: "" if row["high_db_a"] is None else f"{row['high_db_a']:.1f}",
        "speed, rpm": lambda row: number(row["speed_rpm"], 5),
    }
    return Table.of(caption, pressure["orders"], columns)


def _model_tables(sound: RadiatedSound) -> Iterator[Table]:
    for housing in sound.housing:
        compared = sound.metadata["models"][housing]
        if compared.get("predicted"):
            order = order_label(compared["order"], sound.metadata)
            speed = number(compared["speed"] / RPM, 4)
            rows = tuple(_model(name, compared) for name in compared["predicted"])
            yield Table(f"Radiation models of {housing} at order {order}, {speed} rpm", _MODEL_HEAD, rows)


def _model(name: str, compared: Json) -> tuple[str, ...]:
    level, spent = compared["level"].get(name), compared["seconds"].get(name)
    low, high = compared["error_band"][name]
    predicted = compared["predicted"][name]
    return (
        name.replace("_", " "),
        "not computed" if level is None else f"{level:.1f}",
        f"{low:+.1f} to {high:+.1f}",
        amount(spent),
        amount(predicted["seconds"]),
        gigabytes(predicted["bytes"]),
    )


def _region_name(region: Mapping[str, Any]) -> str:
    """Name a region: its housing, the axis that it faces, the named points next to it."""
    named = f" ({', '.join(region['points'])})" if region["points"] else ""
    return f"{region['housing']} at {region['facing']}{named}"


def _region_table(sound: RadiatedSound) -> Table:
    listed = []
    points = loudest(sound, _REGION_POINTS)
    for point, regions in zip(points, sound.metadata["regions"], strict=False):
        listed += [{"point": point, **region} for region in regions]
    columns = {
        "order": lambda region: order_label(region["point"].order, sound.metadata),
        "speed, rpm": lambda region: number(region["point"].speed / RPM, 5),
        "region": _region_name,
        "share, %": lambda region: f"{100.0 * region['share']:.1f}",
        "mW/m²": lambda region: number(1e3 * region["power"] / region["area"], 3),
        "center, mm": lambda region: ", ".join(f"{round(value / MM)}" for value in region["center"]),
        "outward normal": lambda region: ", ".join(f"{round(v, 2) + 0.0:g}" for v in region["normal"]),
        "area, cm²": lambda region: f"{1e4 * region['area']:.1f}",
    }
    return Table.of("Regions through which the loudest points radiate", listed, columns)


def _figures(sound: RadiatedSound) -> tuple[Figure, ...]:
    figures = [_sound_map(sound), _level_over_speed(sound), _third_octaves(sound), _bearing_levels(sound)]
    figures += filter(None, (_panel_intensity(sound),))
    figures += excitation_figures(sound.metadata)
    if sound.metadata.get("over_time") is not None:
        figures.append(third_octaves_over_time(sound.metadata))
    return tuple(figures)


def _limits(sound: RadiatedSound) -> Iterator[tuple[str, str]]:
    """Yield what bounds the levels: a subject and how it is treated."""
    yield from force_rows(sound.metadata)
    for name in sound.housing:
        yield from _radiation_limits(sound, name)
    parting = sound.speed[~sound.in_contact] / RPM
    if parting.size:
        where = f"{parting[0]:.5g} to {parting[-1]:.5g} rpm"
        what = "see loa steady" if of_run(sound.metadata) is None else "their impacts are in the run's total"
        yield "flanks lift off", f"at {parting.size} of {sound.speed.size} speeds, {where}: {what}"


def _radiation_limits(sound: RadiatedSound, housing: str) -> Iterator[tuple[str, str]]:
    about, compared = sound.metadata["radiation"][housing], sound.metadata["models"][housing]
    resolved, valid = about["resolved_frequency"], about["valid_frequency"]
    highest = sound.frequency.max()
    yield (
        housing,
        f"{about['model_name'].replace('_', ' ')}, outer hull {number(about['area'], 3)} m², "
        f"{number(about['inner_area'], 3)} m² of inner walls left out",
    )
    if highest > resolved > 0.0:
        limitation = "which the mesh does not resolve, equivalent radiated power"
        yield f"above {number(resolved, 3)} Hz", limitation
    if highest > valid:
        limitation = "0.7 of the highest mode kept, modes are missing: keep more"
        yield f"above {number(valid, 3)} Hz", limitation
    places = []
    for line in compared.get("lines") or ():
        change = line["level"] - line["estimate"]
        places.append(f"{number(line['frequency'], 4)} Hz ({change:+.1f} dB)")
    if places:
        yield "boundary elements", f"at {', '.join(places)} in the place of the estimate"
    replaced = ", ".join(number(hertz, 4) for hertz in compared.get("replaced") or ())
    if replaced:
        reason = "near interior resonances of the monopoles' surface: by the velocity alone"
        yield f"modes at {replaced} Hz", reason
    for model, reason in compared.get("left_out", {}).items():
        yield f"without {model.replace('_', ' ')}", reason


def _text(sound: RadiatedSound) -> Iterator[Table | str]:
    yield _loudest_table(sound)
    yield _region_table(sound)
    yield from _sentences(sound)
    yield from filter(None, (excitation_table(sound.metadata),))
    yield from (f"{what}: {text}" for what, text in _limits(sound))
    yield from _model_tables(sound)
    yield from uncertainty_tables(sound.metadata)
    yield from narrowest(sound.metadata)
    if sound.metadata.get("pressure") is not None:
        yield _pressure_table(sound.metadata["pressure"], sound.metadata)
    omitted = sound.metadata["sensitivities_left_out"]
    yield from (f"no sensitivity to {name}: {why}" for name, why in omitted.items())
    yield from model_text(sound.metadata)


def _page(sound: RadiatedSound) -> Page:
    page = dynamics_page("Sound power", _figures(sound), _headlines(sound), sound.metadata)
    sections = [*page.sections]
    if sound.metadata.get("pressure") is not None:
        table = _pressure_table(sound.metadata["pressure"], sound.metadata)
        sections.append(Section("Sound pressure", tables=(table,)))
    tables = [*uncertainty_tables(sound.metadata)]
    omitted = sound.metadata["sensitivities_left_out"]
    if omitted:
        tables.append(Table("No sensitivity", ("to", "because"), tuple(omitted.items())))
    if tables:
        sections.append(Section("Bands, and what 1 dB costs", tables=tuple(tables)))
    rests = Table("Radiation models, and what the levels do not hold", ("what", "how"), tuple(_limits(sound)))
    accuracy = Section("Accuracy of the levels", tables=(rests, *_model_tables(sound)), part=Part.ACCURACY)
    return replace(page, sections=(*sections, accuracy))


PAGE = Presentation(_sound_map, _page, _text)
