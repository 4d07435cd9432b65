"""Damping of a housing: by mode, or by its material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bounds import described, required
from dynamics.checks import declared_fields, within
from dynamics.errors import InputError
from dynamics.solid_housing import LOSS_FACTOR
from dynamics.types import FloatArray

HIGHEST_RATIO = 1.0


class Damping(Protocol):
    """Gives the damping ratio of every mode."""

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return damping ratios of modes by the share of the housing in their strain energy."""


@dataclass(frozen=True)
class ModalDamping:
    """A damping ratio for each mode in rising order; the last one holds for all that follow."""

    ratio: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.ratio:
            raise InputError("ratio", self.ratio, "at least one number")
        for index, value in enumerate(self.ratio):
            within(f"ratio[{index}]", value, 0.0, HIGHEST_RATIO)

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return the ratios; modes without strain have none."""
        number = np.minimum(np.arange(len(elastic_share)), len(self.ratio) - 1)
        return np.where(elastic_share > 0.0, np.array(self.ratio)[number], 0.0)


@described
@dataclass(frozen=True)
class MaterialDamping:
    """Half the loss factor is the damping ratio of a mode whose strain energy is all in the housing.

    The equivalent viscous damping: at a mode's natural frequency it loses as much energy as the material.
    """

    loss_factor: float = required(LOSS_FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)

    def ratios(self, elastic_share: FloatArray) -> FloatArray:
        """Return the ratios; energy in mounts is not lost by the material."""
        return 0.5 * self.loss_factor * elastic_share


USUAL_DAMPING = MaterialDamping(0.01)
"""Cast iron with bolted joints: a guess, 0.004 to 0.02."""
