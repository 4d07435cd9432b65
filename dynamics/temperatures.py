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

    `loose` has the rings that turn loose in their seats: the play in the seat, m, by the name of the ring.
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
    """Misalignment by seats of unlike temperature, with the sign and reference of the mesh's table."""


@described
@dataclass(frozen=True)
class Temperatures:
    """Temperature of the housing, and the reference temperature at which drawings hold.

    Shafts and gears state their own temperatures. `bearings` and `meshes` are the changes of a scene by its
    temperatures; they are None in a scene whose parts are as drawn.
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
        """Return the thermal strain of a part with the coefficient of thermal expansion `expansion`, 1/K.

        A part whose temperature is None has that of the housing.
        """
        warm = self.housing if temperature is None else temperature
        return expansion * (warm - self.reference)

    def housing_strain(self, temperature: float | None = None) -> float:
        """Return the strain of the housing, also at a place with another temperature."""
        return self.strain(self.housing_material.thermal_expansion or 0.0, temperature)
