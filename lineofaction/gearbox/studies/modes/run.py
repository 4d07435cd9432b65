"""Modal analysis of a scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ModalAnalysis, modal_analysis
from dynamics.scene import Scene
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.studies.computation import Computation, Means
from lineofaction.gearbox.studies.equilibrium import equilibrium_figures
from lineofaction.gearbox.studies.housing_costs import reduction_figures, with_housing_costs
from lineofaction.gearbox.studies.modes import Inputs
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.units import RPM

Json = dict[str, Any]
LEAST_SHARE = 1e-3


def modes_of(scene: Scene, inputs: Inputs, means: Means) -> ModalAnalysis:
    """Return the modal analysis of a scene."""
    with boundary_errors():
        return modal_analysis(
            assemble(scene),
            [value * RPM for value in inputs.speed_rpm],
            inputs.orders,
            progress=lambda fraction: means.report("modes", fraction),
            highest_frequency=inputs.highest_frequency_hz,
        )


def facts(modes: ModalAnalysis) -> Json:
    """Return all figures; shares below 0.1 % are left out."""
    about = dict(modes.facts)
    start = about.pop("equilibrium")
    return {
        "leading_shaft": about["leading_shaft"],
        "highest_frequency_hz": about["highest_frequency"],
        "equilibrium": equilibrium_figures(start) | {"mesh_force_n": start["mesh_force"]},
        "at_rest": [_at_rest(modes, mode) for mode in range(modes.natural_frequency.size)],
        "speed_rpm": (modes.speed / RPM).tolist(),
        "mesh_frequency_hz": {
            name: modes.mesh_frequency[index].tolist() for index, name in enumerate(modes.mesh)
        },
        "modes": [_over_speed(modes, mode) for mode in range(modes.frequency.shape[1])],
        "critical_speeds": [_crossing(modes, index) for index in range(modes.critical_speed.size)],
        "cpu_seconds": about["seconds"],
        "reduction_cost": reduction_figures(about),
        "effect_ledger": about["effect_ledger"],
    }


def _at_rest(modes: ModalAnalysis, mode: int) -> Json:
    strain, kinetic = modes.natural_strain_energy[mode], modes.natural_kinetic_energy[mode]
    return {
        "mode": mode + 1,
        "frequency_hz": float(modes.natural_frequency[mode]),
        "damping_ratio": float(modes.natural_damping_ratio[mode]),
        **_energies(modes, strain, kinetic),
    }


def _energies(modes: ModalAnalysis, strain: Any, kinetic: Any) -> Json:
    """Say what holds and what moves."""
    return {
        "kind": modes.kind(strain, kinetic),
        "strain_energy": {name: s for name, s in modes.held_by(strain).items() if s >= LEAST_SHARE},
        "kinetic_energy": {name: s for name, s in modes.moved(kinetic).items() if s >= LEAST_SHARE},
    }


def _over_speed(modes: ModalAnalysis, mode: int) -> Json:
    """One whirl mode where it oscillates, its energies at the highest of these speeds."""
    there = np.flatnonzero(np.isfinite(modes.frequency[:, mode]))
    last = there[-1]
    return {
        "mode": mode + 1,
        "speed_rpm": (modes.speed[there] / RPM).tolist(),
        "frequency_hz": modes.frequency[there, mode].tolist(),
        "damping_ratio": modes.damping_ratio[there, mode].tolist(),
        "whirl": modes.whirl[there, mode].tolist(),
        **_energies(modes, modes.strain_energy[last, mode], modes.kinetic_energy[last, mode]),
    }


def _crossing(modes: ModalAnalysis, index: int) -> Json:
    """One critical speed; what the mode is, at the nearest of the speeds."""
    mode, speed = int(modes.critical_mode[index]), float(modes.critical_speed[index])
    known = np.isfinite(modes.frequency[:, mode])
    row = int(np.argmin(np.where(known, np.abs(modes.speed - speed), np.inf)))
    return {
        "speed_rpm": speed / RPM,
        "frequency_hz": float(modes.critical_frequency[index]),
        "order": int(modes.critical_order[index]),
        "mesh": modes.mesh[int(modes.critical_mesh[index])],
        "mode": mode + 1,
        "kind": modes.kind(modes.strain_energy[row, mode], modes.kinetic_energy[row, mode]),
        "whirl": float(modes.whirl[row, mode]),
        "damping_ratio": float(modes.critical_damping_ratio[index]),
        "residual_hz": float(modes.critical_residual[index]),
    }


RUN = Computation(
    with_housing_costs(modes_of),
    facts,
    array_file(ModalAnalysis),
)
