"""The forces of a scene under a load case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from dynamics.forces import AppliedForce
from dynamics.settings.case_force import CaseForce, Vector
from dynamics.types import FloatArray
from model_studies import Record, in_unit


@dataclass(frozen=True)
class ForceUnderCase(Record):
    """A force of a scene as it is under a load case, before the factor of its course.

    Attributes
    ----------
    name, shaft : str
    force, moment : (3,) arrays
        Along and about x, y, z, N and N m.
    """

    name: str
    shaft: str
    force: FloatArray = field(metadata=in_unit("n", "axis"))
    moment: FloatArray = field(metadata=in_unit("n_m", "axis"))


def as_records(forces: Sequence[AppliedForce]) -> tuple[ForceUnderCase, ...]:
    """Return the forces of a loaded scene as they are kept with its deflection."""
    return tuple(
        ForceUnderCase(part.name, part.shaft, np.array(part.force), np.array(part.moment)) for part in forces
    )


def forces_under(forces: Sequence[AppliedForce], stated: Sequence[CaseForce]) -> tuple[AppliedForce, ...]:
    """Return the forces of a scene with what a load case states of some of them."""
    by_name = {part.name: part for part in stated}
    return tuple(_stated(force, by_name[force.name]) if force.name in by_name else force for force in forces)


def _stated(force: AppliedForce, own: CaseForce) -> AppliedForce:
    factor = 1.0 if own.factor is None else own.factor
    return replace(
        force,
        force=_times(factor, force.force if own.force is None else own.force),
        moment=_times(factor, force.moment if own.moment is None else own.moment),
    )


def _times(factor: float, vector: Vector) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z
