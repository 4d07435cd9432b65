"""Bodies that a gear unit is drawn as: bodies of revolution about axes along z, surfaces of housings."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds.types import FloatArray, IntArray, Json

UNIT = "unit"
"""Name among the facts of a result under which the bodies of its scene stand."""
SHAFT, PINION, WHEEL, BEARING, HOUSING = "shaft", "pinion", "wheel", "bearing", "housing"
"""Kinds of bodies. A gear that drives its first mesh is a pinion, a driven one a wheel."""


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
    """A part of a unit: its kind, its name, the point where its axis crosses z = 0, m, and its rings."""

    kind: str
    name: str
    axis: tuple[float, float]
    rings: tuple[Ring, ...]

    @classmethod
    def of(cls, written: Mapping[str, Any]) -> Body:
        """Return the body that a result has among its facts."""
        x, y = written["axis"]
        return cls(written["kind"], written["name"], (x, y), tuple(Ring(**ring) for ring in written["rings"]))


@dataclass(frozen=True, eq=False)
class Hull:
    """The surface of a housing: name, points (n, 3), m, and facets (t, 3), counter-clockwise from outside."""

    name: str
    points: FloatArray
    facets: IntArray

    @property
    def written(self) -> Json:
        """The surface as a result has it among its facts: 32-bit floats and 16-bit indices, in Base64."""
        packed = {"points": self.points.astype("<f4"), "facets": self.facets.astype("<u2")}
        texts = {name: base64.b64encode(values.tobytes()).decode() for name, values in packed.items()}
        return {"kind": HOUSING, "name": self.name} | texts

    @classmethod
    def of(cls, written: Mapping[str, Any]) -> Hull:
        """Return the surface that a result has among its facts."""
        kinds = (("points", "<f4", float), ("facets", "<u2", np.int64))
        points, facets = (
            np.frombuffer(base64.b64decode(written[name]), kind).reshape(-1, 3).astype(dtype)
            for name, kind, dtype in kinds
        )
        return cls(written["name"], points, facets)
