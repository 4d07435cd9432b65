"""The forces of a scene under a load case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from dynamics.forces import AppliedForce
from dynamics.settings.case_force import CaseForce, Vector


def forces_under(forces: Sequence[AppliedForce], stated: Sequence[CaseForce]) -> tuple[AppliedForce, ...]:
    """Return the forces of a scene with what a load case states of some of them."""
    by_name = {part.name: part for part in stated}
    return tuple(_stated(force, by_name[force.name]) if force.name in by_name else force for force in forces)


def _stated(force: AppliedForce, own: CaseForce) -> AppliedForce:
    """Return a force as a load case states it."""
    factor = 1.0 if own.factor is None else own.factor
    return replace(
        force,
        force=_times(factor, force.force if own.force is None else own.force),
        moment=_times(factor, force.moment if own.moment is None else own.moment),
    )


def _times(factor: float, vector: Vector) -> Vector:
    """Return a vector times a factor."""
    x, y, z = vector
    return factor * x, factor * y, factor * z
