"""Full finite-element contact over the face: positions x torques x misalignments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fe_contact.errors import InputError
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray
from model_studies.progress import Report
from verification.full_contact.condensation.contact_model import softness
from verification.full_contact.condensation.linearized_contact import ContactGeometry
from verification.full_contact.condensation.modified_flank import removed_at_roll
from verification.full_contact.condensation.placed_mesh import PlacedBody
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.sites import ContactSite
from verification.full_contact.condensation.solve import contact_tables, resolutions
from verification.full_contact.over_face.extruded_body import ExtrudedBody, extruded_body
from verification.full_contact.over_face.face_geometry import FaceGeometry
from verification.full_contact.over_face.layers import graded_layers
from verification.full_contact.table import FullContactTable
from verification.full_contact.validity import check_axes, refusal_over_face

_ACROSS = 201
USUAL = Resolution(per_half_width=2.5, layers=7)


@dataclass(frozen=True)
class _WholeFace:
    """A contact for each misalignment."""

    misalignments: tuple[float, ...]
    """Growth of the gap over the face in the plane of action, m."""
    outermost: float
    """Thickness of the layer at the face over that at mid-face."""

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
        over = graded_layers(pair.face_width, layers, self.outermost)
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


def solve_full_contact_over_face(
    pair: ParallelAxes,
    torques: Sequence[float],
    positions: Sequence[float],
    misalignments: Sequence[float] = (0.0,),
    resolution: Resolution = USUAL,
    *,
    estimate_error: bool = False,
    report: Report | None = None,
) -> tuple[FullContactTable, ...]:
    """Solve the contact of a spur pair in three dimensions with all teeth, bodies and the contact resolved.

    The plane mesh of a position, extruded: 15-node wedges over half the face, the halves joined by an even
    and an odd problem. One condensation of each gear serves all torques and misalignments, which enter with
    the modification of the flanks through the gap. Raises `InputError`: a pair that it does not hold, a
    torque that is not positive, a misalignment that is no number.

    Parameters
    ----------
    pair : GearPair
        Spur, clamped, solid, of equal faces; any modification of sharp-tipped flanks (`refusal_over_face`).
    torques : sequence of float
        On gear 1, N m, > 0.
    positions : sequence of float
        By the driving gear, base pitches.
    misalignments : sequence of float
        Growth of the gap over the face in the plane of action, zero at mid-face, m.
    estimate_error : bool
        Solve on a mesh with fewer layers and larger elements too, and state the difference as error.
    report : callable, optional
        Called with the fraction done before each position.

    Returns
    -------
    tuple of FullContactTable
        One for each misalignment, which share CPU seconds evenly.
    """
    if (reason := refusal_over_face(pair)) is not None:
        raise InputError("pair", "this pair", f"one that full contact over the face holds; {reason}")
    check_axes(torques, positions, misalignments)
    meshes = resolutions(resolution, estimate_error=estimate_error)
    growth = tuple(float(misalignment) for misalignment in misalignments)
    model = _WholeFace(growth, resolution.outermost)
    return contact_tables(model, pair, torques, positions, meshes, report)
