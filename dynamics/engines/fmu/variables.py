"""The variables of the FMU: one list, from which the model description and the C header are written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.engines.mesh_element import MeshElement

REAL, INTEGER, BOOLEAN = "Real", "Integer", "Boolean"


@dataclass(frozen=True)
class Variable:
    """A variable by its name in the model description; its value reference is its index among its kind.

    Attributes
    ----------
    name, kind, causality, variability, unit, text : str
    start : float, int, bool or None
        None: an output, which follows from the others.
    """

    name: str
    kind: str
    causality: str
    variability: str
    text: str
    unit: str = ""
    start: float | None = None


def variables(element: MeshElement) -> tuple[Variable, ...]:
    """Return all variables, of each kind those that can be set first."""
    return (*_inputs(element), *_parameters(element), *_REAL_OUTPUTS, *_INTEGER_OUTPUTS)


def of_kind(chosen: Sequence[Variable], kind: str) -> list[Variable]:
    """Return those of `kind` in the order of their value references."""
    return [variable for variable in chosen if variable.kind == kind]


def _input(name: str, unit: str, text: str, start: float = 0.0) -> Variable:
    return Variable(name, REAL, "input", "continuous", text, unit, start)


def _turns(name: str, text: str) -> Variable:
    return Variable(name, INTEGER, "input", "discrete", text, "", 0)


def _tunable(name: str, unit: str, text: str, start: float) -> Variable:
    return Variable(name, REAL, "parameter", "tunable", text, unit, float(start))


def _switch(name: str, text: str, start: bool) -> Variable:
    return Variable(name, BOOLEAN, "parameter", "fixed", text, "", start)


def _output(name: str, unit: str, text: str) -> Variable:
    return Variable(name, REAL, "output", "continuous", text, unit)


def _inputs(element: MeshElement) -> list[Variable]:
    """Return the inputs; axes start at their knot nearest to zero."""
    return [
        _input("driver_angle", "rad", "Angle of the driver in the sense in which it drives"),
        _input("driven_angle", "rad", "Angle of the driven gear in the sense in which it is driven"),
        _input("driver_speed", "rad/s", "Rate of driver_angle"),
        _input("driven_speed", "rad/s", "Rate of driven_angle"),
        _input("displacement", "m", "Approach of the gears along the line of action by shafts that move"),
        _input("displacement_rate", "m/s", "Rate of displacement"),
        _input("coast_displacement", "m", "The same approach along the coast flank's line of action"),
        _input("coast_displacement_rate", "m/s", "Rate of coast_displacement"),
        _input(
            "misalignment", "m", "Position on the table's axis", _nearest_zero(element.table.misalignment)
        ),
        _input(
            "center_distance_change",
            "m",
            "Position on the table's axis",
            _nearest_zero(element.table.center_distance_change),
        ),
        _turns("driver_turns", "Whole revolutions in addition to driver_angle, exact for any number"),
        _turns("driven_turns", "Whole revolutions in addition to driven_angle"),
    ]


def _nearest_zero(knots: Sequence[float] | np.ndarray) -> float:
    array = np.atleast_1d(np.asarray(knots, dtype=float))
    return float(array[np.argmin(np.abs(array))])


def _parameters(element: MeshElement) -> list[Variable]:
    """Return what is set before a run, numbers also during it."""
    coast = element.coast
    backlash, thickness = (0.0, 0.5) if coast is None else (coast.backlash, coast.thickness)
    along = "Backlash along the transverse line of action at zero displacements"
    share = "Tooth thickness of the driver over the pitch, on the operating pitch circle"
    touching = "True: the coast flanks touch where the backlash is used up"
    from_angles = "True: r_b1 driver_angle - r_b2 driven_angle + displacement; false: displacement is the dte"
    return [
        _tunable("damping", "N.s/m", "In full contact", element.damping),
        _tunable("damping_reach", "N", "Elastic force from which the damping acts in full", element.reach),
        _tunable("position_offset", "", "Position at zero angle in base pitches", element.position_offset),
        _tunable("backlash", "m", along, backlash),
        _tunable("tooth_thickness", "", share, thickness),
        _switch("coast_flank", touching, coast is not None),
        _switch("dte_from_angles", from_angles, True),
    ]


_REAL_OUTPUTS = (
    _output("mesh_force", "N", "Transverse force of the flanks along the line of action, damping included"),
    _output("elastic_force", "N", "Part of mesh_force from the table, without damping"),
    _output("driver_torque", "N.m", "Torque on the driver in its own sense: against its motion"),
    _output("driven_torque", "N.m", "Torque on the driven gear in its own sense: along its motion"),
    _output("driver_axial_force", "N", "Force on the driver along the axis about which it turns positively"),
    _output("dte", "m", "Dynamic transmission error; positive: the driven gear lags"),
    _output("dte_rate", "m/s", "Its rate"),
    _output("position", "", "Base pitches by the driver's angle, from 0 to the period of the table"),
    _output("stiffness", "N/m", "Derivative of mesh_force in the dte"),
    _output("viscosity", "N.s/m", "Derivative of mesh_force in dte_rate"),
    _output("coast_force", "N", "Transverse force of the coast flanks along theirs, damping included"),
    _output("coast_approach", "m", "Approach of the coast flanks; positive: the backlash is used up"),
    _output("coast_stiffness", "N/m", "Derivative of coast_force in coast_approach"),
    _output("coast_viscosity", "N.s/m", "Derivative of coast_force in its rate"),
)
_INTEGER_OUTPUTS = (
    Variable("contact_state", INTEGER, "output", "discrete", "0 apart, 1 driving, 2 coast flanks, 3 both"),
    Variable(
        "validity",
        INTEGER,
        "output",
        "discrete",
        "0 inside the table; plus 1 beyond its forces, 2 its misalignments, 4 its center distances",
    ),
)
