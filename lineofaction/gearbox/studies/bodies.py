"""What a gear unit is drawn as: bodies of revolution about axes along z."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

UNIT = "unit"
"""Among the facts of a result: the bodies of its scene."""
SHAFT, PINION, WHEEL, BEARING = "shaft", "pinion", "wheel", "bearing"
"""What a body is: of gears, the one that drives its first mesh and the one that is driven."""


@dataclass(frozen=True)
class Ring:
    """A ring about an axis along z, m: its ends, the radius of its bore, its radii at both ends."""

    low: float
    high: float
    inner: float
    outer: float
    outer_high: float


@dataclass(frozen=True)
class Body:
    """A part of a unit: what it is, its name, where its axis crosses z = 0, m, and its rings."""

    kind: str
    name: str
    axis: tuple[float, float]
    rings: tuple[Ring, ...]

    @classmethod
    def of(cls, written: Mapping[str, Any]) -> Body:
        """Return the body that a result has among its facts."""
        x, y = written["axis"]
        return cls(written["kind"], written["name"], (x, y), tuple(Ring(**ring) for ring in written["rings"]))
