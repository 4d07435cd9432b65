"""A modal analysis: Campbell diagram, critical speeds, energies, housings in their lowest modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import engineering
from dynamics.linearize import ModalAnalysis
from dynamics.linearize.modal_analysis import LARGE
from dynamics.linearize.mode_energy import freedom_parts
from lineofaction.gearbox.studies.modes.run import surface_shape
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Dash,
    Figure,
    FloatArray,
    Line,
    Panel,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline
from lineofaction.report.drawing.placing import named_along
from lineofaction.report.drawing.surface_view import shape_figure
from lineofaction.report.presentation import dynamics_presentation
from lineofaction.report.response.mode_lines import mode_bars, whirl_name

ALIKE = 1e-3  # relative difference of frequencies or speeds that share a line of the tables
MAX_PARTS = 2
MAX_MODES, PRINTED_MODES = 10, 20
HEADROOM = 1.15  # top of the plot over the highest mode or order; modes that no order reaches are not drawn
MIN_TOP = 1.0  # least top of the plot, Hz
NOTE_TOP = 0.97  # height up to which the name of an order stands, over that of the plot
PLACES = 40  # points of the line of an order at which its name may stand
WHIRLS: dict[str, tuple[str, Dash]] = {
    "forward whirl": (palette.BLUE, "solid"),
    "backward whirl": (palette.VERMILLION, "dash"),
    "whirl in a plane": (palette.MUTED, "solid"),
}


def _modal_figures(modes: ModalAnalysis) -> tuple[Figure, ...]:
    over_speed = (_campbell(modes),) if modes.speed.size > 1 else ()
    return (*over_speed, *_energies(modes), *_housing(modes))


def _housing(modes: ModalAnalysis) -> tuple[Figure, ...]:
    """Draw the housing in the lowest mode at rest in which it moves much; nothing without its surface."""
    of_housing = [move == "housing" for _, move in freedom_parts(modes.freedom)]
    share = modes.natural_kinetic_energy[:, of_housing].sum(axis=1)
    lowest = np.flatnonzero((modes.natural_frequency > 0.0) & (share > LARGE))[:1]
    figures = []
    for mode in lowest:
        shape = surface_shape(modes, modes.natural_shape[mode])
        title = f"The housing in mode {mode + 1} at rest, {number(modes.natural_frequency[mode], 4)} Hz"
        if shape is not None:
            figures.append(shape_figure("modal_housing", title, shape, unit=None))  # a mode has no size
    return tuple(figures)


def _campbell(modes: ModalAnalysis) -> Figure:
    speed = modes.speed / RPM
    reach = float(modes.metadata["orders"]) * float(np.max(modes.mesh_frequency, initial=0.0))
    top = min(HEADROOM * float(np.nanmax(modes.frequency)), max(HEADROOM * reach, MIN_TOP))
    lines = [*_orders(modes, speed, top), *_modes(modes, speed)]
    if modes.critical_speed.size:
        points = modes.critical_speed / RPM, modes.critical_frequency
        lines.append(Line("critical speeds", *points, palette.INK, width=0.0, markers=True))
    x = Axis.over(f"speed of {modes.metadata['leading_shaft']}, rpm", speed)
    y = Axis("frequency, Hz", limits=(0.0, top))
    names = named_along([*_named_orders(modes, speed, top)], x, y)
    return Figure(
        key="modal_campbell",
        title="Campbell diagram: whirl modes over speed",
        caption="Damped frequencies about the static equilibrium with gyroscopic, Coriolis and centripetal "
        "terms of each speed. Dotted: multiples of the mesh frequency. Points: critical speeds.",
        alternative=_alternative(modes),
        content=(Panel(x, y, tuple(lines), notes=names),),
        table=_critical_table(modes),
    )


def _orders(modes: ModalAnalysis, speed: FloatArray, top: float) -> Iterator[Line]:
    """Yield the lines of the multiples of every mesh frequency; equal meshes have them once."""
    for mesh in _different(modes):
        for order in range(1, int(modes.metadata["orders"]) + 1):
            height = order * modes.mesh_frequency[mesh]
            drawn = np.where(height <= top, height, np.nan)
            yield Line("mesh orders", speed, drawn, palette.PURPLE, "dot", 1.0)


def _different(modes: ModalAnalysis) -> list[int]:
    """Return the indices of the turning meshes whose frequency no earlier mesh has."""
    different = []
    last = modes.mesh_frequency[:, -1]
    for mesh in np.flatnonzero(last > 0.0).tolist():
        if not np.any(np.isclose(last[:mesh], last[mesh], rtol=1e-9)):
            different.append(mesh)
    return different


def _named_orders(
    modes: ModalAnalysis, speed: FloatArray, top: float
) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield the names of the orders and points of their lines, from where they leave the plot downwards."""
    meshes = _different(modes)
    for mesh in meshes:
        rate = float(modes.mesh_frequency[mesh, -1] / speed[-1])
        for order in range(1, int(modes.metadata["orders"]) + 1):
            end = min(float(speed[-1]), NOTE_TOP * top / (order * rate))
            points = np.linspace(end, float(speed[0]), PLACES) if end > speed[0] else np.empty(0)
            name = f"{order}x {modes.mesh[mesh]}" if len(meshes) > 1 else f"{order}x"
            yield name, points, order * rate * points


def _modes(modes: ModalAnalysis, speed: FloatArray) -> Iterator[Line]:
    """Return the curve of every mode in parts by its sense of whirl.

    Between two speeds a curve has the sense of the lower one.
    """
    for name, (color, dash) in WHIRLS.items():
        for mode in range(modes.frequency.shape[1]):
            at_whirl = np.array([whirl_name(w) == name for w in modes.whirl[:, mode]])
            if not np.any(at_whirl):
                continue
            drawn = at_whirl | np.append(False, at_whirl[:-1])  # up to the next speed
            frequency = np.where(drawn, modes.frequency[:, mode], np.nan)
            yield Line(name.removeprefix("whirl "), speed, frequency, color, dash, 1.6)


def _energies(modes: ModalAnalysis) -> tuple[Figure, Figure]:
    """Show the strain energy of each natural mode (meshes, bearings, drives) and the kinetic (shafts)."""
    lowest = np.flatnonzero(modes.natural_frequency > 0.0)[:MAX_MODES]
    names = [f"{number(modes.natural_frequency[mode], 4)} Hz" for mode in lowest]
    strain = [modes.strain_shares(modes.natural_strain_energy[mode]) for mode in lowest]
    kinetic = [modes.kinetic_shares(modes.natural_kinetic_energy[mode]) for mode in lowest]
    alike = f"At most the {MAX_MODES} lowest modes; those of one frequency are any combination of each other."
    return (
        Figure(
            key="modal_energy",
            title="Strain energy of the natural modes at rest",
            caption=f"Strain energy by mesh, bearing, coupling and drive. {alike}",
            alternative=_energy_text(names, strain, "strain"),
            content=(mode_bars(names, strain, "strain energy"),),
            table=_modes_table(modes),
        ),
        Figure(
            key="modal_motion",
            title="Kinetic energy of the natural modes at rest",
            caption=f"Kinetic energy by shaft and kind of motion. {alike}",
            alternative=_energy_text(names, kinetic, "kinetic"),
            content=(mode_bars(names, kinetic, "kinetic energy"),),
        ),
    )


def _energy_text(names: list[str], shares: list[dict[str, float]], energy: str) -> str:
    if not names:
        return "Nothing vibrates."
    part, share = next(iter(shares[0].items()))
    return f"The lowest mode, {names[0]}, has {number(100.0 * share, 2)} % of its {energy} energy in {part}."


def _modes_table(modes: ModalAnalysis, maximum: int | None = None) -> Table:
    """List the first natural modes at rest, a line each, also for modes of equal frequency."""
    strain, kinetic = modes.natural_strain_energy, modes.natural_kinetic_energy
    columns = {
        "mode": lambda mode: str(mode + 1),
        "frequency, Hz": lambda mode: number(float(modes.natural_frequency[mode]), 5),
        "damping ratio, %": lambda mode: number(100.0 * float(modes.natural_damping_ratio[mode]), 3),
        "kind": lambda mode: modes.kind(strain[mode], kinetic[mode]),
        "strain energy in": lambda mode: _shares(modes.strain_shares(strain[mode])),
        "kinetic energy in": lambda mode: _shares(modes.kinetic_shares(kinetic[mode])),
    }
    caption = "Natural modes about the static equilibrium, at rest"
    return Table.of(caption, range(modes.natural_frequency.size)[:maximum], columns)


def _shares(parts: dict[str, float]) -> str:
    listed = [f"{name} {100.0 * share:.0f} %" for name, share in parts.items() if share >= 0.005]
    return ", ".join(listed[:MAX_PARTS]) or "none"


def _critical_table(modes: ModalAnalysis) -> Table:
    """List the critical speeds; modes that an order meets together share a line."""
    groups: list[list[int]] = []
    for index, speed in enumerate(modes.critical_speed):
        mate = next((g for g in groups if _together(modes, g[0], index, float(speed))), None)
        if mate is None:
            groups.append([index])
        else:
            mate.append(index)
    columns = {
        "speed, rpm": lambda group: number(float(modes.critical_speed[group[0]]) / RPM, 5),
        "frequency, Hz": lambda group: number(modes.critical_frequency[group[0]], 5),
        "order": lambda group: str(int(modes.critical_order[group[0]])),
        "mesh": lambda group: modes.mesh[int(modes.critical_mesh[group[0]])],
        "modes": lambda group: ", ".join(str(int(modes.critical_mode[index]) + 1) for index in group),
        "kind": lambda group: "; ".join(dict.fromkeys(_critical_kind(modes, k)[0] for k in group)),
        "whirl": lambda group: ", ".join(dict.fromkeys(_critical_kind(modes, k)[1] for k in group)),
        "damping ratio, %": lambda group: number(100.0 * float(modes.critical_damping_ratio[group].min()), 3),
    }
    return Table.of("Critical speeds: where a mesh order meets a mode", groups, columns)


def _together(modes: ModalAnalysis, first: int, other: int, speed: float) -> bool:
    """Whether an order of a mesh meets two modes at speeds that share a line of the table."""
    same_line = modes.critical_order[first] == modes.critical_order[other]
    same_line = same_line and modes.critical_mesh[first] == modes.critical_mesh[other]
    return bool(same_line and abs(modes.critical_speed[first] - speed) <= ALIKE * speed)


def _critical_kind(modes: ModalAnalysis, index: int) -> tuple[str, str]:
    """Return the kind and the sense of whirl of the mode met, at the speed nearest to the crossing."""
    mode = int(modes.critical_mode[index])
    known = np.isfinite(modes.frequency[:, mode])
    row = int(np.argmin(np.where(known, np.abs(modes.speed - modes.critical_speed[index]), np.inf)))
    whirl = whirl_name(float(modes.whirl[row, mode])).replace("whirl", "").strip()
    return modes.kind(modes.strain_energy[row, mode], modes.kinetic_energy[row, mode]), whirl


def _alternative(modes: ModalAnalysis) -> str:
    if not modes.critical_speed.size:
        return "No mesh order meets a mode in this range."
    minimum = int(np.argmin(modes.critical_damping_ratio))
    damping = f"{number(100.0 * float(modes.critical_damping_ratio[minimum]), 3)} %"
    speed = f"{number(float(modes.critical_speed[minimum]) / RPM, 4)} rpm"
    place = f"{speed} and {number(modes.critical_frequency[minimum], 4)} Hz"
    order = f"mesh order {int(modes.critical_order[minimum])}"
    count = modes.critical_speed.size
    return f"{count} crossings; the least damped, with {damping}, at {place}, {order}."


def _headlines(modes: ModalAnalysis) -> tuple[Headline, ...]:
    elastic = np.flatnonzero(modes.natural_frequency > 0.0)
    if not elastic.size:
        return ()
    first = int(elastic[0])
    kind = modes.kind(modes.natural_strain_energy[first], modes.natural_kinetic_energy[first])
    frequency = f"{number(modes.natural_frequency[first], 4)} Hz"
    lowest = Headline("lowest natural frequency", frequency, kind)
    return (lowest, _least_damped(modes)) if modes.speed.size else (lowest,)


def _least_damped(modes: ModalAnalysis) -> Headline:
    count = modes.critical_speed.size
    if not count:
        return Headline("critical speeds", "none", "no mesh order meets a mode in this range")
    minimum = int(np.argmin(modes.critical_damping_ratio))
    damping = f"{number(100.0 * float(modes.critical_damping_ratio[minimum]), 3)} %"
    order = f"mesh order {int(modes.critical_order[minimum])}"
    speed = f"{number(float(modes.critical_speed[minimum]) / RPM, 4)} rpm"
    return Headline("least damped critical speed", speed, f"{order}, damping ratio {damping}, of {count}")


def _text(modes: ModalAnalysis) -> Iterator[Table | str]:
    start = modes.metadata["equilibrium"]
    forces = ", ".join(f"{name} {engineering(force, 4)} N" for name, force in start["mesh_force"].items())
    yield f"static equilibrium {start['status'].lower()}: {forces}"
    yield _modes_table(modes, PRINTED_MODES)
    more = modes.natural_frequency.size - PRINTED_MODES
    if more > 0:
        highest = number(1e-3 * float(modes.natural_frequency[-1]), 3)
        yield f"{more} more up to {highest} kHz: in the report, with --json"
    if modes.speed.size:
        yield ""
        yield _critical_table(modes)


PAGE = dynamics_presentation("Modes", _modal_figures, _headlines, _text)
