"""Steady temperatures of a scene: the housing's, at which drawings hold, and those of the other parts."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bounds import declared, described, required
from dynamics.bearings import RollingBearing
from dynamics.checks import declared_fields
from dynamics.errors import InputError
from dynamics.shafts.bodies import TEMPERATURE
from dynamics.solid_housing import Material

_HOUSING = replace(TEMPERATURE, description="Steady temperature of the housing", example=70.0)
_REFERENCE = replace(TEMPERATURE, description="Temperature at which drawings hold", example=20.0)


@dataclass(frozen=True)
class WarmBearing:
    """A rolling bearing as drawn and as steady temperatures leave it.

    `loose`: play of a ring in its seat by the ring's name, m: of rings that their fits no longer hold.
    """

    drawn: RollingBearing
    warm: RollingBearing
    loose: dict[str, float]


@dataclass(frozen=True)
class WarmMesh:
    """Changes of a mesh by steady temperatures, m."""

    distance_change: float
    """Growth of the center distance less the growth of the gears' pitch radii."""
    backlash: float
    """Change of the backlash along the transverse line of action."""
    misalignment: float
    """Misalignment by seats of unlike temperature, as the table counts it."""


@described
@dataclass(frozen=True)
class Temperatures:
    """The temperature of the housing, and where drawings hold; the other parts have their own.

    `bearings` and `meshes` are what they changed in the scene that has them; None: parts are as drawn.
    """

    housing_material: Material
    housing: float = required(_HOUSING)
    reference: float = declared(20.0, _REFERENCE)
    bearings: dict[str, WarmBearing] | None = None
    meshes: tuple[WarmMesh, ...] | None = None

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.housing_material.thermal_expansion is None:
            remedy = "Give it, or a material by its name."
            raise InputError("housing_material.thermal_expansion", None, "given", remedy)

    def strain(self, expansion: float, temperature: float | None) -> float:
        """Return the thermal strain of a part of this expansion (1/K); None: as the housing is warm."""
        warm = self.housing if temperature is None else temperature
        return expansion * (warm - self.reference)

    def housing_strain(self, temperature: float | None = None) -> float:
        """Return the strain of the housing, also at a place with another temperature."""
        return self.strain(self.housing_material.thermal_expansion or 0.0, temperature)
