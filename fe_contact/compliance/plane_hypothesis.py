"""Plane hypotheses about the direction along the face: plane strain and plane stress."""

from __future__ import annotations

from enum import Enum

from fe_contact.material import Material


class PlaneHypothesis(Enum):
    """Plane strain (no strain along the axis: wide gears) or plane stress (free faces: thin gears)."""

    PLANE_STRAIN = "plane_strain"
    PLANE_STRESS = "plane_stress"

    def lame_parameters(self, material: Material) -> tuple[float, float]:
        """Return lambda and mu in Pa of the plane problem; lambda is the reduced one in plane stress.

        Timoshenko and Goodier, Theory of Elasticity, 3rd ed., articles 16 and 17.
        """
        E, nu = material.youngs_modulus, material.poissons_ratio
        mu = 0.5 * E / (1.0 + nu)
        if self is PlaneHypothesis.PLANE_STRESS:
            return E * nu / (1.0 - nu**2), mu
        return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu

    def contact_modulus(self, material: Material) -> float:
        """Return E / (1 - nu^2) in plane strain, E in plane stress, Pa: the modulus of the half plane."""
        if self is PlaneHypothesis.PLANE_STRESS:
            return material.youngs_modulus
        return material.plane_strain_modulus
