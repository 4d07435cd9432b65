"""The recipe of the mesh of one tooth sector over the face: element sizes, layers, winding."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from bounds import at_most
from fe_contact.errors import InputError, integer, positive, within
from fe_contact.types import Json

if TYPE_CHECKING:
    from fe_contact.geometry import Toothing


HELICAL_BODY_LAYERS = 6
"""Layers that the body below a helical tooth wants at least."""

_SIZES = ("flank_size", "tip_size", "depth_size", "depth_limit", "body_size", "body_limit")

WOUND = 0.1
"""Overlap ratio below which the teeth of a helical gear are meshed as those of a spur gear."""


@dataclass(frozen=True)
class SectorRecipe:
    """Element sizes of one tooth sector: transverse section and layers.

    A size that grows is ``min(limit, size + growth x)`` at the distance x from where it starts.
    """

    flank_size: float
    """Along the involute and the part of the fillet that belongs to the tooth, m."""
    tip_size: float
    """`tip_size`, `tip_growth`: At the tip edge, m, growing to `flank_size`."""
    depth_size: float
    """`depth_size`, `depth_limit`, `depth_growth`: Below the loaded flank, across the tooth, m; the unloaded
    flank begins with 1.5 times the size.
    """
    depth_limit: float
    body_size: float
    """`body_size`, `body_limit`, `body_growth`: Below the root, towards the bore, m. Deeper than four times
    the limit elements keep a quarter of their depth.
    """
    body_limit: float
    layers: int
    """Layers of elements across the face of the tooth."""
    tip_growth: float = 0.5
    depth_growth: float = 0.6
    body_growth: float = 0.5
    land_elements: int = 3
    """Elements along half the tooth space, below the point where tooth and body part."""
    split: float = 0.5
    """Where on the fillet tooth and body part: 0 form point, 1 root. Undercut teeth part lower down."""
    layer_growth: float = 1.5
    """Thickness of a middle layer over that of an end layer, >= 1."""
    merge_rows: tuple[int, ...] = (-2,)
    """Rows of body elements (-1 the highest, decreasing) below which two layers become one. The number of
    layers must be divisible by 2 for each entry.
    """
    half_face: bool = False
    """Only the half above mid-face, a plane of symmetry: for spur gears under loads that are even across the
    face. The layers then thicken from the end to mid-face.
    """

    def __post_init__(self) -> None:
        for field in _SIZES:
            positive(field, getattr(self, field))
        for field in ("tip_growth", "depth_growth", "body_growth"):
            within(field, getattr(self, field), 0.05, 2.0, "0.5 is usual.")
        integer("land_elements", self.land_elements, 1, 100)
        integer("layers", self.layers, 1, 400)
        within("split", self.split, 0.1, 0.9, "0.5 is usual.")
        within("layer_growth", self.layer_growth, 1.0, 10.0, "1.5 is usual.")
        if self.tip_size > self.flank_size:
            raise InputError("tip_size", self.tip_size, at_most(self.flank_size, name="flank_size ="))
        rows = self.merge_rows
        if any(row > -1 for row in rows) or any(b >= a for a, b in pairwise(rows)):
            raise InputError("merge_rows", rows, "negative and strictly decreasing", "(-2,) is usual.")
        if self.half_face and rows:
            raise InputError("merge_rows", rows, "() with half_face", "Layers of half a face differ all.")
        if self.layers % self.layer_group:
            bound = f"divisible by {self.layer_group}, for {len(rows)} merge_rows"
            raise InputError("layers", self.layers, bound)

    @property
    def layer_group(self) -> int:
        """Layers of the tooth per layer of the deepest part of the body."""
        return int(2 ** len(self.merge_rows))

    @classmethod
    def draft(cls, gear: Toothing) -> SectorRecipe:
        """Return the quickest useful recipe: flank elements of 0.2 modules, 8 layers or more."""
        m = gear.normal_module
        layers = _layers(gear, minimum=8, thickest=1.5, limit=16)
        merge = () if wound(gear) and layers < 2 * HELICAL_BODY_LAYERS else (-2,)
        return cls(
            flank_size=0.2 * m,
            tip_size=0.05 * m,
            depth_size=0.2 * m,
            depth_limit=0.6 * m,
            body_size=0.2 * m,
            body_limit=2.0 * m,
            body_growth=0.6,
            layers=layers,
            merge_rows=merge,
        )

    @classmethod
    def standard(cls, gear: Toothing) -> SectorRecipe:
        """Return the recipe of everyday use: flank elements of 0.15 modules, 12 or (helical) 16 layers."""
        m = gear.normal_module
        return cls(
            flank_size=0.15 * m,
            tip_size=0.05 * m,
            depth_size=0.15 * m,
            depth_limit=0.45 * m,
            body_size=0.2 * m,
            body_limit=1.5 * m,
            layers=_layers(gear, minimum=16 if wound(gear) else 12, thickest=1.0, limit=24),
        )

    @classmethod
    def fine(cls, gear: Toothing) -> SectorRecipe:
        """Return the recipe of reference solutions: flank elements of 0.1 modules, 18 layers or more."""
        m = gear.normal_module
        return cls(
            flank_size=0.1 * m,
            tip_size=0.025 * m,
            depth_size=0.1 * m,
            depth_limit=0.3 * m,
            body_size=0.15 * m,
            body_limit=1.0 * m,
            body_growth=0.4,
            land_elements=4,
            layers=_layers(gear, minimum=18, thickest=0.7, limit=36),
            merge_rows=(-4,),
        )

    @classmethod
    def even_load(cls, gear: Toothing) -> SectorRecipe:
        """Return the recipe of a spur gear's response to even loads: flank elements of 0.4 modules, 3 layers.

        For the difference to plane strain, which is smooth: within 1.5 % of a fine mesh's up to a face of 20
        modules, 3 % at 40.
        """
        m = gear.normal_module
        return cls(
            flank_size=0.4 * m,
            tip_size=0.2 * m,
            depth_size=0.3 * m,
            depth_limit=1.0 * m,
            body_size=0.5 * m,
            body_limit=4.0 * m,
            body_growth=0.6,
            layers=3,
            layer_growth=min(max(0.8 * gear.face_width / m, 1.0), 10.0),
            merge_rows=(),
            half_face=True,
        )

    def scaled(self, factor: float) -> SectorRecipe:
        """Return the recipe with elements and layers `factor` > 0 times as large, layers in whole groups."""
        group = self.layer_group
        layers = group * max(math.ceil(self.layers / factor / group * (1.0 - 1e-9)), 1)
        return replace(self, layers=layers, **{name: factor * getattr(self, name) for name in _SIZES})

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return asdict(self) | {"merge_rows": list(self.merge_rows)}


def wound(gear: Toothing) -> bool:
    """Whether the helix turns the layers of a gear enough for the layers of helical meshes."""
    turn = gear.face_width * math.sin(abs(gear.helix_angle)) / (math.pi * gear.normal_module)
    return turn >= WOUND


def _layers(gear: Toothing, minimum: int, thickest: float, limit: int) -> int:
    """Return an even number of layers no thicker than `thickest` modules, within its bounds."""
    needed = gear.face_width / (thickest * gear.normal_module)
    return 2 * math.ceil(min(max(minimum, needed), limit) / 2)
