"""Periodic steady states over speed: transmission error, forces and contact of sweeps and branch.

A status of 0 says that the search for a motion converged; an instability of 0 that the motion is stable.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import leftover
from dynamics.periodic import SteadyStates
from dynamics.periodic.steady_states import BRANCH, DOWN, UP
from lineofaction.gearbox.studies.steady.run import KINDS, RUN, status_name
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline
from lineofaction.report.presentation import dynamics_presentation

MIN_DISTANCE = 0.1
"""Least distance of two labelled folds, as a share of the axis."""
MARKED = 80
"""Most motions of a sweep that are drawn as points; a sweep of more is drawn as a line."""
_BEARING_HEAD = ("bearing", "state", "rms force, N")
_MESH_HEAD = (
    "mesh", "state", "largest multiplier", "rms error, µm", "peak to peak, µm", "least force, N",
    "largest force, N", "contact", "step error, nm",
)  # fmt: skip
_SWEEPS = ((UP, "rising speed", palette.BLUE), (DOWN, "falling speed", palette.ORANGE))


def _steady_figure(states: SteadyStates) -> Figure:
    """Draw the first mesh: stable motions of the branch solid, unstable ones dashed, sweeps as points."""
    swept = states.speed[states.curve != BRANCH] / RPM
    ends = (float(swept.min()), float(swept.max()))
    x = Axis(f"speed of {states.metadata['leading_shaft']}, rpm", limits=ends)
    marks = tuple(Reference(f"fold {number(speed, 5)}", speed) for speed in _folds(states, ends))
    panels = []
    for label, values in _quantities(states):
        panels.append(Panel(x, Axis(label), tuple(_lines(states, values)), marks))
    return Figure(
        key="steady",
        title="Periodic steady states over speed",
        caption="Motions at constant speed by shooting. Line: the branch, solid where stable, dashed where "
        "not. Points: steady states at slowly rising and falling speeds. Errors are less their mean.",
        alternative=_alternative(states),
        content=tuple(panels),
        table=_steady_table(states),
    )


def _quantities(states: SteadyStates) -> list[tuple[str, FloatArray]]:
    """Return the shown quantities by name, (P,) each; without meshes the bearing with the largest force."""
    if not states.mesh:
        if not states.bearing:
            return []
        loudest = int(np.argmax(np.nan_to_num(np.fmax.reduce(states.rms_bearing_force, axis=0))))
        return [(f"rms force on {states.bearing[loudest]}, N", states.rms_bearing_force[:, loudest])]
    name = f" of {states.mesh[0]}" if len(states.mesh) > 1 else ""
    quantities = [
        (f"rms of the transmission error{name}, µm", 1e6 * states.rms_error[:, 0]),
        (f"peak to peak{name}, µm", 1e6 * states.peak_to_peak_error[:, 0]),
        (f"largest mesh force{name}, N", states.largest_force[:, 0]),
    ]
    parted, coasting = states.parted[:, 0], states.coasting[:, 0]
    if np.nanmax(parted, initial=0.0) > 0.0:
        quantities.append((f"driving flank lifted off{name}, % of the period", 100.0 * parted))
    if np.nanmax(coasting, initial=0.0) > 0.0:
        quantities.append((f"coast flank touching{name}, % of the period", 100.0 * coasting))
    return quantities


def _folds(states: SteadyStates, ends: tuple[float, float]) -> list[float]:
    """Return the speeds of folds to be labelled, rpm; of neighboring folds the outermost has a label."""
    folds = states.bifurcation_speed[states.bifurcation_kind == KINDS.index("fold")] / RPM
    separate: list[float] = []
    if folds.size:
        middle = 0.5 * (folds.min() + folds.max())
        for speed in folds[np.argsort(-np.abs(folds - middle), kind="stable")]:
            if all(abs(speed - other) > MIN_DISTANCE * (ends[1] - ends[0]) for other in separate):
                separate.append(float(speed))
    return separate


def _lines(states: SteadyStates, values: FloatArray) -> Iterator[Line]:
    """Yield the branch in its stable and unstable parts, and the sweeps."""
    on = np.flatnonzero(states.curve == BRANCH)
    speed = states.speed[on] / RPM
    stable = states.instability[on] == 0
    if np.any(stable):
        solid = np.where(stable, values[on], np.nan)
        yield Line("branch, stable", speed, solid, palette.INK, width=1.3)
    if np.any(~stable):
        # the dashed line begins and ends at stable motions next to unstable ones, so that no gap is left
        boundary = np.append(~stable[1:], False) | np.append(False, ~stable[:-1])
        dashed = np.where(~stable | boundary, values[on], np.nan)
        yield Line("branch, unstable", speed, dashed, palette.INK, "dash", 1.3)
    for curve, name, color in _SWEEPS:
        rows = np.flatnonzero(states.curve == curve)
        if rows.size:
            few = rows.size <= MARKED
            width = 0.0 if few else 1.4
            yield Line(name, states.speed[rows] / RPM, values[rows], color, width=width, markers=few)


def _steady_table(states: SteadyStates) -> Table:
    """List both sweeps, one line per speed and mesh, or without meshes per speed and bearing."""
    head = ("sweep", "speed, rpm", *(_MESH_HEAD if states.mesh else _BEARING_HEAD))
    cells = _mesh_cells if states.mesh else _bearing_cells
    rows = []
    for curve, sweep in ((UP, "up"), (DOWN, "down")):
        for index in np.flatnonzero(states.curve == curve).tolist():
            speed = number(float(states.speed[index]) / RPM, 5)
            for part, name in enumerate(states.mesh or states.bearing):
                rows.append((sweep, speed, name, *cells(states, index, part)))
    return Table("Periodic steady states", head, tuple(rows))


def _bearing_cells(states: SteadyStates, index: int, bearing: int) -> tuple[str, ...]:
    state = KINDS[int(states.instability[index])] if not states.status[index] else "not found"
    return state, number(states.rms_bearing_force[index, bearing], 4)


def _mesh_cells(states: SteadyStates, index: int, mesh: int) -> tuple[str, ...]:
    """Return the cells of a motion; where none was found, the residual that the search left."""
    if states.status[index]:
        left = leftover(1e6 * float(states.residual[index]), 2)
        empty = ("none",) * (len(_MESH_HEAD) - 2)  # all columns but mesh and state
        return (f"{status_name(int(states.status[index]))}, {left} µm left", *empty)
    return (
        KINDS[int(states.instability[index])],
        number(np.abs(states.multiplier[index, 0]), 4),  # the largest is the first
        number(1e6 * float(states.rms_error[index, mesh]), 4),
        number(1e6 * float(states.peak_to_peak_error[index, mesh]), 4),
        number(states.least_force[index, mesh], 4),
        number(states.largest_force[index, mesh], 4),
        _contact_name(float(states.parted[index, mesh]), float(states.coasting[index, mesh])),
        number(1e9 * float(states.step_error[index]), 2),
    )


def _contact_name(parted: float, coasting: float) -> str:
    if coasting > 0.0:
        return f"both flanks, driving flank lifted off {100.0 * parted:.0f} %"
    return f"lift-off, {100.0 * parted:.0f} %" if parted > 0.0 else "driving flank"


def _alternative(states: SteadyStates) -> str:
    if np.all(states.status != 0):
        return "No periodic motion was found."
    if not states.mesh:
        return " ".join(f"{part.name}: {part.value}, {part.remark}." for part in _headlines(states))
    index, mesh = np.unravel_index(int(np.nanargmax(states.rms_error)), states.rms_error.shape)
    size = f"{number(1e6 * float(states.rms_error[index, mesh]), 3)} µm"
    text = f"Largest rms: {size} at {number(float(states.speed[index]) / RPM, 4)} rpm."
    for curve, (before, behind) in zip(states.jump_curve, states.jump_speed / RPM, strict=True):
        sweep = "Rising" if curve == UP else "Falling"
        text += f" {sweep} speeds jump between {number(before, 5)} and {number(behind, 5)} rpm."
    return text


def _headlines(states: SteadyStates) -> tuple[Headline, ...]:
    if np.all(states.status != 0):
        return ()
    if not states.mesh:
        force, names = states.rms_bearing_force, states.bearing
        return (_largest(states, "rms bearing force", force, "N", names),) if force.size else ()
    error = _largest(states, "rms transmission error", 1e6 * states.rms_error, "µm")
    if not states.jump_curve.size:
        return (error, _largest(states, "mesh force", states.largest_force, "N"))
    sense = "rising" if states.jump_curve[0] == UP else "falling"
    before, behind = (number(speed, 5) for speed in states.jump_speed[0] / RPM)
    first = f"the first at {sense} speed between {before} and {behind} rpm"
    return (error, Headline("jumps", str(states.jump_curve.size), first))


def _largest(
    states: SteadyStates, what: str, values: FloatArray, unit: str, names: tuple[str, ...] = ()
) -> Headline:
    """Return a headline: the largest of values (motion, part) with its part, speed and stability.

    Parts are the meshes unless `names` are given.
    """
    index, mesh = np.unravel_index(int(np.nanargmax(values)), values.shape)
    at = f"{number(float(states.speed[index]) / RPM, 4)} rpm, {KINDS[int(states.instability[index])]}"
    value = f"{number(values[index, mesh], 3)} {unit}"
    return Headline(f"largest {what} of {(names or states.mesh)[mesh]}", value, at)


def _text(states: SteadyStates) -> Iterator[Table | str]:
    yield _steady_table(states)
    answer = RUN.figures(states)
    for jump in answer["jumps"]:
        before, behind = jump["between_rpm"]
        sense = "rising" if jump["sweep"] == "up" else "falling"
        yield f"{sense} speeds jump between {before:.6g} and {behind:.6g} rpm"
    if answer["branch"]["status"] != "none":
        branch, points = answer["branch"], answer["bifurcations"]
        turns = ", ".join(f"{point['kind']} at {point['speed_rpm']:.6g} rpm" for point in points)
        yield f"branch {branch['status']}, {len(branch['points'])} motions; {turns or 'no bifurcation'}"


PAGE = dynamics_presentation("Steady states", lambda states: (_steady_figure(states),), _headlines, _text)
