"""Study of force waves: pressures by order at a speed and torque, resultants, mesh orders beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from bounds import from_to
from bounds.brief import brief
from bounds.types import FloatArray, IntArray, Json
from dynamics.errors import InputError
from dynamics.force_waves import AirGap, ForceWaves, Resultants, resultants
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.passing import MESH, Excitation, excitations
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.complaint import leading_shaft
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, record_file
from lineofaction.gearbox.studies.excitations import scene_metadata
from lineofaction.gearbox.studies.force_waves import ForceWavesFigures, Inputs
from lineofaction.gearbox.studies.force_waves.table_file import force_wave_table
from lineofaction.gearbox.units import MM, RPM, as_typed
from model_studies import in_unit
from model_studies.record import under_key
from model_studies.result_record import ResultRecord

NO_ERROR = "the table states no error"
"""Error of every figure: the input has none."""
OUTSIDE = "The table is not extended: compute the machine there, and add the rows."


@dataclass(frozen=True)
class MeshBeside:
    """A harmonic of a mesh that falls together with a temporal order of the machine."""

    temporal_order: int
    mesh: str
    harmonic: int
    mesh_order: float
    """Order of the harmonic per revolution of the rotor."""
    distance: float
    """Distance of the mesh order from the temporal order, relative; positive: the mesh is above."""


@brief
@dataclass(frozen=True)
class MachineForces(ResultRecord):
    """The force waves of a machine at a speed and a torque; signs and phases as in `ForceWaves`.

    W counts waves, K temporal orders.
    """

    shaft: str
    """Shaft of the rotor."""
    speed: float = field(metadata=in_unit("rad s-1"))
    """Speed of the rotor, rad/s."""
    torque: float = field(metadata=in_unit("n_m"))
    """Torque of the machine, N m."""
    temporal_order: FloatArray = field(metadata=in_unit("1", "wave"))
    """Temporal orders of the waves. Shape (W,)."""
    spatial_order: FloatArray = field(metadata=in_unit("1", "wave"))
    """Spatial orders of the waves. Shape (W,)."""
    frequency: FloatArray = field(metadata=in_unit("Hz", "wave"))
    """Frequencies of the waves, Hz. Shape (W,)."""
    radial_pressure: FloatArray = field(metadata=in_unit("pa", "wave"))
    """Amplitudes of the radial pressure, Pa. Shape (W,)."""
    radial_phase: FloatArray = field(metadata=in_unit("rad", "wave"))
    """Phases of the radial pressure, rad. Shape (W,)."""
    tangential_pressure: FloatArray = field(metadata=in_unit("pa", "wave"))
    """Amplitudes of the tangential pressure, Pa. Shape (W,)."""
    tangential_phase: FloatArray = field(metadata=in_unit("rad", "wave"))
    """Phases of the tangential pressure, rad. Shape (W,)."""
    order: FloatArray = field(metadata=in_unit("1", "order"))
    """Temporal orders, increasing. Shape (K,)."""
    torque_amplitude: FloatArray = field(metadata=in_unit("n_m", "order"))
    """Amplitude of the torque of each order, N m; at order 0 the mean with its sign. Shape (K,)."""
    pull: FloatArray = field(metadata=in_unit("n", "order"))
    """Largest unbalanced pull of each order over a period, N. Shape (K,)."""
    mesh_orders: tuple[MeshBeside, ...]
    """Harmonics of meshes that fall together with temporal orders."""
    metadata: Json = field(metadata=under_key("facts"))

    @property
    def largest(self) -> int | None:
        """Index of the wave with the largest radial pressure of those that alternate; None: none does."""
        alternating = np.flatnonzero(self.temporal_order > 0)
        if not alternating.size:
            return None
        return int(alternating[np.argmax(self.radial_pressure[alternating])])


class _ForceWavesStudy(SceneStudy[Inputs, ForceWavesFigures, MachineForces]):
    inputs, answer, file = Inputs, ForceWavesFigures, record_file(("force waves", MachineForces))

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse a text that is no table, a speed or torque outside it, and an unknown shaft."""
        waves_at(inputs)
        names = [shaft.name for shaft in scene.shafts]
        if inputs.shaft is not None and inputs.shaft not in names:
            raise BadInput.of("shaft", inputs.shaft, f"one of {', '.join(names)}")

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> MachineForces:
        began, scene = cpu_seconds(), subject.steady.scene
        waves = waves_at(inputs)
        total = resultants(waves, AirGap(inputs.bore_radius_mm * MM, inputs.active_length_mm * MM))
        shaft = inputs.shaft or leading_shaft(scene)
        with boundary_errors():
            parts = excitations(scene, solve_kinematics(scene), shaft, inputs.harmonics)
        beside = mesh_orders(total.temporal_order, parts, 0.01 * inputs.tolerance_percent)
        seconds = {"force waves": cpu_seconds() - began}
        metadata = {"error": NO_ERROR, "equilibrium": None, "effect_ledger": None, "seconds": seconds}
        means.report("force waves", 1.0)
        return _forces(shaft, waves, total, tuple(beside), scene_metadata(subject) | metadata)

    def _derived(self, forces: MachineForces) -> Json:
        largest = forces.largest
        hertz = forces.speed / (2.0 * np.pi)
        return {
            "waves": [_wave(forces, index) for index in range(forces.frequency.size)],
            "largest": "" if largest is None else name_of(forces, largest),
            "orders": [
                {"temporal_order": int(k), "frequency": k * hertz, "torque": torque, "pull": pull}
                for k, torque, pull in zip(forces.order, forces.torque_amplitude, forces.pull, strict=True)
            ],
            "mesh_orders": [
                (
                    line,
                    {
                        "mesh_frequency": line.mesh_order * hertz,
                        "distance_percent": 100.0 * line.distance,
                    },
                )
                for line in forces.mesh_orders
            ],
            "error": forces.metadata["error"],
        }


def waves_at(inputs: Inputs) -> ForceWaves:
    """Return the waves of the inputs at their speed and torque; raises `BadInput`."""
    table = force_wave_table(inputs.force_wave_table, "force_wave_table")
    try:
        return table.at(inputs.speed_rpm * RPM, inputs.torque_n_m)
    except InputError as error:
        if error.field == "speed":
            low, high = float(table.speed[0]), float(table.speed[-1])
            bound = f"{from_to(as_typed(low, RPM), as_typed(high, RPM))} rpm, the speeds of the table"
            raise BadInput.of("speed_rpm", inputs.speed_rpm, bound, OUTSIDE) from None
        bound = f"{from_to(float(table.torque[0]), float(table.torque[-1]))} N m, the torques of the table"
        raise BadInput.of("torque_n_m", inputs.torque_n_m, bound, OUTSIDE) from None


def mesh_orders(temporal: IntArray, parts: tuple[Excitation, ...], tolerance: float) -> Iterator[MeshBeside]:
    """Yield the harmonic of each mesh nearest to each temporal order, if within a relative tolerance."""
    for k in temporal[temporal > 0].tolist():
        for part in parts:
            if part.kind != MESH:
                continue
            harmonic = min(max(round(k / part.rate), 1), part.harmonics)
            distance = part.order(harmonic) / k - 1.0
            if abs(distance) <= tolerance:
                yield MeshBeside(int(k), part.name, harmonic, part.order(harmonic), distance)


def name_of(forces: MachineForces, index: int) -> str:
    """Return the name of a wave, as other orders are named by the part and a number."""
    return f"motor {forces.temporal_order[index]:g}, r = {forces.spatial_order[index]:g}"


def _forces(
    shaft: str, waves: ForceWaves, total: Resultants, beside: tuple[MeshBeside, ...], metadata: Json
) -> MachineForces:
    mean = np.where(total.temporal_order == 0, total.torque.real, np.abs(total.torque))
    return MachineForces(
        shaft=shaft,
        speed=waves.speed,
        torque=waves.torque,
        temporal_order=waves.temporal_order.astype(float),
        spatial_order=waves.spatial_order.astype(float),
        frequency=waves.frequency,
        radial_pressure=np.abs(waves.radial),
        radial_phase=np.angle(waves.radial),
        tangential_pressure=np.abs(waves.tangential),
        tangential_phase=np.angle(waves.tangential),
        order=total.temporal_order.astype(float),
        torque_amplitude=mean,
        pull=total.largest_pull,
        mesh_orders=beside,
        metadata=metadata,
    )


def _wave(forces: MachineForces, index: int) -> Json:
    names = ("frequency", "radial_pressure", "radial_phase", "tangential_pressure", "tangential_phase")
    return {
        "name": name_of(forces, index),
        "temporal_order": int(forces.temporal_order[index]),
        "spatial_order": int(forces.spatial_order[index]),
        **{name: getattr(forces, name)[index] for name in names},
    }


RUN = _ForceWavesStudy()
