"""The whole face: misalignments that share the bodies of a position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fe_contact.full_contact.condensation.contact_model import softness
from fe_contact.full_contact.condensation.linearized_contact import ContactGeometry
from fe_contact.full_contact.condensation.modified_flank import removed_at_roll
from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.full_contact.condensation.sites import ContactSite
from fe_contact.full_contact.over_face.extruded_body import ExtrudedBody, extruded_body
from fe_contact.full_contact.over_face.face_geometry import FaceGeometry
from fe_contact.full_contact.over_face.layers import graded_layers
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray

_ACROSS = 201


@dataclass(frozen=True)
class WholeFace:
    """A contact for each misalignment.

    Attributes
    ----------
    misalignments : tuple of float
        Growth of the gap over the face in the plane of action, m.
    """

    misalignments: tuple[float, ...]

    @property
    def count(self) -> int:
        """Number of contacts that share the bodies."""
        return len(self.misalignments)

    def largest_line_load(self, pair: ParallelAxes, normal_force: float) -> float:
        """Return the largest load of springs side by side, N/m: it sizes elements, and nothing else."""
        per_width = softness(pair)
        mean = normal_force / pair.face_width
        largest = mean
        for opened in self._opened(pair):
            reach = opened.min(), opened.max() + mean * per_width

            def excess(lag: float, opened: FloatArray = opened) -> float:
                return float(np.mean(np.maximum(lag - opened, 0.0))) - mean * per_width

            largest = max(largest, (brentq(excess, *reach) - opened.min()) / per_width)
        return float(largest)

    def closer(self, pair: ParallelAxes) -> float:
        """Return by how much flanks come closer anywhere than at mid-face, m, >= 0."""
        return float(max(0.0, -self._opened(pair).min()))

    def geometries(
        self,
        pair: ParallelAxes,
        sites: tuple[ContactSite, ...],
        meshes: tuple[PlacedBody, PlacedBody],
        layers: int,
    ) -> tuple[tuple[ContactGeometry, ...], int]:
        """Condense both gears over the face."""
        over = graded_layers(pair.face_width, layers)
        materials = (pair.pinion.material, pair.wheel.material)
        bodies: list[ExtrudedBody] = [
            extruded_body(mesh, over, material) for mesh, material in zip(meshes, materials, strict=True)
        ]
        both = bodies[0], bodies[1]
        contacts = tuple(FaceGeometry(pair, sites, both, growth) for growth in self.misalignments)
        return contacts, sum(body.unknowns for body in bodies)

    def _opened(self, pair: ParallelAxes) -> FloatArray:
        """Return the gap beyond that at mid-face, at the pitch point, (misalignments, across) m."""
        z = np.linspace(-0.5, 0.5, _ACROSS) * pair.face_width
        rolls = (
            pair.path_of_contact.pitch_point,
            float(pair.mating_roll_length(pair.path_of_contact.pitch_point)),
        )
        removed = sum(
            np.array([removed_at_roll(gear, np.array(roll), face) for face in z])
            - removed_at_roll(gear, np.array(roll))
            for gear, roll in zip((pair.pinion, pair.wheel), rolls, strict=True)
        )
        return np.asarray(np.outer(self.misalignments, z / pair.face_width) + removed)
