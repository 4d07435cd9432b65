"""A small STE database and a small run in closed form."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn_once import drawn_once
from own_directories import own_directories

from dynamics.results import EnergyAudit, RunResult, StepStatistics
from dynamics.types import RunStatus
from fe_contact.analysis.flanks.flank_scene import flank_scene
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.effects.influence.influence import Influence
from fe_contact.geometry import Gear, GearPair
from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.ste.fields import DIMENSIONS

__all__ = ["drawn_once", "own_directories"]

R_B, PITCH, WIDTH = 0.0375877, 0.0118085, 0.025
CASE = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
        "wheel": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
    },
    "load": {"torque_n_m": [10.0, 100.0, 400.0]},
}


def closed_form(**changes: Any) -> SteDatabase:
    """Two pairs carry between positions 0.28 and 0.72, one elsewhere."""
    position = np.arange(64) / 64
    torque = np.array([0.4, 10.0, 100.0, 400.0])
    force = torque / R_B
    double = (position > 0.28) & (position < 0.72)
    compliance = np.where(double, 1.7e-9, 2.7e-9)  # m/N
    ste = compliance[:, None] * force * (force / 2660.0) ** -0.05
    grid = (64, 4, 1, 1)
    share = np.zeros((64, 3))
    share[:, 1] = np.where(double, 0.5, position <= 0.28)
    share[:, 0] = np.where(double, 0.5, position >= 0.72)
    arrays: dict[str, Any] = {
        "position": position,
        "force": force,
        "torque": torque,
        "misalignment": np.zeros(1),
        "center_distance_change": np.zeros(1),
        "pair": np.array([-1, 0, 1]),
        "static_transmission_error": ste.reshape(grid),
        "tangent_compliance": (0.95 * ste / force).reshape(grid),
        "no_load_transmission_error": np.zeros((64, 1, 1)),
        "load_share": np.broadcast_to(share[:, None, None, None, :], (*grid, 3)),
        "face_centroid": np.zeros(grid),
        "max_pressure": np.full(grid, 7e8),
        "pairs_in_contact": np.broadcast_to(np.where(double, 2, 1)[:, None, None, None], grid),
        "status": np.zeros(grid, dtype=np.int8),
        "error_estimate": 0.002 * ste.reshape(grid),
        "residuals": np.full((*grid, 4), 1e-12),
        "geometry": PairGeometry((20, 20), (R_B, R_B), PITCH, 0.0, 0.08, math.radians(20), WIDTH, 0),
        "metadata": Metadata(
            case=CASE,
            effect_ledger=[
                {"name": name, "on": on, "reason": reason, "influence": influence.to_json()}
                for name, on, reason, influence in (
                    (
                        "corner_contact",
                        True,
                        "tips touch",
                        Influence(400.0, 0.0, 0.2e-6, -0.05e-6, 10e-6, 1e-6),
                    ),
                    ("misalignment", False, "aligned", Influence(400.0, 0.0, 0.0, 0.0, 10e-6, 1e-6)),
                )
            ],
            receipt={"stages": {"mesh": {"cpu_seconds": 1.0, "wall_seconds": 1.1}}, "cpu_seconds": 1.0},
            content_hash="0" * 64,
            software_versions={"numpy": "2.0"},
        ),
    }
    return SteDatabase(**(arrays | changes))


def with_pitch_errors(period: int = 3, **changes: Any) -> SteDatabase:
    """The table over several pitches, the teeth of each 4 um later than those of the last."""
    one = closed_form()
    late = 4e-6 * np.repeat(np.arange(period), 64)
    arrays = {
        name: np.concatenate([getattr(one, name)] * period)
        for name, dimensions in DIMENSIONS.items()
        if dimensions[0] == "position"
    }
    arrays["position"] = arrays["position"] + np.repeat(np.arange(period), 64)
    arrays["static_transmission_error"] = arrays["static_transmission_error"] + late[:, None, None, None]
    arrays["no_load_transmission_error"] = arrays["no_load_transmission_error"] + late[:, None, None]
    return replace(one, **(arrays | {"period": period} | changes))


def with_failures() -> SteDatabase:
    """The same table with one failed point."""
    whole = closed_form()
    ste, status = whole.static_transmission_error.copy(), whole.status.copy()
    ste[5, 2], status[5, 2] = np.nan, 1
    return replace(whole, static_transmission_error=ste, status=status)


def helical_pair() -> GearPair:
    """19/26 teeth, right hand."""
    pinion = Gear(
        teeth=19, normal_module=3e-3, face_width=20e-3, bore_diameter=30e-3, helix_angle=math.radians(20.0)
    )
    return GearPair(pinion, replace(pinion, teeth=26, helix_angle=-pinion.helix_angle))


def closed_form_flanks(slices: int = 5, positions: int = 16) -> LoadDistribution:
    """A load that falls linearly over the face to nothing in the last slice, on every contact line."""
    pair = helical_pair()
    position, index = np.arange(positions) / positions, np.arange(-2, 3)
    width = pair.face_width / slices
    face = (np.arange(slices) + 0.5) * width - 0.5 * pair.face_width
    nominal = pair.roll_lengths(position[:, None], index)[0][..., None]
    roll = nominal - face * math.tan(pair.base_helix_angle)
    path = pair.path_of_contact
    on_path = (roll >= path.start) & (roll <= path.end)
    profile = np.linspace(2.0, 0.0, slices) if slices > 1 else np.ones(1)
    force = on_path * profile * 1000.0 / slices
    gap = np.where(force > 0.0, 0.0, np.where(on_path, 2e-6, np.inf))
    return LoadDistribution(
        position=position,
        pair=index,
        face_position=face,
        deflection=np.full(positions, 5e-6),
        roll_length_1=roll,
        roll_length_2=pair.common_tangent - roll,
        on_path=on_path,
        force=force,
        lever=np.ones_like(force),
        pressure=4e7 * np.sqrt(force),
        gap=gap,
        slice_width=width,
        base_helix_angle=pair.base_helix_angle,
        scene=flank_scene(pair, 1000.0, misalignment=30e-6),
        metadata=Metadata(receipt={"cpu_seconds": 0.5}, content_hash="1" * 64, case={"load": 1.0}),
    )


@pytest.fixture
def flanks():
    return closed_form_flanks()


@pytest.fixture
def database():
    return closed_form()


@pytest.fixture
def damaged():
    return with_failures()


def run_up(rate: float = 5000.0, duration: float = 2.0, top_rpm: float = 900.0) -> RunResult:
    """Run up with a bearing force of 10 N at the mesh frequency and 20 N at its double, on 1000 N."""
    time = np.arange(round(rate * duration) + 1) / rate
    speed = top_rpm * math.pi / 30 * time / duration
    travel = 20 * np.cumsum(speed) / rate / (2 * math.pi)
    phase = 2 * math.pi * travel
    static = 6e-6 + 1e-6 * np.cos(phase)
    force = np.zeros((2, 3, time.size))
    force[1, 1] = -1000 + 10 * np.cos(phase) + 20 * np.sin(2 * phase)
    return RunResult(
        time=time,
        mesh=("mesh",),
        shaft=("output", "input"),
        bearing=("left", "right"),
        freedom=(),
        position=(travel % 1.0)[None],
        mesh_frequency=(20 * speed / (2 * math.pi))[None],
        dynamic_transmission_error=(static + 0.1e-6 * np.cos(7 * phase))[None],
        static_transmission_error=static[None],
        mesh_force=np.full((1, time.size), 2660.0),
        coast_force=np.empty((0, time.size)),
        least_mesh_force=np.full((1, time.size), 2660.0),
        largest_mesh_force=np.full((1, time.size), 2660.0),
        contact=np.ones((1, time.size)),
        misalignment=np.empty((0, time.size)),
        center_distance_change=np.empty((0, time.size)),
        load_arm=np.empty((0, time.size)),
        speed=np.stack([-0.5 * speed, speed]),
        drive=("drive",),
        coupling=(),
        coupling_torque=np.empty((0, time.size)),
        drive_torque=np.full((1, time.size), 100.0),
        bearing_force=force,
        bearing_moment=np.empty((0, 3, time.size)),
        displacement=np.empty((0, time.size)),
        velocity=np.empty((0, time.size)),
        nominal_force=np.array([2660.44]),
        status=RunStatus.COMPLETED,
        statistics=StepStatistics(1000, 3, 0, 2.0, 5, 1e-6, 1e-4),
        energy=EnergyAudit(100.0, -90.0, 0.0, 6.0, 3.0, 0.0, 0.0, 0.5, 0.25, 0.25),
        effect_ledger={
            "entries": [
                {"effect": "lateral", "part": "input", "on": True, "reason": "r", "influence_m": 1e-6}
            ]
        },
        receipt=_receipt(rate),
        case=_scene(rate),
    )


def _scene(rate: float) -> dict[str, Any]:
    return {
        "meshes": [{"name": "mesh", "driver": "pinion", "driven": "wheel"}],
        "shafts": [{"name": "output"}, {"name": "input"}],
        "gears": [
            {"name": "pinion", "shaft": "input", "teeth": 20},
            {"name": "wheel", "shaft": "output", "teeth": 20},
        ],
        "outputs": {"sample_rate": rate},
    }


def _receipt(rate: float) -> dict[str, Any]:
    return {
        "seconds": {"integration": 0.5},
        "error": {"time_step": {"rms": 1e-9, "source": "step control"}},
        "sampling": {
            "rate": rate,
            "chosen": "sample_rate of the scene",
            "pass_frequency": rate / 2.56,
            "stop_frequency": rate - rate / 2.56,
            "stop_band": 80.0,
            "edge": 12.0 / rate,
        },
        "peaks": {"mesh_force": {"mesh": {"peak": 2660.0, "rms": 2660.0}}},
    }


@pytest.fixture
def run():
    return run_up()


@pytest.fixture(scope="session", name="with_pitch_errors")
def _with_pitch_errors():
    return with_pitch_errors
