"""Placement of the file of a housing in its scene, as the fields of the housing state it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from dynamics.types import FloatArray
from lineofaction.gearbox.units import MM, as_typed

_IDENTITY = {"origin_mm": np.zeros(3), "x_axis": np.eye(3)[0], "z_axis": np.eye(3)[2]}
"""The fields of a file that stands as the scene does."""


@dataclass(frozen=True)
class Placement:
    """The axes x, y, z of a file as columns, and where its origin is, in the scene; m."""

    axes: FloatArray = field(default_factory=lambda: np.eye(3))
    origin: FloatArray = field(default_factory=lambda: np.zeros(3))

    @classmethod
    def of(cls, x_axis: Sequence[float], z_axis: Sequence[float], origin_mm: Sequence[float]) -> Self:
        """Return the placement of axes of any length, perpendicular to each other."""
        x, z = (np.array(axis) / np.linalg.norm(axis) for axis in (x_axis, z_axis))
        return cls(np.stack([x, np.cross(z, x), z], axis=1), MM * np.array(origin_mm))

    def points(self, of_file: Sequence[float] | FloatArray) -> FloatArray:
        """Return the positions in the scene of points (..., 3) of the file."""
        return np.asarray(np.asarray(of_file) @ self.axes.T + self.origin)

    @property
    def fields(self) -> dict[str, list[float]]:
        """The fields of a housing that differ from those of a file that stands as the scene does."""
        frame = {"origin_mm": self.origin / MM, "x_axis": self.axes[:, 0], "z_axis": self.axes[:, 2]}
        return {  # 0.0 is added because it makes 0.0 of -0.0
            name: [as_typed(float(np.round(value, 9)) + 0.0) for value in values]
            for name, values in frame.items()
            if not np.allclose(values, _IDENTITY[name], rtol=0.0, atol=1e-9)
        }
