"""Linear elastic, isotropic material of a housing."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, described, required, up_to
from dynamics.checks import declared_fields

_YOUNG = Declared(Kind.STIFFNESS, "Pa", between(1e6, 2e12), "Young's modulus", 110e9)
_POISSON = Declared(Kind.RATIO, "", between(0.0, 0.49), "Poisson's ratio", 0.26)
_DENSITY = Declared(Kind.INERTIA, "kg/m^3", up_to(1e5), "Density", 7200.0)


@described
@dataclass(frozen=True)
class Material:
    """Isotropic elasticity and density."""

    youngs_modulus: float = required(_YOUNG)
    poissons_ratio: float = required(_POISSON)
    density: float = required(_DENSITY)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants lambda and mu, Pa."""
        young, poisson = self.youngs_modulus, self.poissons_ratio
        shear = young / (2.0 * (1.0 + poisson))
        return 2.0 * shear * poisson / (1.0 - 2.0 * poisson), shear


GRAY_CAST_IRON = Material(110e9, 0.26, 7200.0)
"""EN-GJL-250 (EN 1561, annex A: 103 to 118 GPa, 0.26, 7200 kg/m^3)."""
SPHEROIDAL_CAST_IRON = Material(169e9, 0.275, 7100.0)
"""EN-GJS-400 (EN 1563, annex)."""
CAST_ALUMINUM = Material(73e9, 0.33, 2700.0)
"""Die-cast aluminum-silicon alloys, usual value."""
MATERIALS = {
    "gray_cast_iron": GRAY_CAST_IRON,
    "spheroidal_cast_iron": SPHEROIDAL_CAST_IRON,
    "cast_aluminum": CAST_ALUMINUM,
}
