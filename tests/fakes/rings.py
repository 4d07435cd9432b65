"""Elastic rings of 100 mm mean radius, on eight lugs, and the same by finite elements."""

import math

import numpy as np
from scipy.sparse import csr_matrix
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, MeshQuad
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity

from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.ring_compliance import Port
from dynamics.elastic_ring.ring_support import RingSupport

RADIUS, PRESSURE_ANGLE = 0.1, math.radians(20.0)
LUGS = RingSupport(lugs=8, first_lug=0.1, lug_radial=2e8, lug_tangential=3e8)


def ring_of(slenderness: float) -> Annulus:
    """Return a ring whose height is `slenderness` of its mean radius."""
    half = 0.5 * slenderness * RADIUS
    return Annulus(RADIUS - half, RADIUS + half, 0.02)


def mesh_port(ring: Annulus, angle: np.ndarray) -> Port:
    """Return the lines of action of planets at angles."""
    return Port(angle, ring.inner_radius - 4e-3, math.sin(PRESSURE_ANGLE), math.cos(PRESSURE_ANGLE))


def annulus_elements(
    ring: Annulus, around: int = 200, across: int = 4
) -> tuple[csr_matrix, csr_matrix, Basis]:
    """Return stiffness, mass and basis of a free annulus in plane stress, by quadratic elements.

    Corners lie at multiples of 2 pi / around, the first at angle zero.
    """
    angle = 2.0 * np.pi * np.arange(around) / around
    radius = np.linspace(ring.inner_radius, ring.outer_radius, across + 1)
    points = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)]).reshape(2, -1)
    first, layer = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    corner = [((first + i) % around) * (across + 1) + layer + j for i, j in ((0, 0), (0, 1), (1, 1), (1, 0))]
    basis = Basis(MeshQuad(points, np.stack([c.ravel() for c in corner])), ElementVector(ElementQuad2()))
    ratio = ring.poissons_ratio
    shear = 0.5 * ring.youngs_modulus / (1.0 + ratio)
    first_lame = ring.youngs_modulus * ratio / (1.0 - ratio**2)
    stiffness = ring.width * linear_elasticity(first_lame, shear).assemble(basis)
    mass = ring.width * BilinearForm(lambda u, v, _w: ring.density * dot(u, v)).assemble(basis)
    return stiffness, mass, basis
