"""Linear elastic, isotropic material of a gear."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Quantity, Text
from fe_contact.checks import positive, within


@dataclass(frozen=True)
class Material:
    """Isotropic elasticity.

    Attributes
    ----------
    youngs_modulus : float
        E in Pa.
    poissons_ratio : float
        nu, from 0 to 0.499.
    density : float
        rho in kg/m^3; used by dynamics only, through masses the caller derives from it.
    """

    youngs_modulus: float = 210e9
    poissons_ratio: float = 0.3
    density: float = 7850.0

    def __post_init__(self) -> None:
        positive("youngs_modulus", self.youngs_modulus, Text.of("Steel is ", Quantity(2.1e11, "Pa"), "."))
        within("poissons_ratio", self.poissons_ratio, 0.0, 0.499, "Steel is 0.3.")
        positive("density", self.density, "Steel is 7850 kg/m^3.")

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) in Pa."""
        return self.youngs_modulus / (1.0 - self.poissons_ratio**2)


STEEL = Material()
