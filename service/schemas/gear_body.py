"""Body of a gear in the case file: its material, rim and web, the seat of its bore, and its shaft."""

from __future__ import annotations

from pydantic import Field

from fe_contact.body.bore_seat import BoreSeat, Key
from fe_contact.body.gear_blank import GearBlank
from fe_contact.body.shaft import Shaft
from fe_contact.material import Material
from service.schemas.declared import declared_in, with_fields
from service.schemas.model import BoundaryModel


@with_fields(declared_in(Material))
class MaterialInput(BoundaryModel):
    """Linear elastic, isotropic material."""


@with_fields(declared_in(Shaft))
class GearShaftInput(BoundaryModel):
    """A round shaft on two bearings that carries a gear."""


@with_fields(declared_in(GearBlank))
class GearBlankInput(BoundaryModel):
    """Rim, web and hub of a gear; rim and hub are as wide as the face."""


@with_fields(declared_in(Key))
class KeyInput(BoundaryModel):
    """One parallel key: the bore slides around the shaft but for its width."""


@with_fields(declared_in(BoreSeat))
class BoreSeatInput(BoundaryModel):
    """The seat of the bore on its shaft; stiffnesses are traction per displacement."""

    key: KeyInput | None = Field(
        default=None,
        description="A key; the tangential foundation is then its own",
        examples=[{"width_mm": 12.0, "angle_deg": 0.0}],
    )
