"""Torques, drives and load cases of a scene at its operating points.

A *train* is a set of rotors that stages and couplings join. Torques are about z of the scene; a torque of the
sign of the speed puts power into the scene. A stage is *cut off* if the scene does not have its mesh.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from lineofaction.gearbox.from_rexs.gear_unit import GearStage, Part, rounded
from lineofaction.gearbox.from_rexs.part_names import Names
from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_shafts import SceneShafts
from lineofaction.gearbox.units import RPM

_REACTION_TORQUE = 1e-9
"""Share of the largest torque below which a reaction is rounding."""


@dataclass(frozen=True)
class AppliedTorque:
    """A torque from outside of the scene."""

    part: Part
    """The load, or the gear of a stage that is cut off."""
    rotor: int
    """Rotor that the torque acts on."""
    z: float
    """Position at which the torque acts, along z, m."""
    torque: float
    """Torque about z, N m."""


class SceneMotion:
    """Torques on the shafts of a scene about their axes: external loads, and stages that are cut off.

    Attributes
    ----------
    torques : tuple of AppliedTorque
        All torques from outside of the scene.
    drivers : list of AppliedTorque
        The torque of each train that puts the most power into it; a train at rest has none.
    """

    def __init__(self, flow: PowerFlow, shafts: SceneShafts, cut: Sequence[GearStage]) -> None:
        self._flow, self._shafts, self._layout = flow, shafts, flow.layout
        self.torques = (*self._external(), *self._of_stages(cut))
        self.drivers = list(self._drivers())

    def _external(self) -> Iterator[AppliedTorque]:
        """Yield the external loads that pass torque on, and balancing torques at ends without a load."""
        layout, by_rotor = self._layout, self._shafts.by_rotor
        for load, torque in self._flow.loads.items():
            part = layout.unit.part(load)
            shaft = part if part.type == "shaft" else part.shaft
            if shaft is None or layout.rotor(shaft.id) not in by_rotor or shaft.id not in layout.shafts:
                text = "acts on a shaft that the scene has not; its torque enters by the ratios"
                part.say("", "refused", text)
                continue
            placed = layout.shafts[shaft.id]
            z = layout.z_on(placed, part)
            if part is not shaft:
                part.say("", "taken", f"torque on shaft {by_rotor[layout.rotor(shaft.id)].name}")
            if self._flow.point.torques.get(load) is None:
                text = f"{placed.sense * torque:.6g} N m in {self._flow.point.name}: statics of the train"
                if part is shaft:
                    text = f"the file has none at this end of the train; the scene has {text}"
                    part.say("external_load", "refused", text)
                else:
                    part.say("torque_around_u_axis", "derived", text)
            yield AppliedTorque(part, layout.rotor(shaft.id), z, torque)

    def _of_stages(self, cut: Sequence[GearStage]) -> Iterator[AppliedTorque]:
        """Yield the torques of stages without a case on shafts of the scene."""
        layout = self._layout
        meshed = {gear.id for stage in self._shafts.stages for gear in stage.gears}
        for stage in cut:
            for number, (gear, shaft) in enumerate(zip(stage.gears, stage.shafts, strict=True)):
                if layout.rotor(shaft.id) in self._shafts.by_rotor and shaft.id in layout.shafts:
                    placed = layout.shafts[shaft.id]
                    torque = self._flow.on_gear(stage, number)
                    text = f"cut off: its torque of {placed.sense * torque:.6g} N m by the ratio is a load; "
                    text += "its forces across and along the axis are left out"
                    gear.say(f"stage {stage.stage.id}" if gear.id in meshed else "", "refused", text)
                    yield AppliedTorque(gear, layout.rotor(shaft.id), layout.z_on(placed, gear), torque)

    def _drivers(self) -> Iterator[AppliedTorque]:
        speed = self._flow.speed
        for train in self._trains():
            acting = [torque for torque in self.torques if torque.rotor in train and speed(torque.rotor)]
            if acting:
                yield max(acting, key=lambda torque: torque.torque * speed(torque.rotor))

    def _trains(self) -> list[set[int]]:
        """Return the rotors of the scene by train: stages and couplings join the rotors of a train."""
        layout, stages = self._layout, self._shafts.stages
        trains = [{rotor} for rotor in self._shafts.by_rotor]
        joined = [{layout.rotor(shaft.id) for shaft in stage.shafts} for stage in stages]
        joined += [layout.joined(stage) for stage in stages if layout.carrier(stage) is not None]
        joined += [{layout.rotor(e.inner.id), layout.rotor(e.outer.id)} for e in layout.rotors.couplings]
        for ends in joined:  # merge all trains with a rotor among the ends; ends may be outside the scene
            merged = [train for train in trains if train & ends]
            trains = [train for train in trains if not train & ends]
            trains.append(set().union(*merged) if merged else set())
        return [train for train in trains if train]

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Return the tables of drives and loads.

        The driving torque of a train becomes a drive at its speed, whose torque follows from the loads. A
        shaft that is fixed to the ground becomes a drive at rest.
        """
        names = Names()
        drives, loads = [], []
        for driver in self.drivers:
            speed = self._flow.speed(driver.rotor) / RPM
            drives.append(
                self._shafts.by_rotor[driver.rotor].seat(names.of(driver.part), driver.z)
                | {"speed_rpm": [rounded(speed)]}
            )
        for rotor in sorted(self._layout.rotors.grounded & set(self._shafts.by_rotor)):
            name = names.of(self._layout.unit.part(rotor), " held")
            drives.append({"name": name, "shaft": self._shafts.by_rotor[rotor].name, "speed_rpm": [0.0]})
        largest = max((abs(torque.torque) for torque in self.torques), default=0.0)
        for torque in self.torques:
            speed = self._flow.speed(torque.rotor)
            if torque in self.drivers or speed == 0.0 or abs(torque.torque) <= _REACTION_TORQUE * largest:
                continue
            # a load of a scene is positive where it takes power out
            value = rounded(-torque.torque * math.copysign(1.0, speed))
            loads.append(
                self._shafts.by_rotor[torque.rotor].seat(names.of(torque.part), torque.z)
                | {"torque_n_m": [value]}
            )
        return {"drives": drives, "loads": loads}

    def slowest_mesh(self) -> float:
        """Return the lowest mesh frequency of the scene, Hz; 0 where nothing turns."""
        rates = [
            abs(self._flow.relative_speed(stage, 0)) * stage.teeth[0] / (2.0 * np.pi)
            for stage in self._shafts.stages
        ]
        return float(min((rate for rate in rates if rate > 0.0), default=0.0))


@dataclass(frozen=True)
class LoadCase:
    """A load case of a scene."""

    name: str
    number: int
    """Number of the load case in the spectrum of the file, counted from 1."""
    share: float
    """Share of the time, 0 to 1."""
    torque_n_m: float
    """Torque on the shaft of the scene's first drive, positive."""
    speed_rpm: float
    """Speed of that shaft, positive."""
    direction: Literal["drive", "coast"]
    """"drive" if the loaded flanks are the loaded flanks of the scene, else "coast"."""
    forces: tuple[Mapping[str, Any], ...] = ()
    """Tables of the scene's forces that have other values in this load case."""

    @classmethod
    def of(cls, flow: PowerFlow, leader: AppliedTorque, forces: tuple[Mapping[str, Any], ...]) -> LoadCase:
        """Return the load case of an operating point.

        `leader` is the torque of the scene's first drive. The direction is "coast" where this torque has the
        opposite sign at the operating point, whichever way the shafts turn. `forces` are the tables of the
        forces that have other values there.
        """
        torque = flow.loads.get(leader.part.id, leader.torque)
        return cls(
            flow.point.name,
            flow.point.number,
            rounded(flow.point.share),
            rounded(abs(torque)),
            rounded(abs(flow.speed(leader.rotor)) / RPM),
            "drive" if torque * leader.torque >= 0.0 else "coast",
            forces,
        )

    def table(self) -> dict[str, Any]:
        """Return its table in a file."""
        names = ("name", "share", "torque_n_m", "speed_rpm", "direction")
        table = {name: getattr(self, name) for name in names}
        return table | ({"forces": [dict(force) for force in self.forces]} if self.forces else {})
