"""Modal analysis of a scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bounds import engineering
from bounds.types import Json
from dynamics.assembly.assemble import System, assemble
from dynamics.linearize import ModalAnalysis, modal_analysis
from dynamics.linearize.modal_analysis import resolved_to
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.bodies import HOUSING, UNIT, Hull
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.excitations import with_scene_metadata
from lineofaction.gearbox.studies.modes import Inputs, ModesFigures
from lineofaction.gearbox.studies.motion import OfferedMotion, UnitMotion, chosen_rows
from lineofaction.gearbox.studies.scene_before_tables import scene_before_tables, sized
from lineofaction.gearbox.studies.unit_bodies import surface_motion
from lineofaction.gearbox.units import RPM

if TYPE_CHECKING:
    from dynamics.vibration import SurfaceShape

MIN_SHARE = 1e-3
_AT_REST, _LINEAR, _CUBIC = 3.5e-5, 1.2e-4, 1.9e-8
"""CPU seconds by freedoms squared, freedoms, freedoms cubed: 5 to 301 of them, within a factor of 2."""
MAX_GROUPS = 12
"""Speeds whose modes are listed to be looked at."""


def modes_cost(system: System, speeds: int) -> StudyCost:
    """Return the cost of the modes of a system at rest and at a number of speeds."""
    freedoms = system.freedoms.column.size
    at_rest, per_speed = _AT_REST * freedoms**2, _LINEAR * freedoms + _CUBIC * freedoms**3
    return StudyCost((Work("modes at rest", at_rest), Work("modes at speed", per_speed, speeds)))


class _ModesStudy(SceneStudy[Inputs, ModesFigures, ModalAnalysis]):
    inputs, answer, file = Inputs, ModesFigures, array_file(ModalAnalysis)

    def predicted(self, scene: SceneInput, inputs: Inputs, _cache: Path | None) -> StudyCost | None:
        """Return the cost of the modes at rest and at every speed, by the number of freedoms.

        Modes that a solid housing keeps are not known before and do not count.
        """
        with boundary_errors():
            if scene_before_tables(scene) is None:
                return None
            speeds = np.array(inputs.speed_rpm) * RPM
            highest = resolved_to(sized(scene), speeds, inputs.orders, inputs.highest_frequency_hz)
            system = sized(scene, highest or None)
        return modes_cost(system, len(speeds))

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> ModalAnalysis:
        with boundary_errors():
            modes = modal_analysis(
                assemble(subject.steady.scene),
                [value * RPM for value in inputs.speed_rpm],
                inputs.orders,
                progress=lambda fraction: means.report("modes", fraction),
                highest_frequency=inputs.highest_frequency_hz,
            )
        modes = replace(modes, surface_motion=surface_motion(subject, modes.freedom))
        return with_scene_metadata(modes, subject)

    def _derived(self, modes: ModalAnalysis) -> Json:
        energies = modes.natural_strain_energy, modes.natural_kinetic_energy
        at_rest = zip(modes.natural_frequency, modes.natural_damping_ratio, *energies, strict=True)
        return {
            "at_rest": [
                {"mode": mode, "frequency": hertz, "damping_ratio": ratio, **_energies(modes, *parts)}
                for mode, (hertz, ratio, *parts) in enumerate(at_rest, 1)
            ],
            "mesh_frequency": dict(zip(modes.mesh, modes.mesh_frequency, strict=True)),
            "modes": [_over_speed(modes, mode) for mode in range(modes.frequency.shape[1])],
            "critical_speeds": [_crossing(modes, index) for index in range(modes.critical_speed.size)],
        }

    def motions(self, modes: ModalAnalysis) -> list[OfferedMotion]:
        """Return the modes at rest and over speed; files of versions that did not keep the axes have none."""
        if not modes.axis_shaft.size:
            return []
        energies = modes.natural_strain_energy, modes.natural_kinetic_energy
        rest = zip(modes.natural_frequency, modes.natural_damping_ratio, *energies, strict=True)
        shapes = modes.natural_shape
        offered = [_offered_motion(modes, "at rest", row, shapes[k]) for k, row in enumerate(rest)]
        if not modes.speed.size:
            return offered
        for at in chosen_rows(modes.speed.size, MAX_GROUPS):
            group = f"at {engineering(modes.speed[at] / RPM, 5)} rpm"
            energies = modes.strain_energy[at], modes.kinetic_energy[at]
            whirl = zip(modes.frequency[at], modes.damping_ratio[at], *energies, strict=True)
            for k, row in enumerate(whirl):
                if np.isfinite(row[0]):
                    offered.append(_offered_motion(modes, group, row, modes.shape[at, k]))
        return offered


def _offered_motion(modes: ModalAnalysis, group: str, row: Any, shape: Any) -> OfferedMotion:
    """Return the motion of a mode from its frequency, damping ratio, strain and kinetic energies."""
    hertz, damping, strain, kinetic = row
    kind = modes.kind(strain, kinetic)
    name = f"{engineering(hertz, 4)} Hz, {kind}, damping {engineering(100.0 * damping)} %"

    def made() -> UnitMotion:
        motion = np.asarray(modes.axis_motion @ shape, dtype=complex)
        axes = modes.shaft, modes.axis_shaft, modes.axis_position
        return UnitMotion(*axes, motion, oscillates=True, surface=surface_shape(modes, shape))

    return OfferedMotion(group, name, made)


def surface_shape(modes: ModalAnalysis, shape: Any) -> SurfaceShape | None:
    """Return the surfaces of all housings in a mode by its freedoms, (n,); None: none of them moves."""
    from dynamics.vibration import SurfaceShape  # noqa: PLC0415 (start-up time)

    if not modes.surface_motion.size:
        return None
    hulls = [Hull.of(part) for part in modes.metadata[UNIT] if part["kind"] == HOUSING]
    first = np.cumsum([0] + [len(hull.points) for hull in hulls])
    facets = [hull.facets + start for hull, start in zip(hulls, first[:-1], strict=True)]
    motion = np.asarray(modes.surface_motion @ shape, dtype=complex)
    return SurfaceShape(np.concatenate([hull.points for hull in hulls]), np.concatenate(facets), motion)


def _energies(modes: ModalAnalysis, strain: Any, kinetic: Any) -> Json:
    return {
        "kind": modes.kind(strain, kinetic),
        "strain_energy": {name: s for name, s in modes.strain_shares(strain).items() if s >= MIN_SHARE},
        "kinetic_energy": {name: s for name, s in modes.kinetic_shares(kinetic).items() if s >= MIN_SHARE},
    }


def _over_speed(modes: ModalAnalysis, mode: int) -> Json:
    """Return a whirl mode where it oscillates, its energies at the highest of these speeds."""
    known = np.flatnonzero(np.isfinite(modes.frequency[:, mode]))
    over = {name: getattr(modes, name)[known, mode] for name in ("frequency", "damping_ratio", "whirl")}
    energies = _energies(modes, modes.strain_energy[known[-1], mode], modes.kinetic_energy[known[-1], mode])
    return {"mode": mode + 1, "speed": modes.speed[known], **over, **energies}


def _crossing(modes: ModalAnalysis, index: int) -> Json:
    """Return a critical speed, with the mode's description at the nearest of the speeds."""
    mode, speed = int(modes.critical_mode[index]), float(modes.critical_speed[index])
    known = np.isfinite(modes.frequency[:, mode])
    row = int(np.argmin(np.where(known, np.abs(modes.speed - speed), np.inf)))
    names = ("speed", "frequency", "order", "damping_ratio", "residual")
    return {
        **{name: getattr(modes, f"critical_{name}")[index] for name in names},
        "mesh": modes.mesh[int(modes.critical_mesh[index])],
        "mode": mode + 1,
        "kind": modes.kind(modes.strain_energy[row, mode], modes.kinetic_energy[row, mode]),
        "whirl": modes.whirl[row, mode],
    }


RUN = _ModesStudy()
