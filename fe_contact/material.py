"""Linear elastic, isotropic material of a gear."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described
from fe_contact.errors import declared_fields, positive

_YOUNG = Declared(Kind.STIFFNESS, "Pa", between(1e6, 2e12), "Young's modulus; steel is 210", 210e9)
_POISSON = Declared(Kind.RATIO, "", between(0.0, 0.499), "Poisson's ratio; steel is 0.3", 0.3)


@described
@dataclass(frozen=True)
class Material:
    """Isotropic elasticity.

    The density in kg/m^3 is used by dynamics only, through masses that the caller derives from it.
    """

    youngs_modulus: float = declared(210e9, _YOUNG)
    poissons_ratio: float = declared(0.3, _POISSON)
    density: float = 7850.0

    def __post_init__(self) -> None:
        declared_fields(self)
        positive("density", self.density, "Steel is 7850 kg/m^3.")

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) in Pa."""
        return self.youngs_modulus / (1.0 - self.poissons_ratio**2)


STEEL = Material()
