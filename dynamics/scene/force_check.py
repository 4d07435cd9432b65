"""Check of the shafts that applied forces name beside their own."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.checks import one_of
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.time_law import TimeLaw


def check_force_shafts(forces: Sequence[AppliedForce], shafts: Sequence[str]) -> None:
    """Refuse forces that turn with, or depend on, a shaft that does not exist.

    Raises
    ------
    InputError
    """
    for index, force in enumerate(forces):
        if force.turns_with is not None:
            one_of(f"forces[{index}].turns_with", force.turns_with, shafts)
        if not isinstance(force.course, TimeLaw):
            one_of(f"forces[{index}].course.shaft", force.course.shaft, shafts)
