"""From a scene file's loads to those of dynamics."""

from __future__ import annotations

from dynamics.forces import SpeedTorque
from dynamics.loads import AppliedForce, BySpeed, LoadTorque, Orders, SpeedCurve, TimeLaw, Unbalance
from dynamics.loads.load_course import CONSTANT, Course
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.schemas.scene_loads import ForceInput, UnbalanceInput
from lineofaction.gearbox.schemas.scene_motion import LoadTorqueInput, SpeedTorqueInput
from lineofaction.gearbox.units import DEGREE, MM, RPM


def load_torque_of(index: int, load: LoadTorqueInput) -> LoadTorque:
    """Return a torque by time."""
    with named(f"loads[{index}]"):
        law = TimeLaw(load.time_s, load.torque_n_m, load.course)
        return LoadTorque(load.name, load.shaft, law, load.position_mm * MM)


def speed_torque_of(index: int, torque: SpeedTorqueInput) -> SpeedTorque:
    """Return a torque by speed."""
    with named(f"speed_torques[{index}]"):
        speed = [value * RPM for value in torque.speed_rpm]
        if torque.kind == "table":
            curve = SpeedCurve.table(speed, torque.torque_n_m)
        elif torque.kind == "quadratic":
            curve = SpeedCurve.quadratic(torque.torque_n_m[0], speed[0])
        else:
            curve = SpeedCurve.constant(torque.torque_n_m[0], speed[0])
        return SpeedTorque(torque.name, torque.shaft, curve, torque.position_mm * MM)


def force_of(index: int, force: ForceInput) -> AppliedForce:
    """Return a force."""
    (x, y, z), (about_x, about_y, about_z) = force.force_n, force.moment_n_m
    with named(f"forces[{index}]"):
        return AppliedForce(
            name=force.name,
            shaft=force.shaft,
            force=(x, y, z),
            moment=(about_x, about_y, about_z),
            course=_course(force),
            turns_with=force.turns_with,
            **in_si(AppliedForce, force),
        )


def unbalance_of(index: int, part: UnbalanceInput) -> Unbalance:
    """Return an unbalance."""
    with named(f"unbalances[{index}]"):
        return Unbalance(name=part.name, shaft=part.shaft, **in_si(Unbalance, part))


def _course(force: ForceInput) -> Course:
    shaft, factor = force.of_shaft or force.shaft, force.factor or ()
    if force.time_s is not None:
        return TimeLaw(force.time_s, factor, force.course)
    if force.speed_rpm is not None:
        return BySpeed(SpeedCurve.table([value * RPM for value in force.speed_rpm], factor), shaft)
    if force.orders is not None:
        phases = force.phase_deg or (0.0,) * len(force.orders)
        angles = tuple(phase * DEGREE for phase in phases)
        return Orders(shaft, force.orders, force.amplitude or (), angles, force.mean)
    return CONSTANT if force.turn_factor is None else Orders.table(shaft, force.turn_factor)
