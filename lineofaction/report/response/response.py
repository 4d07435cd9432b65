"""A forced response: transmission error, mesh force and bearing force by mesh order over speed, and peaks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from bounds import engineering, leftover
from bounds.error_digits import with_error
from dynamics.linearize import ForcedResponse, peaks
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Panel,
    Reference,
    Table,
    category_lines,
    number,
)
from lineofaction.report.drawing.marks import drawn_orders, order_label, words_of_order
from lineofaction.report.drawing.page import Headline
from lineofaction.report.presentation import dynamics_presentation
from lineofaction.report.response.excitations import excitation_figures, excitation_table, omitted_orders

MIN_SHARE = 1e-3
"""Least share of the lost power that is listed, %."""
MAX_ORDERS = 6
"""Largest number of orders in a plot."""
MAX_PEAKS, PRINTED_PEAKS = 15, 4
"""Largest numbers of peaks of a quantity on the page and on a terminal."""
WITH_MESHES = (
    "Peak amplitudes of the mesh orders about the static equilibrium, linear: stiffness varies with "
    "position, no loss of contact. Last: the least mesh force; negative means that flanks lift off."
)
WITHOUT_MESHES = "Peak amplitudes of the orders of the leading shaft about the static equilibrium, linear."


def _loses_power(response: ForcedResponse) -> bool:
    """Whether any part loses power; False for files of older versions, which do not hold the power."""
    return bool(np.any(_total(response) > 0.0))


def _power_table(response: ForcedResponse) -> Table:
    """List where the power goes at the speed at which most is lost."""
    power, total = response.power, _total(response)
    speed = int(np.argmax(total))
    by_part = np.sum(power.loss[:, speed], axis=1)
    rows = []
    for kind, loss in power.by_kind().items():
        same_kind = [part for part, name in enumerate(power.kind) if name == kind]
        maximum = max(same_kind, key=lambda part: by_part[part])
        share = 100.0 * float(loss[speed] / total[speed])
        if abs(share) >= MIN_SHARE:
            rows.append((kind, power.sink[maximum], number(loss[speed], 3), number(share, 3)))
    title = f"Power lost at {number(float(response.speed[speed]) / RPM, 4)} rpm, all orders"
    return Table(title, ("lost in", "most in", "W", "%"), tuple(rows))


def _power_figure(response: ForcedResponse) -> Figure:
    table = _power_table(response)
    kinds = {row[0] for row in table.rows}
    losses = response.power.by_kind()
    # lines are made for all kinds, so that a kind keeps its color whichever others are drawn
    of_all = category_lines(response.speed / RPM, list(losses), losses.values())
    lines = tuple(line for line in of_all if line.name in kinds)
    maximum = max(losses, key=lambda kind: float(np.max(losses[kind])))
    return Figure(
        key="power",
        title="Power lost by the vibration",
        caption="Mean power of all orders that transmission errors and loads put in, by the parts that take "
        "it. Friction of a mesh may feed the vibration: then its power is negative.",
        alternative=f"At its largest, most of it is lost in parts of the kind {maximum}.",
        content=(Panel(_speed_axis(response), Axis("power lost, W"), lines),),
        table=table,
    )


def _speed_axis(response: ForcedResponse) -> Axis:
    return Axis.over(f"speed of {response.metadata['leading_shaft']}, rpm", response.speed / RPM)


def _total(response: ForcedResponse) -> FloatArray:
    """Return the power loss of all parts, (S,) W."""
    return np.asarray(np.sum(response.power.loss, axis=(0, 2)))


def _response_figure(response: ForcedResponse) -> Figure:
    x, speed = _speed_axis(response), response.speed / RPM
    quantities = _quantities(response)
    largest = np.empty(0)  # amplitude of each order
    if quantities:
        _, amplitude = quantities[1 if response.mesh else 0]  # the mesh force, or else the bearing force
        largest = np.max(amplitude, axis=0)
    drawn = drawn_orders(response.order[: largest.size], largest, MAX_ORDERS, response.metadata)
    names = [f"order {order_label(response.order[h], response.metadata)}" for h in drawn]
    panels = []
    for label, amplitude in quantities:
        panels.append(Panel(x, Axis(label), category_lines(speed, names, amplitude[:, drawn].T)))
    if response.mesh:
        line = Line("least mesh force", speed, response.least_mesh_force[0], palette.INK, width=1.4)
        lift_off = Reference("flanks part", 0.0, "horizontal", at=0.12)
        panels.append(Panel(x, Axis("least mesh force, N"), (line,), (lift_off,)))
    return Figure(
        key="response",
        title="Forced response to transmission errors and loads" if response.mesh else "Forced response",
        caption=WITH_MESHES if response.mesh else WITHOUT_MESHES,
        alternative=_alternative(response),
        content=tuple(panels),
        table=_peak_table(response),
    )


def _quantities(response: ForcedResponse) -> list[tuple[str, FloatArray]]:
    """Return the shown quantities by name, (S, H) each: those of the first mesh, and a bearing force."""
    quantities = []
    if response.mesh:
        name = f" of {response.mesh[0]}" if len(response.mesh) > 1 else ""
        error = 1e6 * np.abs(response.dynamic_transmission_error[0])
        quantities.append((f"transmission error{name}, µm", error))
        quantities.append((f"mesh force{name}, N", np.abs(response.mesh_force[0])))
    force = _bearing_force(response)
    if force.size:
        name = response.metadata.get("complaint", {}).get("bearing")
        bearing = int(np.argmax(np.max(force, axis=(1, 2)))) if name is None else response.bearing.index(name)
        quantities.append((f"force on {response.bearing[bearing]}, N", force[bearing]))
    return quantities


def _bearing_force(response: ForcedResponse) -> FloatArray:
    """Return the size of the force on each bearing, (b, S, H)."""
    return np.asarray(np.sqrt(np.sum(np.abs(response.bearing_force[:, :3]) ** 2, axis=1)))


def _peak_table(response: ForcedResponse, maximum: int = MAX_PEAKS) -> Table:
    listed = []
    for quantity in ("mesh_force", "bearing_force"):
        listed += [peak for peak in peaks(response) if peak.quantity == quantity][:maximum]
    columns = {
        "force of": lambda peak: f"{peak.quantity.removesuffix('_force')} {peak.name}",
        "order": lambda peak: order_label(peak.order, response.metadata),
        "speed, rpm": lambda peak: number(peak.speed / RPM, 5),
        "frequency, Hz": lambda peak: number(peak.frequency, 5),
        "nearest mode, Hz": lambda peak: number(peak.natural_frequency, 5),
        "amplitude, N": lambda peak: number(peak.amplitude, 4),
        "dynamic over static": lambda peak: number(peak.amplification, 3) if peak.amplification else "-",
    }
    return Table.of("Peaks over speed, the largest first", listed, columns)


def _alternative(response: ForcedResponse) -> str:
    if not response.mesh:
        return " ".join(f"{part.name}: {part.value}, {part.remark}." for part in _headlines(response))
    size = np.abs(response.mesh_force)
    _, s, h = map(int, np.unravel_index(int(np.argmax(size)), size.shape))
    text = f"Largest mesh force: {number(size.max(), 3)} N, {_at(response, s, h)}."
    parting = response.speed[~response.in_contact] / RPM
    if parting.size:
        first = number(parting[0], 4)
        text += f" Flanks lift off at {parting.size} of {response.speed.size} speeds, from {first} rpm on."
    return text


def _headlines(response: ForcedResponse) -> tuple[Headline, ...]:
    parting = response.speed[~response.in_contact] / RPM
    on_meshes, on_bearings = np.abs(response.mesh_force), _bearing_force(response)
    headlines = []
    if on_meshes.size:
        headlines.append(_largest("mesh force of", response.mesh, on_meshes, response))
    if on_bearings.size:
        headlines.append(_largest("force on bearing", response.bearing, on_bearings, response))
    if not parting.size:
        return tuple(headlines)
    at = f"{parting.size} of {response.speed.size} speeds"
    return (headlines[0], Headline("flanks part at", at, f"from {number(parting[0], 4)} rpm on"))


def _largest(quantity: str, names: Sequence[str], size: FloatArray, response: ForcedResponse) -> Headline:
    """Return a headline on the largest amplitude of `size` (part, speed, order), with its order and speed."""
    part, s, h = map(int, np.unravel_index(int(np.argmax(size)), size.shape))
    value = f"{number(size[part, s, h], 3)} N"
    return Headline(f"largest {quantity} {names[part]}", value, _at(response, s, h))


def _at(response: ForcedResponse, speed: int, order: int) -> str:
    words = words_of_order(response.order[order], response.metadata)
    return f"{words}, at {engineering(float(response.speed[speed]) / RPM, 4)} rpm"


def _figures(response: ForcedResponse) -> tuple[Figure, ...]:
    figures = (_response_figure(response), *excitation_figures(response.metadata))
    return (*figures, _power_figure(response)) if _loses_power(response) else figures


def _text(response: ForcedResponse) -> Iterator[Table | str]:
    yield _peak_table(response, PRINTED_PEAKS)
    yield from filter(None, (excitation_table(response.metadata),))
    parting = response.speed[~response.in_contact] / RPM
    if parting.size:
        where = f"{parting[0]:.5g} to {parting[-1]:.5g} rpm"
        yield f"flanks lift off at {parting.size} of {response.speed.size} speeds, {where}: see loa steady"
    worst = f"{engineering(100.0 * float(response.excitation_difference.max(initial=0.0)), 2)} %"
    yield f"first-order theory: the other excitation changes amplitudes by up to {worst} of the largest"
    yield from (f"{name}: {text}" for name, text in omitted_orders(response.metadata))
    yield from _omission_text(response)
    if _loses_power(response):
        yield _power_table(response)
    left = response.power.residual
    yield f"residual of the solves {leftover(response.residual)}, of the power balance {leftover(left)}"


def _omission_text(response: ForcedResponse) -> Iterator[str]:
    """Yield a sentence on unlisted orders: their part in the largest bearing force of all orders."""
    if response.bearing_floor.size:
        square, floor = response.bearing_mean_square, response.bearing_floor
        bearing, speed = np.unravel_index(int(np.argmax(square)), square.shape)
        rms = float(np.sqrt(square[bearing, speed]))
        remark = f"{number(float(np.sqrt(floor[bearing, speed])), 3)} N of it in the orders not listed"
        floor_error = response.bearing_floor_error[bearing, speed]
        error = rms - float(np.sqrt(max(square[bearing, speed] - floor_error, 0.0)))
        where = f"{response.bearing[bearing]} at {number(float(response.speed[speed]) / RPM, 4)} rpm"
        yield f"largest rms force of all orders: {with_error(rms, error, 'N')} on {where}, {remark}"


PAGE = dynamics_presentation("Forced response", _figures, _headlines, _text)
