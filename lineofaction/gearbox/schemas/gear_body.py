"""What the bodies of gears in the case file are of, and the shafts that carry them."""

from __future__ import annotations

from fe_contact.body import Shaft
from fe_contact.material import Material
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel


@with_fields(declared_in(Material))
class MaterialInput(BoundaryModel):
    """Linear elastic, isotropic material."""


@with_fields(declared_in(Shaft))
class GearShaftInput(BoundaryModel):
    """A round shaft on two bearings that carries a gear."""
