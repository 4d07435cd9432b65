"""Excitation of a linear response by one harmonic of a mesh, each amplitude with its error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Excitation:
    """A harmonic of a mesh at its torque, or an order between harmonics: amplitudes in SI.

    An error is None where the table states none.
    """

    mesh: str
    torque: float
    """Torque on the driving gear, N m."""
    harmonic: int | None
    """Harmonic of the mesh; None: an order between harmonics."""
    order: float
    transmission_error: float
    error_of_transmission_error: float | None
    load_moment: float
    error_of_load_moment: float | None
    friction_force: float
    error_of_friction_force: float | None


def stored_excitations(metadata: Mapping[str, Any]) -> list[Excitation]:
    """Return the excitations among the facts of a result; none of forces of a run."""
    return [Excitation(**row) for row in metadata.get("excitations", ())]
