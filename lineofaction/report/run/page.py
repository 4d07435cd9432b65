"""A run on the page: main results, figures, accuracy, cost, effects and scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from bounds import leftover
from dynamics.errors import InputError
from dynamics.orders import highest_valid_order, sidebands
from dynamics.results import RunResult
from dynamics.results.mesh_figures import (
    PlanetLoadSharing,
    contact_shares,
    dynamic_factor,
    planet_load_sharing,
)
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number, unit_of
from lineofaction.report.drawing.page import Headline, Part, Section
from lineofaction.report.drawing.placing import envelope
from lineofaction.report.drawing.tables import ledger_section, settings_table
from lineofaction.report.run.levels import (
    campbell,
    frequency_blocks,
    has_orders,
    levels_over_speed,
    mode_shares,
    order_blocks,
    order_map,
)
from lineofaction.report.run.signals import (
    TOO_SHORT,
    dynamic_error,
    has_spectrum,
    octave_bands,
    signal_over_time,
    signal_spectrum,
)
from lineofaction.report.run.sound import RunSignal, sound_of
from lineofaction.report.run.view import RunView, Signal, along_direction, run_axis, selected_signal

PITCHES = 16
"""Base pitches in one block of the figure of the dynamic factor."""
SHARE = 1e-3
"""Least amplitude of a sideband in the table, over the largest amplitude of a mesh order."""
ROWS = 12
"""Most rows of the table of sidebands."""
_ERRORS = {"time_step": "step error", "table_interpolation": "table error"}
"""Titles of the sources of error in the receipt."""


def _planet_sharing(run: RunResult) -> Figure | None:
    """Draw the load of each planet at sun and ring; None: no planets."""
    sharings = planet_load_sharing(run)
    if not sharings:
        return None
    rows = []
    for sharing in sharings:
        for mesh, mean, ratio in zip(sharing.mesh, sharing.mean, sharing.ratio, strict=True):
            shares = map(number, (mean, np.nanmin(ratio), np.nanmax(ratio)))
            rows.append((sharing.central, mesh, *shares))
    factors = "; ".join(f"{s.central} {number(s.mesh_load_factor)}" for s in sharings)
    return Figure(
        key="planet_sharing",
        title="Load sharing of the planets",
        caption="Force of each planet's mesh times the number of planets over the sum of their forces: 1 "
        "for equal loads.",
        alternative=f"Largest share in the mean (K_gamma): {factors}.",
        content=tuple(_panel(run, sharing) for sharing in sharings),
        table=Table("Load sharing", ("gear", "mesh", "of means", "least", "largest"), tuple(rows)),
    )


def _panel(run: RunResult, sharing: PlanetLoadSharing) -> Panel:
    lines = []
    for index, ratio in enumerate(sharing.ratio):
        decimated = envelope(run.time, ratio)
        lines.append(Line(f"planet {index + 1}", *decimated, palette.category(index), width=1.0))
    time = Axis.over("time, s", run.time)
    return Panel(time, Axis("load sharing ratio"), tuple(lines), title=sharing.central)


def _dynamic_factor_figure(run: RunResult) -> Figure:
    factor = dynamic_factor(run, PITCHES)
    axis, abscissa = run_axis(run, factor.time)
    lines = (
        Line("largest", abscissa, factor.largest, palette.VERMILLION),
        Line("mean", abscissa, factor.mean, palette.INK, "dash"),
        Line("least", abscissa, factor.minimum, palette.BLUE),
    )
    worst = int(np.argmax(factor.largest))
    return Figure(
        key="dynamic_factor",
        title=f"Dynamic factor of {run.mesh[0]}",
        caption=f"Force of the driving flank over the nominal one, in blocks of {PITCHES} pitches. "
        "The largest is the dynamic factor K_v; where the least is 0 the flanks lift off. The mean "
        "differs from 1 by the torque that accelerates the train.",
        alternative=f"Largest {number(factor.largest[worst], 4)} at "
        f"{number(abscissa[worst], 3)} {unit_of(axis.label)}, least "
        f"{number(factor.minimum.min(), 3)}.",
        content=(Panel(axis, Axis("mesh force over nominal, 1"), lines),),
    )


def _sideband_tables(run: RunResult, signal: Signal) -> tuple[Table, ...]:
    """Tabulate the largest sidebands of the loudest component; nothing if the run is too short for them."""
    values = max(signal.components(run).values(), key=lambda series: float(np.var(series)))
    try:
        lines = sidebands(run, values, mesh=signal.mesh)
    except InputError:  # fewer than four revolutions
        return ()
    # number 0 is the mesh order itself; sideband n lies n orders of its source above it
    minimum = SHARE * max(line.amplitude for line in lines if line.number == 0)
    bands = sorted((s for s in lines if s.number and s.amplitude > minimum), key=lambda s: -s.amplitude)
    if not bands:
        return ()
    columns = {
        "mesh order": lambda line: str(line.mesh_order),
        "sideband": lambda line: f"{line.number:+d} × {line.source}",
        "order": lambda line: number(line.order, 5),
        f"amplitude, {signal.quantity.unit} peak": lambda line: number(line.amplitude, 3),
    }
    caption = f"Sidebands of the {signal.name}, once per revolution of a gear and its multiples"
    return (Table.of(caption, bands[:ROWS], columns),)


def dynamic_headlines(run: RunResult) -> tuple[Headline, ...]:
    """Return the mean mesh force, and the balance of energy."""
    headlines = []
    if run.mesh:
        force, nominal = number(np.mean(run.mesh_force[0])), number(run.nominal_force[0])
        headlines.append(Headline("mean mesh force", f"{force} N", f"nominal {nominal} N"))
    if run.energy is not None:
        share = f"{leftover(100 * run.energy.relative, 2)} %"
        headlines.append(Headline("energy balance", share, "unaccounted for"))
    return tuple(headlines)


def dynamic_alarms(run: RunResult) -> tuple[str, ...]:
    """Return alarms: the run ended early, or its result is wrong for a stated reason."""
    wrong = [check for check in run.effect_ledger.get("checks", ()) if check.get("valid") is False]
    alarms = [f"Not valid: {check['assumption']} ({check['part']}); {check['reason']}." for check in wrong]
    if not run.status.usable:
        ended = run.status.name.lower().replace("_", " ")
        alarms.insert(0, f"The run ended early at {run.time[-1]:g} s: {ended}.")
    return tuple(alarms)


def dynamic_results(run: RunResult, view: RunView) -> tuple[Section, ...]:
    """Show the motion of one run, and the quantity that the view names.

    Raises `BadInput`: the run does not hold what the view names.
    """
    signal = selected_signal(run, view)
    projected_run = along_direction(run, signal)
    over_time = signal_over_time(run, signal)
    spectrum = (signal_spectrum(projected_run, signal),) if has_spectrum(run) else ()
    section = Section(signal.heading, "" if spectrum else TOO_SHORT, figures=(over_time, *spectrum))
    if not run.mesh:
        return (section,)
    text = "" if len(run.mesh) == 1 else f"Of {len(run.mesh)} meshes, {run.mesh[signal.mesh]} is shown."
    motion = Section("Dynamic transmission error", text, figures=(dynamic_error(run, signal.mesh),))
    return motion, section, *_orders(run, signal), *_forces(run)


def dynamic_making(run: RunResult) -> tuple[Section, ...]:
    """Show the errors of the run, its cost, and its inputs."""
    audit = {} if run.energy is None else run.energy.to_json()
    joules = {name: value for name, value in audit.items() if "relative" not in name}
    accuracy = Section(
        "Accuracy of the run",
        tables=(_accuracy(run), _sampling(run), _peaks(run)),
        folded=(settings_table("Energy audit, J", joules),),
        part=Part.ACCURACY,
    )
    text = "The scene with all defaults, in SI."
    scene = Section("Scene", text, folded=(settings_table("Scene", run.case),), part=Part.INPUT)
    steps = settings_table("Step statistics", vars(run.statistics))
    elapsed = run.receipt.get("wall_seconds", {})
    rows = []
    for name, spent in run.receipt.get("seconds", {}).items():
        rows.append((name.replace("_", " "), number(spent, 3), number(elapsed.get(name, np.nan), 3)))
    receipt = Section(
        "Receipt of the run",
        tables=(Table("Time of the run by stage", ("stage", "CPU s", "wall s"), tuple(rows)),),
        folded=(steps,),
        part=Part.RECEIPT,
    )
    return ledger_section(boundary_ledger(run.effect_ledger)), accuracy, scene, receipt


def _orders(run: RunResult, signal: Signal) -> tuple[Section, ...]:
    if not has_orders(run, signal.mesh):
        return ()
    projected_run = along_direction(run, signal)
    orders, frequencies = order_blocks(projected_run, signal), frequency_blocks(projected_run, signal)
    drawn_map = order_map(run, signal, orders)
    figures = (
        levels_over_speed(run, signal, orders),
        replace(drawn_map, sound=sound_of((RunSignal(signal.name, run, signal),), drawn_map.content[0].x)),
        campbell(run, signal, frequencies),
        mode_shares(run, signal, frequencies),
        octave_bands(run, signal, frequencies),
    )
    drawn = tuple(figure for figure in figures if figure is not None)
    return (Section("Levels and orders", figures=drawn, tables=_sideband_tables(run, signal)),)


def _forces(run: RunResult) -> tuple[Section, ...]:
    factor = _dynamic_factor_figure(run) if run.nominal_force[0] > 0.0 and has_orders(run) else None
    drawn = tuple(figure for figure in (factor, _planet_sharing(run)) if figure is not None)
    shares = contact_shares(run)
    states = tuple(shares[0])
    rows = []
    for mesh, share in zip(run.mesh, shares, strict=True):
        rows.append((mesh, *(number(100.0 * share[state], 3) for state in states)))
    flanks = {"off": "apart, %", "both": "both flanks, %"}
    head = ("mesh", *(flanks.get(state, f"{state} flank, %") for state in states))
    contact = Table("Contact state, share of the samples", head, tuple(rows))
    return (Section("Mesh forces", figures=drawn, tables=(contact,)),)


def _accuracy(run: RunResult) -> Table:
    rows = [("status", run.status.name.lower().replace("_", " "))]
    errors = run.receipt.get("error", {})
    for name, title in _ERRORS.items():
        rows += _errors(title, errors.get(name, {}))
    rows += _tolerance(errors.get("time_step", {}))
    neglected = errors.get("left_out_effects", {})
    if "decibels" in neglected:
        size = number(neglected["decibels"], 2)
        rows.append((f"neglected effects, {neglected['unit']} ({neglected['source']})", size))
    if run.energy is not None:
        turnover, work = 100 * run.energy.relative, 100 * run.energy.relative_to_throughput
        rows.append(("energy unaccounted for, % of the turnover of vibration", leftover(turnover, 2)))
        rows.append(("energy unaccounted for, % of the drive's work", leftover(work, 2)))
    return Table("Accuracy of the run", ("quantity", "value"), tuple(rows))


def _errors(title: str, error: dict[str, Any]) -> list[tuple[str, str]]:
    """Return rows on one source: its error in the transmission error, and in bearing forces at worst."""
    rows = []
    if "rms" in error:
        rows.append((f"{title}, nm rms ({error.get('source', '')})", number(1e9 * float(error["rms"]), 3)))
    if error.get("bearing_force_orders"):
        worst = max(float(value) for value in error["bearing_force_orders"])
        rows.append((f"{title}, N at the worst mesh order of a bearing force", number(worst, 2)))
    return rows


def _tolerance(steps: dict[str, Any]) -> list[tuple[str, str]]:
    """Return a row on the tolerance of the steps, and rows on errors of chaotic motion.

    In chaotic motion neighboring trajectories part, so that traces differ; levels then have errors in dB.
    """
    rows = []
    if "met" in steps:
        met = "met" if steps["met"] else "not met"
        tolerance = number(1e9 * float(steps["tolerance"]), 3)
        rows.append(("tolerance of the steps, nm rms", f"{tolerance}, {met}"))
    levels = steps.get("levels")
    if levels:
        traces = number(1e9 * float(steps["trace_rms"]), 3)
        rows.append(("chaotic motion: traces differ by, nm rms", traces))
        rows.append(("chaotic motion: error of the level, dB", number(float(levels["rms"]), 2)))
        rows.append(("chaotic motion: error of the peak force, dB", number(float(levels["peak_force"]), 2)))
    return rows


def _sampling(run: RunResult) -> Table:
    """Tabulate rate, filter, highest valid order and the sampling error of the mesh forces."""
    sampling = run.receipt["sampling"]
    rows = [
        ("rate, samples per second", number(sampling["rate"], 6)),
        ("chosen by", str(sampling["chosen"])),
        ("passed up to, Hz", number(sampling["pass_frequency"], 6)),
    ]
    if sampling["stop_band"]:
        stop = f"{number(sampling['stop_band'], 3)} dB from {number(sampling['stop_frequency'], 6)} Hz"
        edge = f"{number(1e3 * float(sampling['edge']), 3)} ms"
        rows.append(("anti-alias filter stops", stop))
        rows.append(("continued beyond start and end for the filter", edge))
    else:
        rows.append(("anti-alias filter", "none: unfiltered samples"))
    base = "mesh" if run.mesh else "shaft"
    rows.append((f"highest valid {base} order at the highest speed", str(highest_valid_order(run))))
    error = run.receipt["error"].get("sampling", {})
    for mesh, part in error.get("mesh_force", {}).items():
        rows.append((f"mesh force of {mesh} above the pass band, N rms", number(part["removed"], 3)))
        rows.append((f"mesh force of {mesh} that may have folded, N rms", number(part["folded"], 3)))
    return Table("Sampling of the output", ("quantity", "value"), tuple(rows))


def _peaks(run: RunResult) -> Table:
    """Tabulate peak and rms of the forces at all integration steps, before the anti-alias filter."""
    rows = []
    for title, parts in run.receipt.get("peaks", {}).items():
        for name, part in parts.items():
            peaks, rms = np.atleast_1d(part["peak"]), np.atleast_1d(part["rms"])
            axes = ("",) if peaks.size == 1 else (" x", " y", " z")[: peaks.size]
            for axis, *sizes in zip(axes, peaks, rms, strict=True):
                force = f"{title.replace('_', ' ')}, {name}{axis}"
                rows.append((force, *(number(size, 5) for size in sizes)))
    return Table("Peaks of the whole run, unfiltered", ("force", "peak, N", "rms, N"), tuple(rows))
