"""Load cases of a scene from the inputs of a caller."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import inside
from dynamics.settings.load_case import CaseForce, LoadCase, check_forces
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.deflect import LoadCaseInput


def check_cases(scene: SceneInput, inputs: Sequence[LoadCaseInput]) -> tuple[LoadCase, ...]:
    """Return load cases; raises `BadInput`: they are impossible, or need parts that the scene lacks."""
    with named(""):
        cases = load_cases(inputs)
        check_forces(cases, [force.name for force in scene.forces])
    for index, case in enumerate(cases):
        if case.torque is not None and not scene.loads:
            raise BadInput.of(
                f"load_cases[{index}].torque_n_m",
                case.torque,
                "left out: the scene has no loads",
                "A load case scales them. Add [[loads]] where the torque leaves the gearbox.",
            )
    return cases


def load_cases(inputs: Sequence[LoadCaseInput]) -> tuple[LoadCase, ...]:
    """Return load cases in SI."""
    cases = []
    for index, case in enumerate(inputs):
        with inside(f"load_cases[{index}]"):
            forces = []
            for number, force in enumerate(case.forces):
                with inside(f"forces[{number}]"):
                    forces.append(CaseForce(**in_si(CaseForce, force)))
            cases.append(LoadCase(**in_si(LoadCase, case), forces=tuple(forces)))
    return tuple(cases)
