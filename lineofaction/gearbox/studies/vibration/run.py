"""Vibration of a scene's housing: levels by order over speed, and their causes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from bounds import engineering
from bounds.brief import brief
from bounds.types import FloatArray, Json
from dynamics.housings import ReducedHousing, write_surface
from dynamics.vibration import (
    SurfaceShape,
    VibrationAnalysis,
    analyze_vibration,
    mode_shape,
    overall,
    vibration_level,
)
from dynamics.vibration.housing_vibration import HousingVibration
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.level_quantity import velocity_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, record_file
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.studies.excitations import order_names, with_scene_metadata
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.housings import bearing_forces, predicted_forces
from lineofaction.gearbox.studies.motion import OfferedMotion, UnitMotion
from lineofaction.gearbox.studies.vibration import Inputs, VibrationFigures
from lineofaction.gearbox.studies.vibration.figures import (
    Contributions,
    PointVelocity,
    contributions_of,
    root_mean_square,
)
from lineofaction.gearbox.studies.vibration.measured import (
    MeasuredHousingVibration,
    chosen_measurement,
    measured_figures,
    measured_result,
)
from lineofaction.gearbox.units import RPM
from model_studies.result_record import ResultRecord

MM_PER_S = 1e-3
_REMEDY = "Give a housing by step_file, mesh_file, modes_file or frf_file: see docs/how-to/vibration.md."


@brief
@dataclass(frozen=True)
class HousingVibrationResult(ResultRecord):
    """The analysis, and a mode to draw in place of the operating deflection."""

    analysis: VibrationAnalysis
    natural_frequency: FloatArray
    """Natural frequencies of the modes of the reduced housing with free seats, Hz. Shape (m,)."""
    mode: int = 0
    """Number of the drawn mode from 1; 0: no mode is drawn."""
    mode_shape: SurfaceShape | None = None

    @property
    def metadata(self) -> Json:
        """Return the facts of the analysis."""
        return self.analysis.metadata

    @property
    def shape(self) -> SurfaceShape | None:
        """Return the drawn shape: the mode, or the velocity of the operating deflection; None: no surface."""
        return self.mode_shape or self.analysis.deflection


Result: TypeAlias = HousingVibrationResult | MeasuredHousingVibration


def _write_shape(result: Result, _scene: SceneInput, file: Path) -> None:
    """Write the shape that is drawn for ParaView: in phase, out of phase, and the size of both."""
    shape = None if isinstance(result, MeasuredHousingVibration) else result.shape
    if isinstance(result, MeasuredHousingVibration) or shape is None:
        raise BadInput.of("output", str(file), "another ending than .vtu", "The housing has no surface.")
    name = f"mode_{result.mode}" if result.mode else "velocity"
    fields = {
        f"{name}_real": shape.motion.real,
        f"{name}_imaginary": shape.motion.imag,
        f"{name}_magnitude": np.abs(shape.motion),
    }
    write_surface(file, shape.points, shape.triangles, fields)


class _VibrationStudy(SceneStudy[Inputs, VibrationFigures, Result]):
    inputs, answer = Inputs, VibrationFigures
    file = record_file(
        ("housing vibration", HousingVibrationResult),
        ("measured housing vibration", MeasuredHousingVibration),
    )
    writers = MappingProxyType({".vtu": _write_shape})

    def check(self, scene: SceneInput, _inputs: Inputs) -> None:
        """Refuse a scene of whose housings none has a solid, a file of modes or measured responses."""
        if not any(map(_vibrates, scene.housings)):
            value = f"{len(scene.housings)} by their matrices" if scene.housings else "none"
            raise BadInput.of("housings", value, "one with mass, a surface or points", _REMEDY)

    def predicted(self, scene: SceneInput, inputs: Inputs, _cache: Path | None) -> StudyCost | None:
        """Return the cost of the forces on bearings, with which the motion of the housing is a product."""
        vibrates = any(map(_vibrates, scene.housings))
        return predicted_forces(scene, inputs) if vibrates else None

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> Result:
        tabled = subject.steady
        measurement = chosen_measurement(tabled, inputs.housing)
        if measurement is not None:
            return measured_result(tabled, measurement, inputs, means)
        name, housing = _chosen(tabled, inputs.housing)
        with boundary_errors():
            quantity = velocity_of(tabled.scene, name, housing)
            response = bearing_forces(tabled, inputs, means, quantity)
            began = cpu_seconds()
            analysis = analyze_vibration(
                response,
                housing,
                name,
                bearings=next(part.bushings for part in tabled.scene.housings if part.name == name),
                speed=None if inputs.at_rpm is None else inputs.at_rpm * RPM,
                order=inputs.at_order,
            )
            if inputs.mode is not None and inputs.mode > len(housing.frequency):
                bound = f"from 1 to {len(housing.frequency)}, the modes kept"
                raise BadInput.of("mode", inputs.mode, bound, "Keep more modes of the housing.")
            mode = None if inputs.mode is None else mode_shape(housing, inputs.mode)
        seconds = {**analysis.metadata["seconds"], "vibration": cpu_seconds() - began}
        analysis = replace(analysis, metadata={**analysis.metadata, "seconds": seconds})
        analysis = with_scene_metadata(analysis, tabled)
        return HousingVibrationResult(analysis, housing.frequency, inputs.mode or 0, mode)

    def motions(self, result: Result) -> list[OfferedMotion]:
        """Return the surface's velocity where it was looked at, and the mode that is drawn."""
        if isinstance(result, MeasuredHousingVibration):
            return []
        analysis, offered = result.analysis, []
        if (shape := analysis.deflection) is not None:
            vibration, at = analysis.vibration, (analysis.at_speed, analysis.at_order)
            speed, order = vibration.speed[at[0]] / RPM, vibration.order[at[1]]
            hertz = engineering(vibration.frequency[at], 4)
            name = f"{hertz} Hz: order {engineering(order, 4)} at {engineering(speed, 5)} rpm"
            made = partial(UnitMotion.of_surface, shape, is_velocity=True)
            offered.append(OfferedMotion(f"velocity of {analysis.housing}", name, made))
        if (mode := result.mode_shape) is not None:
            hertz = engineering(result.natural_frequency[result.mode - 1], 4)
            made = partial(UnitMotion.of_surface, mode, is_velocity=False)
            offered.append(
                OfferedMotion(f"modes of {analysis.housing}", f"{hertz} Hz: mode {result.mode}", made)
            )
        return offered

    def figures(self, result: Result) -> Json:
        if isinstance(result, MeasuredHousingVibration):
            return measured_figures(result)
        analysis, vibration = result.analysis, result.analysis.vibration
        return figures_of(
            VibrationFigures,
            vibration,
            analysis.metadata,
            order_name=order_names(vibration.order, analysis.metadata),
            housing=analysis.housing,
            natural_frequency=result.natural_frequency,
            orders_beyond=vibration.order[~np.all(vibration.valid, axis=0)],
            points={name: _point(vibration, k) for k, name in enumerate(vibration.point)},
            surface=None if analysis.deflection is None else np.sqrt(vibration.mean_square_velocity).T,
            contributions=Contributions(
                float(vibration.speed[analysis.at_speed]),
                float(vibration.order[analysis.at_order]),
                float(vibration.frequency[analysis.at_speed, analysis.at_order]),
                bearings=contributions_of(analysis.bearings, vibration.point),
                modes=contributions_of(analysis.modes, vibration.point),
            ),
        )


def _vibrates(housing: HousingInput) -> bool:
    """Whether a housing has points or a surface to look at; matrices alone have none."""
    return housing.has_surface or housing.is_measured


def _chosen(scene: TabledScene, name: str | None) -> tuple[str, ReducedHousing]:
    """Return the housing of a name, or the first with a surface or points."""
    if name is not None and name not in scene.housings:
        known = ", ".join(part.name for part in scene.inputs.housings if _vibrates(part))
        raise BadInput.of("housing", name, f"one of {known or 'none'}", _REMEDY)
    for housing_name, housing in scene.housings.items():
        if housing_name == name or (name is None and (housing.surface is not None or housing.points)):
            return housing_name, housing
    raise BadInput.of("housings", len(scene.housings), "a housing with a surface or points", _REMEDY)


def _point(vibration: HousingVibration, point: int) -> PointVelocity:
    xyz = root_mean_square(vibration.velocity[point])
    rms = np.sqrt(np.sum(xyz**2, axis=0))
    floor = np.zeros(vibration.speed.size) if vibration.floor is None else vibration.floor[point]
    return PointVelocity(
        velocity=rms.T,
        velocity_xyz=np.swapaxes(xyz, 1, 2),
        overall=overall(rms) if vibration.floor is None else vibration.overall[point],
        left_out=np.sqrt(floor),
        overall_error=vibration.overall_error[point],
        level=vibration_level(rms.T),
    )


RUN = _VibrationStudy()
