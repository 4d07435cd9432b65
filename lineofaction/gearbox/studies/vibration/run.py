"""Vibration of a scene's housing: by order over speed, and what makes it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import FloatArray, Json
from dynamics.housings import ReducedHousing, write_surface
from dynamics.types import ComplexArray
from dynamics.vibration import (
    SurfaceShape,
    VibrationAnalysis,
    analyze_vibration,
    mode_shape,
    overall,
    vibration_level,
)
from dynamics.vibration.vibration_analysis import Shares
from host import cpu_seconds
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.bearing_forces import LINEAR, forces_of
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.housing_costs import kept_costs, reduction_costs
from lineofaction.gearbox.studies.result_file import record_file
from lineofaction.gearbox.studies.vibration import Inputs, VibrationFigures
from lineofaction.gearbox.units import RPM

MM_PER_S = 1e-3
_ADVICE = "Give a housing by step_file, mesh_file or modes_file: see docs/how-to/vibration.md."


@dataclass(frozen=True)
class HousingVibrationResult:
    """The analysis, and a mode to draw in place of the operating deflection.

    Attributes
    ----------
    analysis : VibrationAnalysis
    natural_frequency : (m,) array
        Of the housing with its seats free, Hz; those kept.
    mode : int
        From 1; 0: none is drawn.
    mode_shape : SurfaceShape or None
    """

    analysis: VibrationAnalysis
    natural_frequency: FloatArray
    mode: int = 0
    mode_shape: SurfaceShape | None = None

    @property
    def shape(self) -> SurfaceShape | None:
        """Return what is drawn: the mode, or the velocity of the operating deflection; None: no surface."""
        return self.mode_shape or self.analysis.deflection


def _vibration_of(tabled: TabledScene, inputs: Inputs, means: Means) -> HousingVibrationResult:
    """Return the vibration of a housing.

    Raises
    ------
    BadInput
        The scene has no such housing, or one without surface and points.
    """
    name, housing = chosen(tabled, inputs.housing)
    with boundary_errors():
        response = forces_of(tabled.scene, inputs, means)
        began = cpu_seconds()
        found = analyze_vibration(
            response,
            housing,
            name,
            bearings=next(part.bushings for part in tabled.scene.housings if part.name == name),
            speed=None if inputs.at_rpm is None else inputs.at_rpm * RPM,
            order=inputs.at_order,
        )
        mode = None if inputs.mode is None else _mode(housing, inputs.mode)
    seconds = {**found.facts["seconds"], "vibration": cpu_seconds() - began}
    costs = {"seconds": seconds, "reduction_cost": reduction_costs(tabled)}
    found = replace(found, facts={**found.facts, **costs})
    return HousingVibrationResult(found, housing.frequency, inputs.mode or 0, mode)


def chosen(tabled: TabledScene, name: str | None) -> tuple[str, ReducedHousing]:
    """Return the housing of a name, or the first with a surface or points."""
    if name is not None and name not in tabled.housings:
        raise BadInput.of("housing", name, f"one of {', '.join(tabled.housings) or 'none'}", _ADVICE)
    for own, housing in tabled.housings.items():
        if own == name or (name is None and (housing.surface is not None or housing.points)):
            return own, housing
    raise BadInput.of("housings", len(tabled.housings), "a housing with a surface or points", _ADVICE)


def _mode(housing: ReducedHousing, number: int) -> SurfaceShape:
    if number > len(housing.frequency):
        kept = f"from 1 to {len(housing.frequency)}, the modes kept"
        raise BadInput.of("mode", number, kept, "Keep more modes of the housing.")
    return mode_shape(housing, number)


def check(scene: SceneInput, _inputs: Inputs) -> None:
    """Refuse a scene of whose housings none has a solid or a file of modes."""
    if not any(part.is_solid or part.modes_file is not None for part in scene.housings):
        value = f"{len(scene.housings)} by their matrices" if scene.housings else "none"
        raise BadInput.of("housings", value, "one with mass, a surface or points", _ADVICE)


def facts(result: HousingVibrationResult) -> Json:
    """Return velocities by order and speed, and contributions where the parts were looked at."""
    found, vibration = result.analysis, result.analysis.vibration
    return figures_of(
        VibrationFigures,
        vibration,
        found.facts,
        housing=found.housing,
        natural_frequency=result.natural_frequency,
        orders_beyond=vibration.order[~np.all(vibration.valid, axis=0)],
        points={name: _point(vibration.velocity[k]) for k, name in enumerate(vibration.point)},
        surface=None if found.deflection is None else np.sqrt(vibration.mean_square_velocity).T,
        contributions={
            "speed": vibration.speed[found.at_speed],
            "order": vibration.order[found.at_order],
            "frequency": vibration.frequency[found.at_speed, found.at_order],
            "bearings": _contributions(found.bearings, vibration.point),
            "modes": _contributions(found.modes, vibration.point),
        },
        forces=found.facts.get("forces", LINEAR),
        reduction_cost=kept_costs(found.facts),
    )


def _point(velocity: ComplexArray) -> Json:
    """Return the velocities of a point, (3, S, H), as root mean squares."""
    xyz = np.abs(velocity) / np.sqrt(2.0)
    rms = np.sqrt(np.sum(xyz**2, axis=0))
    return {
        "velocity": rms.T,
        "velocity_xyz": np.swapaxes(xyz, 1, 2),
        "overall": overall(rms),
        "level": vibration_level(rms.T),
    }


def _contributions(shares: Shares, points: tuple[str, ...]) -> list[Json]:
    """Return the contributions of bearings or modes."""
    return [
        {
            "name": name,
            "frequency": shares.frequency[p],
            "points": dict(zip(points, shares.point[:, p], strict=True)),
            "surface": shares.surface[p],
        }
        for p, name in enumerate(shares.name)
    ]


def _write_shape(result: HousingVibrationResult, _scene: Any, file: Path) -> None:
    """Write the shape that is drawn for ParaView: in phase, out of phase, and the size of both."""
    shape = result.shape
    if shape is None:
        raise BadInput.of("output", str(file), "another ending than .vtu", "The housing has no surface.")
    name = f"mode_{result.mode}" if result.mode else "velocity"
    fields = {
        f"{name}_real": shape.motion.real,
        f"{name}_imaginary": shape.motion.imag,
        f"{name}_magnitude": np.abs(shape.motion),
    }
    write_surface(file, shape.points, shape.triangles, fields)


RUN = Computation(
    _vibration_of,
    facts,
    record_file(("housing vibration", HousingVibrationResult)),
    check=check,
    writers={".vtu": _write_shape},
)
