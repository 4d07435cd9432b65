"""A modal analysis: Campbell diagram with mesh orders and critical speeds, energies of the modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import leftover
from dynamics.linearize import ModalAnalysis
from lineofaction.gearbox.convert.effects import model_lines
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Dash,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    Table,
    number,
)
from lineofaction.report.drawing.modes import mode_bars
from lineofaction.report.drawing.page import Headline
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page

RPM = np.pi / 30.0
CIRCULAR = 0.1  # from this whirl on a mode counts as forward or backward
ALIKE = 1e-3  # of a frequency or a speed: nearer ones share a line of the tables
SHOWN_PARTS = 2
SHOWN_MODES = 10
HEADROOM = 1.15  # of the highest mode or order: modes that no order reaches are only in the table
LEAST_TOP = 1.0  # Hz
ROOM = 0.03  # of the width, for the name of an order; orders that leave closer stay without
WHIRLS: dict[str, tuple[str, Dash]] = {
    "forward whirl": (palette.BLUE, "solid"),
    "backward whirl": (palette.VERMILLION, "dash"),
    "in a plane": (palette.MUTED, "solid"),
}


def _modal_figures(modes: ModalAnalysis) -> tuple[Figure, ...]:
    """Draw the Campbell diagram, if there are speeds, and the energies."""
    return (_campbell(modes), *_energies(modes)) if modes.speed.size > 1 else _energies(modes)


def _whirl_name(whirl: float) -> str:
    if abs(whirl) < CIRCULAR:
        return "in a plane"
    return "forward whirl" if whirl > 0.0 else "backward whirl"


def _campbell(modes: ModalAnalysis) -> Figure:
    """Frequencies over speed."""
    speed = modes.speed / RPM
    reach = float(modes.facts["orders"]) * float(np.max(modes.mesh_frequency, initial=0.0))
    top = min(HEADROOM * float(np.nanmax(modes.frequency)), max(HEADROOM * reach, LEAST_TOP))
    lines = [*_orders(modes, speed, top), *_modes(modes, speed)]
    if modes.critical_speed.size:
        there = modes.critical_speed / RPM
        lines.append(
            Line("critical speeds", there, modes.critical_frequency, palette.INK, width=0.0, markers=True)
        )
    x = Axis(f"speed of {modes.facts['leading_shaft']}, rpm", limits=(float(speed[0]), float(speed[-1])))
    y = Axis("frequency, Hz", limits=(0.0, top))
    return Figure(
        key="modal_campbell",
        title="Campbell diagram: whirl modes over speed",
        caption="Damped frequencies about the static equilibrium with gyroscopic, Coriolis and centripetal "
        "terms of each speed. Dotted: multiples of the mesh frequency. Points: critical speeds.",
        alternative=_words(modes),
        content=(Panel(x, y, tuple(lines), notes=tuple(_order_notes(modes, speed, top))),),
        table=_critical_table(modes),
    )


def _orders(modes: ModalAnalysis, speed: FloatArray, top: float) -> Iterator[Line]:
    """Multiples of every mesh frequency, each once."""
    for mesh in _different(modes):
        for order in range(1, int(modes.facts["orders"]) + 1):
            height = order * modes.mesh_frequency[mesh]
            yield Line(
                "mesh orders", speed, np.where(height <= top, height, np.nan), palette.PURPLE, "dot", 1.0
            )


def _different(modes: ModalAnalysis) -> list[int]:
    """Meshes whose frequency no earlier one has."""
    last = modes.mesh_frequency[:, -1]
    return [
        m for m in range(last.size) if last[m] > 0.0 and not np.any(np.isclose(last[:m], last[m], rtol=1e-9))
    ]


def _order_notes(modes: ModalAnalysis, speed: FloatArray, top: float) -> Iterator[Note]:
    """Name the orders where they leave the panel."""
    several, width = len(_different(modes)) > 1, float(np.ptp(speed))
    for mesh in _different(modes):
        rate, last = float(modes.mesh_frequency[mesh, -1] / speed[-1]), np.inf
        for order in range(1, int(modes.facts["orders"]) + 1):
            end = min(float(speed[-1]), 0.97 * top / (order * rate))
            if end <= speed[0] or last - end < ROOM * width:
                continue
            last, name = end, f"{order}x {modes.mesh[mesh]}" if several else f"{order}x"
            yield Note(end - ROOM * width, order * rate * end * 0.985, name)


def _modes(modes: ModalAnalysis, speed: FloatArray) -> Iterator[Line]:
    """Every mode by its sense of whirl; points between two speeds take that of the first."""
    for name, (color, dash) in WHIRLS.items():
        for mode in range(modes.frequency.shape[1]):
            here = np.array([_whirl_name(w) == name for w in modes.whirl[:, mode]])
            if not np.any(here):
                continue
            shown = here | np.append(False, here[:-1])
            yield Line(name, speed, np.where(shown, modes.frequency[:, mode], np.nan), color, dash, 1.6)


def _energies(modes: ModalAnalysis) -> tuple[Figure, Figure]:
    """Show what holds each natural mode (meshes, bearings, drives), and what moves in it (shafts)."""
    shown = np.flatnonzero(modes.natural_frequency > 0.0)[:SHOWN_MODES]
    names = [f"{number(float(modes.natural_frequency[mode]), 4)} Hz" for mode in shown]
    held = [modes.held_by(modes.natural_strain_energy[mode]) for mode in shown]
    moved = [modes.moved(modes.natural_kinetic_energy[mode]) for mode in shown]
    alike = (
        f"At most the {SHOWN_MODES} lowest modes; those of one frequency are any combination of each other."
    )
    return (
        Figure(
            key="modal_energy",
            title="Strain energy of the natural modes at rest",
            caption=f"Strain energy by mesh, bearing, coupling and drive. {alike}",
            alternative=_energy_words(names, held, "strain"),
            content=(mode_bars(names, held, "strain energy"),),
            table=_modes_table(modes),
        ),
        Figure(
            key="modal_motion",
            title="Kinetic energy of the natural modes at rest",
            caption=f"Kinetic energy by shaft and kind of motion. {alike}",
            alternative=_energy_words(names, moved, "kinetic"),
            content=(mode_bars(names, moved, "kinetic energy"),),
        ),
    )


def _energy_words(names: list[str], shares: list[dict[str, float]], energy: str) -> str:
    """Say which part has most of an energy of the lowest mode."""
    if not names:
        return "Nothing vibrates."
    part, share = next(iter(shares[0].items()))
    return f"The lowest mode, {names[0]}, has {number(100.0 * share, 2)} % of its {energy} energy in {part}."


def _modes_table(modes: ModalAnalysis) -> Table:
    """List the natural modes at rest; those of one frequency are still one line each."""
    rows = []
    for mode, frequency in enumerate(modes.natural_frequency):
        strain, kinetic = modes.natural_strain_energy[mode], modes.natural_kinetic_energy[mode]
        rows.append(
            (
                str(mode + 1),
                number(float(frequency), 5),
                number(100.0 * float(modes.natural_damping_ratio[mode]), 3),
                modes.kind(strain, kinetic),
                _shares(modes.held_by(strain)),
                _shares(modes.moved(kinetic)),
            )
        )
    head = ("mode", "frequency, Hz", "damping ratio, %", "kind", "strain energy in", "kinetic energy in")
    return Table("Natural modes about the static equilibrium, at rest", head, tuple(rows))


def _shares(parts: dict[str, float]) -> str:
    shown = [f"{name} {100.0 * share:.0f} %" for name, share in parts.items() if share >= 0.005]
    return ", ".join(shown[:SHOWN_PARTS]) or "none"


def _critical_table(modes: ModalAnalysis) -> Table:
    """List the critical speeds; modes that an order meets together share a line."""
    groups: list[list[int]] = []
    for index, speed in enumerate(modes.critical_speed):
        mate = next((g for g in groups if _together(modes, g[0], index, float(speed))), None)
        if mate is None:
            groups.append([index])
        else:
            mate.append(index)
    head = ("speed, rpm", "frequency, Hz", "order", "mesh", "modes", "kind", "whirl", "damping ratio, %")
    rows = tuple(_critical_row(modes, group) for group in groups)
    return Table("Critical speeds: where a mesh order meets a mode", head, rows)


def _together(modes: ModalAnalysis, first: int, other: int, speed: float) -> bool:
    same = modes.critical_order[first] == modes.critical_order[other]
    same = same and modes.critical_mesh[first] == modes.critical_mesh[other]
    return bool(same and abs(modes.critical_speed[first] - speed) <= ALIKE * speed)


def _critical_row(modes: ModalAnalysis, group: list[int]) -> tuple[str, ...]:
    """One line of the table."""
    kinds: dict[str, None] = {}
    senses: dict[str, None] = {}
    for index in group:
        mode = int(modes.critical_mode[index])
        known = np.isfinite(modes.frequency[:, mode])
        row = int(np.argmin(np.where(known, np.abs(modes.speed - modes.critical_speed[index]), np.inf)))
        kinds[modes.kind(modes.strain_energy[row, mode], modes.kinetic_energy[row, mode])] = None
        senses[_whirl_name(float(modes.whirl[row, mode])).removesuffix(" whirl")] = None
    first = group[0]
    return (
        number(float(modes.critical_speed[first]) / RPM, 5),
        number(float(modes.critical_frequency[first]), 5),
        str(int(modes.critical_order[first])),
        modes.mesh[int(modes.critical_mesh[first])],
        ", ".join(str(int(modes.critical_mode[index]) + 1) for index in group),
        "; ".join(kinds),
        ", ".join(senses),
        number(100.0 * float(np.min(modes.critical_damping_ratio[group])), 3),
    )


def _words(modes: ModalAnalysis) -> str:
    """Say how many crossings there are and where the least damped is."""
    if not modes.critical_speed.size:
        return "No mesh order meets a mode in this range."
    least = int(np.argmin(modes.critical_damping_ratio))
    return (
        f"{modes.critical_speed.size} crossings; the least damped, with "
        f"{number(100.0 * float(modes.critical_damping_ratio[least]), 3)} %, at "
        f"{number(float(modes.critical_speed[least]) / RPM, 4)} rpm and "
        f"{number(float(modes.critical_frequency[least]), 4)} Hz, mesh order "
        f"{int(modes.critical_order[least])}."
    )


def headlines(modes: ModalAnalysis) -> tuple[Headline, ...]:
    """Return the lowest natural frequency, and the least damped critical speed."""
    elastic = np.flatnonzero(modes.natural_frequency > 0.0)
    if not elastic.size:
        return ()
    first = int(elastic[0])
    kind = modes.kind(modes.natural_strain_energy[first], modes.natural_kinetic_energy[first])
    frequency = f"{number(float(modes.natural_frequency[first]), 4)} Hz"
    lowest = Headline("lowest natural frequency", frequency, kind)
    return (lowest, _least_damped(modes)) if modes.speed.size else (lowest,)


def _least_damped(modes: ModalAnalysis) -> Headline:
    """Return the least damped of the critical speeds."""
    count = modes.critical_speed.size
    if not count:
        return Headline("critical speeds", "none", "no mesh order meets a mode in this range")
    least = int(np.argmin(modes.critical_damping_ratio))
    damping = f"{number(100.0 * float(modes.critical_damping_ratio[least]), 3)} %"
    order = f"mesh order {int(modes.critical_order[least])}"
    speed = f"{number(float(modes.critical_speed[least]) / RPM, 4)} rpm"
    return Headline("least damped critical speed", speed, f"{order}, damping ratio {damping}, of {count}")


def _text(modes: ModalAnalysis) -> Iterator[Table | str]:
    """Modes and critical speeds."""
    start = modes.facts["equilibrium"]
    forces = ", ".join(f"{name} {force:.5g} N" for name, force in start["mesh_force"].items())
    yield f"static equilibrium {start['status'].lower()}, {leftover(start['residual'])} N left; {forces}"
    yield _modes_table(modes)
    if modes.speed.size:
        yield ""
        yield _critical_table(modes)
    yield from cost_tables(modes.facts)
    yield from model_lines(modes.facts)


PAGE = Presentation(
    lambda modes: _modal_figures(modes)[0],
    lambda modes: dynamics_page("Modes", _modal_figures(modes), headlines(modes), modes.facts),
    _text,
)
