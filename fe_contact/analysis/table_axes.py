"""Axes of a table as they are requested: its loads, misalignments and changes of the center distance."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import SiNote
from fe_contact.checks import increasing, positive, within
from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

LARGEST_DEVIATION = 0.01
"""m; larger values of an axis are micrometers given as meters."""


def load_levels(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray | None,
    forces: Sequence[float] | FloatArray | None,
) -> FloatArray:
    """Return the load levels as normal forces.

    Raises
    ------
    InputError
        Both or neither given, or not increasing and above zero.
    """
    if (torques is None) == (forces is None):
        raise InputError(
            "torques", torques, "given, or normal_forces instead", "Give exactly one of the two."
        )
    name, given = ("torques", torques) if torques is not None else ("normal_forces", forces)
    levels = increasing(name, given if given is not None else ())
    positive(
        f"{name}[0]", float(levels[0]), "Loads start above zero; the no-load curve is always in the table."
    )
    return pair.normal_force(levels) if torques is not None else levels


def axis(name: str, values: Sequence[float] | FloatArray) -> FloatArray:
    """Return a table axis in m, increasing.

    Raises
    ------
    InputError
        Not increasing, not finite, or larger than 1 cm: micrometers given as meters.
    """
    levels = increasing(name, values)
    for i, value in enumerate(levels):
        within(
            f"{name}[{i}]",
            float(value),
            -LARGEST_DEVIATION,
            LARGEST_DEVIATION,
            SiNote("In m: 30 um is 3e-5."),
        )
    return levels
