"""The models of a full contact: plane strain, or the whole face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from fe_contact.geometry import ParallelAxes
from verification.full_contact.condensation.condensed_body import condensed_body
from verification.full_contact.condensation.linearized_contact import ContactGeometry
from verification.full_contact.condensation.pair_geometry import PairGeometry
from verification.full_contact.condensation.placed_mesh import PlacedBody
from verification.full_contact.condensation.sites import ContactSite

MESH_STIFFNESS = 20e9 / 210e9
"""Mesh stiffness of steel teeth, about 20 N/(mm um), over the modulus of elasticity. It gives a first guess
of the deflection.
"""


class ContactModel(Protocol):
    """The contacts made of the plane mesh of a position."""

    @property
    def count(self) -> int:
        """Number of contacts that share the bodies."""

    def largest_line_load(self, pair: ParallelAxes, normal_force: float) -> float:
        """Return about the largest load per face width, N/m."""

    def closer(self, pair: ParallelAxes) -> float:
        """Return by how much flanks come closer anywhere than at mid-face, m, >= 0."""

    def geometries(
        self,
        pair: ParallelAxes,
        sites: tuple[ContactSite, ...],
        meshes: tuple[PlacedBody, PlacedBody],
        layers: int,
    ) -> tuple[tuple[ContactGeometry, ...], int]:
        """Return the contacts, and the unknowns of their bodies."""


@dataclass(frozen=True)
class PlaneStrain:
    """One contact, the same all along the face."""

    count: int = 1

    def largest_line_load(self, pair: ParallelAxes, normal_force: float) -> float:
        """Return the mean: it is the same everywhere."""
        return normal_force / pair.face_width

    def closer(self, pair: ParallelAxes) -> float:
        """Return 0."""
        return 0.0

    def geometries(
        self,
        pair: ParallelAxes,
        sites: tuple[ContactSite, ...],
        meshes: tuple[PlacedBody, PlacedBody],
        layers: int,
    ) -> tuple[tuple[ContactGeometry, ...], int]:
        """Condense both gears in the plane."""
        materials = (pair.pinion.material, pair.wheel.material)
        first, second = (condensed_body(m, material) for m, material in zip(meshes, materials, strict=True))
        unknowns = 2 * sum(len(mesh.points) for mesh in meshes)
        return (PairGeometry(pair, sites, (first, second)),), unknowns


def softness(pair: ParallelAxes) -> float:
    """Return about the lag by a load per face width, m per N/m."""
    gears = (pair.pinion, pair.wheel)
    return sum(0.5 / gear.material.youngs_modulus for gear in gears) / MESH_STIFFNESS
