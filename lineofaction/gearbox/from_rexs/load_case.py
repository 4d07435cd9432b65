"""Load cases of a scene: torque and speed of its driving shaft, its forces, and the share of the time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from lineofaction.gearbox.from_rexs.power_flow import PowerFlow
from lineofaction.gearbox.from_rexs.scene_loads import AppliedTorque
from lineofaction.gearbox.units import RPM

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
