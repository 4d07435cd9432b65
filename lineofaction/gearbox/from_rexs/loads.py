"""Torques, drives and laws of motion of a scene at an operating point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import GearStage, Names, Part
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.units import RPM

# Drives and loads of the scene: what acts from outside, and stages that are cut off.


HELD_TORQUE = 1e-9
"""Of the largest torque; less is rounding."""


@dataclass(frozen=True)
class AppliedTorque:
    """A torque from outside of the scene.

    Attributes
    ----------
    part : Part
        The load, or the gear of a stage that is cut off.
    rotor : int
        What it acts on.
    z : float
        Where along z, m.
    torque : float
        N m about z.
    """

    part: Part
    rotor: int
    z: float
    torque: float


def applied_torques(
    layout: Layout, flow: PowerFlow, shafts: SceneShafts, cut: Sequence[GearStage]
) -> tuple[AppliedTorque, ...]:
    """Return the torques on the shafts of the scene: external loads, and stages that are not computed."""
    return (*_external(layout, flow, shafts), *_of_stages(layout, flow, shafts, cut))


def _external(layout: Layout, flow: PowerFlow, shafts: SceneShafts) -> Iterator[AppliedTorque]:
    """Yield the external loads that pass torque on, and what balances them at an end without one."""
    for load, torque in flow.loads.items():
        part = layout.unit.part(load)
        shaft = part if part.type == "shaft" else part.shaft
        if shaft is None or layout.rotor(shaft.id) not in shafts.by_rotor or shaft.id not in layout.shafts:
            part.say("", "refused", "acts on a shaft that the scene has not; its torque enters by the ratios")
            continue
        placed = layout.shafts[shaft.id]
        z = layout.z_on(placed, part)
        if part is not shaft:
            part.say("", "taken", f"torque on shaft {shafts.by_rotor[layout.rotor(shaft.id)].name}")
        if flow.point.torques.get(load) is None:
            _say_open(part, f"{placed.sense * torque:.6g} N m in {flow.point.name}: statics of the train")
        yield AppliedTorque(part, layout.rotor(shaft.id), z, torque)


def _say_open(part: Part, words: str) -> None:
    """State a torque that follows from statics, at a load, or at a shaft for which the file has none."""
    if part.type == "shaft":
        words = f"the file has none at this end of the train; the scene has {words}"
        part.say("external_load", "refused", words)
    else:
        part.say("torque_around_u_axis", "derived", words)


def _of_stages(
    layout: Layout, flow: PowerFlow, shafts: SceneShafts, cut: Sequence[GearStage]
) -> Iterator[AppliedTorque]:
    """Yield what stages that are not computed do to shafts of the scene."""
    meshed = {gear.id for stage in shafts.stages for gear in stage.gears}
    for stage in cut:
        for number, (gear, shaft) in enumerate(zip(stage.gears, stage.shafts, strict=True)):
            if layout.rotor(shaft.id) in shafts.by_rotor and shaft.id in layout.shafts:
                placed = layout.shafts[shaft.id]
                torque = flow.on_gear(stage, number)
                words = f"cut off: its torque of {placed.sense * torque:.6g} N m by the ratio is a load; "
                words += "its forces across and along the axis are left out"
                gear.say(f"stage {stage.stage.id}" if gear.id in meshed else "", "refused", words)
                yield AppliedTorque(gear, layout.rotor(shaft.id), layout.z_on(placed, gear), torque)


def driving(
    torques: Sequence[AppliedTorque], flow: PowerFlow, trains: Sequence[set[int]]
) -> list[AppliedTorque]:
    """Return the torque that drives each train: that of the most power into it; none acts on one without."""
    driving = []
    for train in trains:
        acting = [torque for torque in torques if torque.rotor in train and flow.speed(torque.rotor) != 0.0]
        if acting:
            driving.append(max(acting, key=lambda torque: torque.torque * flow.speed(torque.rotor)))
    return driving


def motion_tables(
    layout: Layout,
    flow: PowerFlow,
    shafts: SceneShafts,
    torques: Sequence[AppliedTorque],
    drivers: Sequence[AppliedTorque],
) -> dict[str, list[dict[str, Any]]]:
    """Return the tables of drives and loads.

    The torque that drives becomes a drive at its speed: what it carries follows from the loads. Shafts that
    the ground holds are driven at rest.
    """
    names = Names()
    drives, loads = [], []
    for driver in drivers:
        shaft = shafts.by_rotor[driver.rotor]
        speed = flow.speed(driver.rotor) / RPM
        place = {
            "name": names.of(driver.part),
            "shaft": shaft.name,
            "position_mm": shaft.position_mm(driver.z),
        }
        drives.append(place | {"speed_rpm": [_rounded(speed)]})
    for rotor in sorted(layout.rotors.held & set(shafts.by_rotor)):
        name = names.of(layout.unit.part(rotor), " held")
        drives.append({"name": name, "shaft": shafts.by_rotor[rotor].name, "speed_rpm": [0.0]})
    most = max((abs(torque.torque) for torque in torques), default=0.0)
    for torque in torques:
        speed = flow.speed(torque.rotor)
        if torque in drivers or speed == 0.0 or abs(torque.torque) <= HELD_TORQUE * most:
            continue
        shaft = shafts.by_rotor[torque.rotor]
        table = {
            "name": names.of(torque.part),
            "shaft": shaft.name,
            "position_mm": shaft.position_mm(torque.z),
        }
        loads.append(table | {"torque_n_m": [_rounded(-torque.torque * math.copysign(1.0, speed))]})
    return {"drives": drives, "loads": loads}


def _rounded(value: float) -> float:
    """Return a value without the rounding of the statics: twelve digits."""
    return float(f"{value:.12g}")


def trains_of(layout: Layout, shafts: SceneShafts) -> list[set[int]]:
    """Return the rotors of the scene by what stages and couplings join."""
    trains = [{rotor} for rotor in shafts.by_rotor]
    joined = [{layout.rotor(shaft.id) for shaft in stage.shafts} for stage in shafts.stages]
    joined += [
        {carrier} | {layout.rotor(shaft.id) for shaft in stage.shafts}
        for stage in shafts.stages
        if (carrier := layout.carrier(stage)) is not None
    ]
    joined += [{layout.rotor(e.inner.id), layout.rotor(e.outer.id)} for e in layout.rotors.couplings]
    for ends in joined:
        touched = [train for train in trains if train & ends]
        trains = [train for train in trains if not train & ends]
        trains.append(set().union(*touched) if touched else set())
    return [train for train in trains if train]


def slowest_mesh(layout: Layout, flow: PowerFlow, shafts: SceneShafts) -> float:
    """Return the lowest mesh frequency of the scene, Hz; 0 where nothing turns."""
    rates = []
    for stage in shafts.stages:
        carrier = layout.carrier(stage)
        frame = 0.0 if carrier is None else flow.speed(carrier)
        speed = flow.speed(layout.rotor(stage.shafts[0].id)) - frame
        rates.append(abs(speed) * stage.teeth[0] / (2.0 * np.pi))
    turning = [rate for rate in rates if rate > 0.0]
    return float(min(turning, default=0.0))


# Load cases of a scene: torque and speed of its driving shaft, its forces, and the share of the time.


DIGITS = 12


@dataclass(frozen=True)
class LoadCase:
    """A load case of a scene.

    Attributes
    ----------
    name : str
        Its name.
    number : int
        Its place in the spectrum of the file, from 1.
    share : float
        Of the time, 0 to 1.
    torque_n_m : float
        Torque on the shaft of the scene's first drive, positive.
    speed_rpm : float
        Speed of that shaft, positive.
    direction : "drive" or "coast"
        Whether the flanks that carry are those of the scene.
    forces : tuple of mapping
        Tables of the scene's forces that differ under it.
    """

    name: str
    number: int
    share: float
    torque_n_m: float
    speed_rpm: float
    direction: Literal["drive", "coast"]
    forces: tuple[Mapping[str, Any], ...] = ()

    def table(self) -> dict[str, Any]:
        """Return its table in a file."""
        table = {
            "name": self.name,
            "share": self.share,
            "torque_n_m": self.torque_n_m,
            "speed_rpm": self.speed_rpm,
            "direction": self.direction,
        }
        return table | ({"forces": [dict(force) for force in self.forces]} if self.forces else {})


def load_case(
    flow: PowerFlow,
    leader: AppliedTorque,
    torque: float,
    scene_torque: float,
    forces: tuple[Mapping[str, Any], ...],
) -> LoadCase:
    """Return the load case of an operating point.

    Parameters
    ----------
    flow : PowerFlow
        At the operating point.
    leader : AppliedTorque
        What drives the scene.
    torque, scene_torque : float
        Torque on the leader at the operating point and in the scene, N m about z: of opposite signs, the
        other flanks carry, in whichever sense the shafts turn.
    forces : tuple of mapping
        Tables of the forces that are not those of the scene at the operating point.
    """
    speed = flow.speed(leader.rotor)
    same = torque * scene_torque >= 0.0
    return LoadCase(
        flow.point.name,
        flow.point.number,
        float(f"{flow.point.share:.{DIGITS}g}"),
        float(f"{abs(torque):.{DIGITS}g}"),
        float(f"{abs(speed) / RPM:.{DIGITS}g}"),
        "drive" if same else "coast",
        forces,
    )
