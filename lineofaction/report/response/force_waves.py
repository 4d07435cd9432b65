"""Force waves of an electric machine: pressures by order, torque and pull, mesh orders beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds import engineering
from lineofaction.gearbox.studies.force_waves.run import MachineForces, name_of
from lineofaction.gearbox.units import DEGREE, RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, Panel, Table, largest, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation, dynamics_page, model_text

KPA = 1e3
MAX_WAVES = 24
"""Largest number of waves in the plot and in tables, those of the largest radial pressure."""
NO_HOUSING = "No housing is excited by these waves yet: neither vibration nor sound is computed."


def _figure(forces: MachineForces) -> Figure:
    shown = _shown(forces)
    at = np.arange(len(shown), dtype=float)
    names = [f"{forces.temporal_order[index]:g}, {forces.spatial_order[index]:g}" for index in shown]
    axis = Axis.of_names(names, "temporal order of the machine, spatial order r")
    pressures = (("radial", forces.radial_pressure, -0.2), ("tangential", forces.tangential_pressure, 0.2))
    bars = tuple(
        Bars(name, at + shift, pressure[shown] / KPA, 0.0, 0.36, palette.category(color))
        for color, (name, pressure, shift) in enumerate(pressures)
    )
    return Figure(
        key="force_waves",
        title="Force waves on the rotor",
        caption="Amplitudes of the pressures by temporal order (periods per revolution) and spatial order r "
        f"(periods around the bore; r < 0 travels against the rotor). {NO_HOUSING}",
        alternative=" ".join(f"{head.name}: {head.value}, {head.remark}." for head in _headlines(forces)),
        content=(Panel(axis, Axis("pressure, kPa"), bars=bars),),
        table=_wave_table(forces),
    )


def _shown(forces: MachineForces) -> list[int]:
    """Return the waves with the largest radial pressure, in the sequence of the table."""
    return sorted(largest(forces.radial_pressure, MAX_WAVES))


def _wave_table(forces: MachineForces) -> Table:
    columns = {
        "wave": lambda index: name_of(forces, index),
        "frequency, Hz": lambda index: number(float(forces.frequency[index]), 5),
        "radial, kPa": lambda index: number(float(forces.radial_pressure[index]) / KPA),
        "tangential, kPa": lambda index: number(float(forces.tangential_pressure[index]) / KPA),
    }
    return Table.of("Pressures by wave", _shown(forces), columns)


def _order_table(forces: MachineForces) -> Table:
    acting = np.flatnonzero((forces.torque_amplitude != 0.0) | (forces.pull != 0.0)).tolist()
    hertz = forces.speed / (2.0 * np.pi)
    columns = {
        "temporal order": lambda row: f"{forces.order[row]:g}",
        "frequency, Hz": lambda row: number(float(forces.order[row]) * hertz, 5),
        "torque, N m": lambda row: number(float(forces.torque_amplitude[row])),
        "pull, N": lambda row: number(float(forces.pull[row])),
    }
    return Table.of("Torque (mean at order 0, ripple else) and pull on the rotor", acting, columns)


def _mesh_table(forces: MachineForces) -> Table:
    hertz = forces.speed / (2.0 * np.pi)
    columns = {
        "motor order": lambda line: str(line.temporal_order),
        "mesh": lambda line: line.mesh,
        "harmonic": lambda line: str(line.harmonic),
        "mesh order": lambda line: number(line.mesh_order, 5),
        "frequency, Hz": lambda line: number(line.mesh_order * hertz, 5),
        "off, %": lambda line: f"{100.0 * line.distance:+.2f}",
    }
    return Table.of("Mesh orders that fall together with them", forces.mesh_orders, columns)


def _headlines(forces: MachineForces) -> tuple[Headline, ...]:
    headlines = []
    if (index := forces.largest) is not None:
        kpa = number(forces.radial_pressure[index] / KPA, 3)
        at = f"{kpa} kPa radial, at {number(forces.frequency[index])} Hz"
        headlines.append(Headline("largest force order", name_of(forces, index), at))
    for name, values, unit in (("torque ripple", forces.torque_amplitude, "N m"), ("pull", forces.pull, "N")):
        of_orders = np.where(forces.order > 0, values, 0.0) if unit == "N m" else values
        row = int(np.argmax(of_orders))
        if not of_orders[row]:
            continue
        order = f"in order {forces.order[row]:g}, {forces.metadata['error']}"
        headlines.append(Headline(f"largest {name}", f"{number(of_orders[row], 3)} {unit}", order))
    return tuple(headlines)


def _page(forces: MachineForces) -> Page:
    page = dynamics_page("Force waves", (_figure(forces),), _headlines(forces), forces.metadata)
    tables = (_order_table(forces), *([_mesh_table(forces)] if forces.mesh_orders else []))
    section = Section("Orders", f"Error: {forces.metadata['error']}.", tables=tables)
    return replace(page, lead=NO_HOUSING, sections=(*page.sections, section))


def _text(forces: MachineForces) -> Iterator[Table | str]:
    """Yield the tables and lines of the terminal."""
    yield _wave_table(forces)
    if (hidden := forces.frequency.size - len(_shown(forces))) > 0:
        yield f"{hidden} waves of smaller radial pressure are in the file"
    yield _order_table(forces)
    if forces.mesh_orders:
        yield _mesh_table(forces)
    else:
        yield "no mesh order falls together with an order of the machine"
    yield f"error: {forces.metadata['error']}"
    yield NO_HOUSING
    yield from model_text(forces.metadata)


def _series(forces: MachineForces) -> Table:
    names = {
        "temporal_order": forces.temporal_order,
        "spatial_order": forces.spatial_order,
        "frequency_hz": forces.frequency,
        "radial_pressure_kpa": forces.radial_pressure / KPA,
        "radial_phase_deg": forces.radial_phase / DEGREE,
        "tangential_pressure_kpa": forces.tangential_pressure / KPA,
        "tangential_phase_deg": forces.tangential_phase / DEGREE,
    }
    rows = zip(*names.values(), strict=True)
    return Table("Force waves", tuple(names), tuple(tuple(f"{value:.9g}" for value in row) for row in rows))


def _point(forces: MachineForces) -> str:
    rpm, torque = engineering(forces.speed / RPM, 5), engineering(forces.torque, 5)
    return f"at {rpm} rpm of {forces.shaft} and {torque} N m of the machine"


PAGE = Presentation(_figure, _page, _text, series=_series, point=_point)
