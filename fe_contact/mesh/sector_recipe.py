"""The recipe of the mesh of one tooth sector over the face: element sizes, layers, winding.

The sector is one tooth and the part of the body below it, from the middle of one tooth space to the next. Its
transverse section is meshed in two parts, tooth and body, which meet at a point of the fillet on either side.
The section is repeated in layers over the face; a helical gear winds them about its axis. In the body, whose
strain varies less, layers are merged in pairs.
"""

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
"""Least number of layers of the body below a helical tooth."""

_SIZES = ("flank_size", "tip_size", "depth_size", "depth_limit", "body_size", "body_limit")
"""Fields that are lengths of elements."""

WOUND = 0.1
"""Overlap ratio below which helical gears have the meshes of spur gears at their teeth."""


@dataclass(frozen=True)
class SectorRecipe:
    """Element sizes of one tooth sector: transverse section and layers.

    A size that grows is ``min(limit, size + growth x)`` at the distance x from where it starts.
    """

    flank_size: float
    """Size along the involute and the part of the fillet that belongs to the tooth, m."""
    tip_size: float
    """Size along the flank at the tip edge, m; it grows with `tip_growth` to `flank_size`."""
    depth_size: float
    """Size across the tooth below the loaded flank, m; it grows with `depth_growth` to `depth_limit`. Below
    the unloaded flank it begins with 1.5 times this size.
    """
    depth_limit: float
    body_size: float
    """Element size below the root, towards the bore, m; it grows with `body_growth` to `body_limit`. From a
    depth of four times the limit on, an element is a quarter of its depth.
    """
    body_limit: float
    layers: int
    """Layers of elements across the face of the tooth."""
    tip_growth: float = 0.5
    depth_growth: float = 0.6
    body_growth: float = 0.5
    """`tip_growth`, `depth_growth`, `body_growth`: Increase of a size per distance, 0.05..2."""
    land_elements: int = 3
    """Elements along the fillet and root of the body: from the split point to the middle of the tooth space.
    """
    split: float = 0.5
    """Position of the split point on the fillet: 0 form point, 1 root; of undercut teeth nearer the root."""
    layer_growth: float = 1.5
    """Thickness of a middle layer over that of an end layer, >= 1."""
    merge_rows: tuple[int, ...] = (-2,)
    """Rows of body elements below each of which two layers become one. Row -1 is the uppermost, -2 the next
    below, and so on; the numbers decrease. The number of layers must be divisible by 2 for every entry, in
    all by `layer_group`.
    """
    half_face: bool = False
    """Whether only the half above mid-face is meshed, with mid-face as a plane of symmetry. It is meant for
    spur gears under loads that are even across the face. The layers then thicken from the end to mid-face.
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
        if any(row > -1 for row in rows) or any(lower >= upper for upper, lower in pairwise(rows)):
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
        # Merged in pairs, few layers would leave the body of a helical gear too coarse.
        merge_rows = () if wound(gear) and layers < 2 * HELICAL_BODY_LAYERS else (-2,)
        return cls(
            flank_size=0.2 * m,
            tip_size=0.05 * m,
            depth_size=0.2 * m,
            depth_limit=0.6 * m,
            body_size=0.2 * m,
            body_limit=2.0 * m,
            body_growth=0.6,
            layers=layers,
            merge_rows=merge_rows,
        )

    @classmethod
    def standard(cls, gear: Toothing) -> SectorRecipe:
        """Return the recipe of everyday use: flank elements of 0.15 modules, 12 layers or more.

        Helical gears get 16 layers or more.
        """
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
    def medium(cls, gear: Toothing) -> SectorRecipe:
        """Return the recipe between draft and standard: flank elements of 0.17 modules, about 12 layers."""
        draft, standard = cls.draft(gear), cls.standard(gear)
        lengths: Json = {name: math.sqrt(getattr(draft, name) * getattr(standard, name)) for name in _SIZES}
        layers = 2 * math.ceil((draft.layers + standard.layers) / 4)
        growth = math.sqrt(draft.body_growth * standard.body_growth)
        return replace(standard, layers=layers, body_growth=growth, **lengths)

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
        """Return the recipe of a spur gear under even loads: flank elements of 0.4 modules, 3 layers.

        It serves the difference of the response to plane strain, which is smooth. The difference is within
        1.5 % of that of a fine mesh for faces of up to 20 modules, within 3 % at 40 modules.
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
            # Thin layers at the end of the face however wide it is; the bounds are those of the field.
            layer_growth=min(max(0.8 * gear.face_width / m, 1.0), 10.0),
            merge_rows=(),
            half_face=True,
        )

    def scaled(self, factor: float) -> SectorRecipe:
        """Return the recipe with elements `factor` > 0 times as long, and layers `factor` times as thick.

        The number of layers is rounded up to a multiple of `layer_group`.
        """
        group = self.layer_group
        # 1e-9 keeps a whole number of groups from being rounded up by an error in its last digit.
        layers = group * max(math.ceil(self.layers / factor / group * (1.0 - 1e-9)), 1)
        return replace(self, layers=layers, **{name: factor * getattr(self, name) for name in _SIZES})

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return asdict(self) | {"merge_rows": list(self.merge_rows)}


def wound(gear: Toothing) -> bool:
    """Whether the overlap ratio of a gear is large enough to mesh its teeth as those of a helical gear."""
    overlap_ratio = gear.face_width * math.sin(abs(gear.helix_angle)) / (math.pi * gear.normal_module)
    return overlap_ratio >= WOUND


def _layers(gear: Toothing, minimum: int, thickest: float, limit: int) -> int:
    """Return the even number of layers whose thickness is at most `thickest` modules.

    It is at least `minimum` and, even where that makes layers thicker, at most `limit`, an even number.
    """
    needed = gear.face_width / (thickest * gear.normal_module)
    return 2 * math.ceil(min(max(minimum, needed), limit) / 2)
