"""The recipe of the mesh of a gear's transverse section: element sizes, real teeth, limits."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from bounds import at_most
from fe_contact.errors import InputError, integer, positive, within
from fe_contact.types import Json

if TYPE_CHECKING:
    from fe_contact.geometry import Toothing


@dataclass(frozen=True)
class MeshRecipe:
    """Element sizes of the transverse section of one gear.

    Sizes are lengths of element edges; away from the boundary they grow with distance at the rate `growth`.
    """

    flank_size: float
    """Element size along the involute and `flank_margin` below it, m."""
    tip_size: float
    """Element size at the tip edge, m. The size grows from there to `flank_size`."""
    fillet_size: float
    """Largest element size along the fillet and the root land, m."""
    body_size: float
    """Largest element size inside the ring next to the teeth, m. Deeper in the body it keeps growing."""
    flank_margin: float
    """Length below the form point that is divided as finely as the flank and carries load freedoms, m."""
    growth: float = 0.3
    """Growth of the element size per unit distance, 0.05 to 1."""
    real_teeth: int | None = None
    """Number of generated teeth, odd, centered on tooth 0; the rest of the ring is plain, of root radius.
    None, or no fewer than the gear has: all teeth.
    """

    def __post_init__(self) -> None:
        for field in ("flank_size", "tip_size", "fillet_size", "body_size", "flank_margin"):
            positive(field, getattr(self, field))
        within("growth", self.growth, 0.05, 1.0, "0.3 is usual.")
        if self.tip_size > self.flank_size:
            raise InputError("tip_size", self.tip_size, at_most(self.flank_size, name="flank_size ="))
        if self.real_teeth is not None:
            integer("real_teeth", self.real_teeth, 1, 100_001)
            if self.real_teeth % 2 == 0:
                raise InputError("real_teeth", self.real_teeth, "odd", "The teeth are centered on tooth 0.")

    @classmethod
    def standard(cls, gear: Toothing) -> MeshRecipe:
        """Return the recipe of everyday use: sizes in proportion to the normal module of `gear`."""
        m = gear.normal_module
        return cls(
            flank_size=0.05 * m,
            tip_size=0.005 * m,
            fillet_size=0.1 * m,
            body_size=0.75 * m,
            flank_margin=0.3 * m,
        )

    def refined(self, factor: float = 2.0) -> MeshRecipe:
        """Return the recipe with every element size and the growth divided by `factor` > 0.

        Teeth and margin stay, so that recipes of one family differ by their discretization only.
        """
        positive("factor", factor)
        return _refined_recipe(self, factor)

    def content(self) -> Json:
        """Return all fields as plain JSON."""
        return asdict(self)


@lru_cache(maxsize=64)
def _refined_recipe(recipe: MeshRecipe, factor: float) -> MeshRecipe:
    """Return `MeshRecipe.refined`; a plan reads the same few recipes dozens of times."""
    return replace(
        recipe,
        flank_size=recipe.flank_size / factor,
        tip_size=recipe.tip_size / factor,
        fillet_size=recipe.fillet_size / factor,
        body_size=recipe.body_size / factor,
        growth=min(1.0, max(0.05, recipe.growth / factor)),
    )
