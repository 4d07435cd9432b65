"""A forced response: transmission error, mesh force and bearing force by mesh order over speed, and peaks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from bounds import engineering, leftover
from dynamics.linearize import ForcedResponse, peaks
from lineofaction.gearbox.convert.effects import model_lines
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page

LEAST_SHARE = 1e-3
"""%, of what is listed."""


def _loses_power(response: ForcedResponse) -> bool:
    """Whether any part loses power; files of older versions do not know."""
    return bool(np.any(_total(response) > 0.0))


def _power_table(response: ForcedResponse) -> Table:
    """List where the power goes at the speed at which most is lost."""
    power, total = response.power, _total(response)
    at = int(np.argmax(total))
    by_part = np.sum(power.loss[:, at], axis=1)
    rows = []
    for kind, lost in power.by_kind().items():
        own = [part for part, each in enumerate(power.kind) if each == kind]
        most = max(own, key=lambda part: by_part[part])
        share = 100.0 * float(lost[at] / total[at])
        if abs(share) >= LEAST_SHARE:
            rows.append((kind, power.sink[most], number(float(lost[at]), 3), number(share, 3)))
    title = f"Power lost at {number(float(response.speed[at]) / RPM, 4)} rpm, all orders"
    return Table(title, ("lost in", "most in", "W", "%"), tuple(rows))


def _power_figure(response: ForcedResponse) -> Figure:
    """Draw what kinds of parts lose over speed."""
    speed, table = response.speed / RPM, _power_table(response)
    kinds = {row[0] for row in table.rows}
    ends = (float(speed[0]), float(speed[-1])) if speed.size > 1 else None
    lines = tuple(
        Line(kind, speed, lost, palette.category(index), width=1.4)
        for index, (kind, lost) in enumerate(response.power.by_kind().items())
        if kind in kinds
    )
    panel = Panel(
        Axis(f"speed of {response.facts['leading_shaft']}, rpm", limits=ends), Axis("power lost, W"), lines
    )
    most = max(response.power.by_kind().items(), key=lambda item: float(np.max(item[1])))[0]
    return Figure(
        key="power",
        title="Power lost by the vibration",
        caption=(
            "Mean power of all orders that transmission errors and loads put in, by the parts that take it. "
            "Friction of a mesh may feed the vibration: then its power is negative."
        ),
        alternative=f"At its largest, most of it is lost in parts of the kind {most}.",
        content=(panel,),
        table=table,
    )


def _total(response: ForcedResponse) -> FloatArray:
    """Return what all parts lose, (S,) W."""
    return np.asarray(np.sum(response.power.loss, axis=(0, 2)))


SHOWN_ORDERS, SHOWN_PEAKS = 6, 15

WITH_MESHES = (
    "Peak amplitudes of the mesh orders about the static equilibrium, linear: mean mesh stiffness, no loss "
    "of contact. Below: the least mesh force; negative means that flanks lift off."
)
WITHOUT_MESHES = "Peak amplitudes of the orders of the leading shaft about the static equilibrium, linear."


def _response_figure(response: ForcedResponse, mesh: int = 0) -> Figure:
    """Draw the largest orders of one mesh and of the bearing that feels most."""
    speed = response.speed / RPM
    ends = (float(speed[0]), float(speed[-1])) if speed.size > 1 else None
    x = Axis(f"speed of {response.facts['leading_shaft']}, rpm", limits=ends)
    quantities = _quantities(response, mesh)
    shown = _loudest(quantities[1 if response.mesh else 0][1]) if quantities else []
    panels = [_panel(x, label, speed, amplitude, response, shown) for label, amplitude in quantities]
    if response.mesh:
        panels.append(_least(x, speed, response, mesh))
    return Figure(
        key="response",
        title="Forced response to transmission errors and loads" if response.mesh else "Forced response",
        caption=WITH_MESHES if response.mesh else WITHOUT_MESHES,
        alternative=_words(response),
        content=tuple(panels),
        table=_peak_table(response),
    )


def _quantities(response: ForcedResponse, mesh: int) -> list[tuple[str, FloatArray]]:
    """Return what is shown by name, (S, H) each."""
    quantities = []
    if response.mesh:
        name = f" of {response.mesh[mesh]}" if len(response.mesh) > 1 else ""
        quantities += [
            (f"transmission error{name}, µm", 1e6 * np.abs(response.dynamic_transmission_error[mesh])),
            (f"mesh force{name}, N", np.abs(response.mesh_force[mesh])),
        ]
    force = _bearing_force(response)
    if force.size:
        loudest = int(np.argmax(np.max(force, axis=(1, 2))))
        quantities.append((f"force on {response.bearing[loudest]}, N", force[loudest]))
    return quantities


def _bearing_force(response: ForcedResponse) -> FloatArray:
    """Return the size of the force on each bearing, (b, S, H)."""
    return np.asarray(np.sqrt(np.sum(np.abs(response.bearing_force[:, :3]) ** 2, axis=1)))


def _loudest(amplitude: FloatArray) -> list[int]:
    """Return the harmonics (of S, H) of the largest amplitudes, by rising order."""
    most = np.argsort(-np.max(amplitude, axis=0), kind="stable")[:SHOWN_ORDERS]
    return sorted(int(h) for h in most)


def _panel(
    x: Axis, label: str, speed: FloatArray, amplitude: FloatArray, response: ForcedResponse, shown: list[int]
) -> Panel:
    """One quantity by order."""
    lines = tuple(
        Line(f"order {response.order[h]:.4g}", speed, amplitude[:, h], palette.category(k), width=1.4)
        for k, h in enumerate(shown)
    )
    return Panel(x, Axis(label), lines)


def _least(x: Axis, speed: FloatArray, response: ForcedResponse, mesh: int) -> Panel:
    line = Line("least mesh force", speed, response.least_mesh_force[mesh], palette.INK, width=1.4)
    return Panel(
        x, Axis("least mesh force, N"), (line,), (Reference("flanks part", 0.0, "horizontal", 0.12),)
    )


def _peak_table(response: ForcedResponse) -> Table:
    """List the largest peaks of mesh and bearing forces."""
    rows: list[tuple[str, ...]] = []
    every = peaks(response)
    for quantity in ("mesh_force", "bearing_force"):
        own = [peak for peak in every if peak.quantity == quantity][:SHOWN_PEAKS]
        rows += [
            (
                f"{quantity.replace('_', ' ')}, {peak.name}",
                f"{peak.order:.4g}",
                number(peak.speed / RPM, 5),
                number(peak.frequency, 5),
                number(peak.natural_frequency, 5),
                number(peak.amplitude, 4),
                number(peak.amplification, 3),
            )
            for peak in own
        ]
    head = (
        "peak of",
        "order",
        "speed, rpm",
        "frequency, Hz",
        "nearest mode, Hz",
        "amplitude, N",
        "dynamic over static",
    )
    return Table("Peaks over speed, the largest first", head, tuple(rows))


def _words(response: ForcedResponse) -> str:
    """Say the largest amplitude, and where flanks part."""
    if not response.mesh:
        return " ".join(f"{part.name}: {part.value}, {part.remark}." for part in headlines(response))
    size = np.abs(response.mesh_force)
    mesh, s, h = np.unravel_index(int(np.argmax(size)), size.shape)
    text = (
        f"Largest mesh force: {number(float(size[mesh, s, h]), 3)} N of order {response.order[h]:.4g} at "
        f"{number(float(response.speed[s]) / RPM, 4)} rpm."
    )
    parting = response.speed[~response.in_contact] / RPM
    if parting.size:
        first = number(float(parting[0]), 4)
        text += f" Flanks lift off at {parting.size} of {response.speed.size} speeds, from {first} rpm on."
    return text


def headlines(response: ForcedResponse) -> tuple[Headline, ...]:
    """Return the largest mesh force, and the largest bearing force or where flanks part."""
    parting, force = response.speed[~response.in_contact] / RPM, _bearing_force(response)
    own = [("mesh force of", response.mesh, np.abs(response.mesh_force))]
    own += [("force on bearing", response.bearing, force)]
    shown = [_largest(what, names, size, response) for what, names, size in own if size.size]
    if not parting.size:
        return tuple(shown)
    at = f"{parting.size} of {response.speed.size} speeds"
    return (shown[0], Headline("flanks part at", at, f"from {number(float(parting[0]), 4)} rpm on"))


def _largest(what: str, names: Sequence[str], size: FloatArray, response: ForcedResponse) -> Headline:
    """Name the part of the largest amplitude (part, speed, order) with its order and speed."""
    part, s, h = map(int, np.unravel_index(int(np.argmax(size)), size.shape))
    at = f"order {response.order[h]:.4g} at {number(float(response.speed[s]) / RPM, 4)} rpm"
    return Headline(f"largest {what} {names[part]}", f"{number(float(size[part, s, h]), 3)} N", at)


def _figures(response: ForcedResponse) -> tuple[Figure, ...]:
    """Return amplitudes, and the power lost if any is."""
    figure = _response_figure(response)
    return (figure, _power_figure(response)) if _loses_power(response) else (figure,)


def _text(response: ForcedResponse) -> Iterator[Table | str]:
    """Peaks, and what the linear answer does not hold."""
    yield _peak_table(response)
    parting = response.speed[~response.in_contact] / RPM
    if parting.size:
        where = f"{parting[0]:.5g} to {parting[-1]:.5g} rpm"
        yield f"flanks lift off at {parting.size} of {response.speed.size} speeds, {where}: see loa steady"
    worst = 100.0 * float(response.excitation_difference.max(initial=0.0))
    yield (
        "first-order theory: the other excitation changes "
        f"amplitudes by up to {engineering(worst, 2)} % of the largest"
    )
    if _loses_power(response):
        yield _power_table(response)
    left = response.power.residual
    yield f"residual of the solves {leftover(response.residual)}, of the power balance {leftover(left)}"
    yield from cost_tables(response.facts)
    yield from model_lines(response.facts)


PAGE = Presentation(
    _response_figure,
    lambda response: dynamics_page(
        "Forced response", _figures(response), headlines(response), response.facts
    ),
    _text,
)
