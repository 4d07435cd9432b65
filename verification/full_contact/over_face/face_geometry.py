"""All weak gaps of a pair over its face under one misalignment, as one contact system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray
from verification.full_contact.condensation.active_set import ContactSystem
from verification.full_contact.condensation.flank_curve import FlankCurve
from verification.full_contact.condensation.linearized_contact import (
    MIN_FACING,
    Configuration,
    LinearizedContact,
    Solution,
    rotation,
)
from verification.full_contact.condensation.modified_flank import material_removed
from verification.full_contact.condensation.pair_geometry import at_end
from verification.full_contact.condensation.sites import ContactSite
from verification.full_contact.condensation.weak_gap import WeakGap, weak_gap
from verification.full_contact.line_load import LineLoad, line_loads
from verification.full_contact.over_face.extruded_body import ExtrudedBody
from verification.full_contact.over_face.face_gap import FaceGap, face_gap


@dataclass(frozen=True)
class FaceGeometry:
    """Two condensed bodies over their face that may touch at sites.

    Displacements of a gear are those of the functions of its strips, (2, 2 k f) flat: in the half of positive
    and of negative face position, each as seen from mid-face.
    """

    pair: ParallelAxes
    """Gear pair; both gears have equal face widths."""
    sites: tuple[ContactSite, ...]
    bodies: tuple[ExtrudedBody, ExtrudedBody]
    misalignment: float
    """Growth of the gap over the face in the plane of action, zero at mid-face, m."""
    thickness: float = 1.0

    @property
    def undeformed(self) -> Configuration:
        """The configuration without load."""
        first, second = (np.zeros(2 * len(body.even)) for body in self.bodies)
        return Configuration(0.0, (first, second))

    def linearized(self, at: Configuration) -> LinearizedContact:
        """Return the contact linearized about a configuration."""
        sections = _Sections(self, at)
        layers = self.bodies[0].layers
        gaps = [
            face_gap(lambda z, site=site: sections.gap(site, z), layers)  # type: ignore[misc]
            for site in self.sites
        ]
        return self._gathered(gaps, at)

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return breach of the laws and ratio of the torques: moments of the held circles' reactions.

        They balance the torque on gear 1, and on gear 2 the moment of the contact forces about its center.
        """
        checks = []
        for contact, pressure, torque in solutions:
            reactions, applied = [], []
            for body, forces in zip(self.bodies, contact.forces, strict=True):
                on_halves = (forces @ pressure).reshape(2, -1).sum(axis=0)
                reactions.append(float(body.bore_moment @ on_halves))
                applied.append(float(body.arms @ on_halves))
            breach = max(abs(reactions[0] / torque + 1.0), abs(reactions[1] / applied[1] + 1.0))
            checks.append((breach, abs(applied[1]) / torque))
        return checks

    def line_loads(self, contact: LinearizedContact, pressure: FloatArray) -> tuple[LineLoad, ...]:
        """Return the load of every pair along the face."""
        planes = self.bodies[0].layers.planes
        face = np.concatenate([-planes[:0:-1], planes])
        ahead = np.array([site.ahead for site in self.sites])[contact.site]
        return line_loads(ahead, face[contact.line % len(face)], pressure * contact.system.weight)

    def _gathered(self, gaps: Sequence[FaceGap], at: Configuration) -> LinearizedContact:
        """Join the pairs, without hats that hardly face their mate."""
        full = [self._full_weights(site) for site in self.sites]
        facing_hats = np.concatenate(
            [gap.weight > MIN_FACING * maximum for gap, maximum in zip(gaps, full, strict=True)]
        )
        forces = (self._forces(gaps, 0)[:, facing_hats], self._forces(gaps, 1)[:, facing_hats])
        rows = [sp.csr_array(force.T) for force in forces]  # a hat loads few nodes and functions
        displacement = (self.bodies[0].displacement(rows[0]), self.bodies[1].displacement(rows[1]))
        compliance = rows[0] @ displacement[0] + rows[1] @ displacement[1]
        gap, closing, weight = (
            np.concatenate([getattr(gap, name) for gap in gaps])[facing_hats]
            for name in ("gap", "closing", "weight")
        )
        for force, deformed in zip(forces, at.displacements, strict=True):
            gap -= force.T @ deformed
        halves = forces[0].reshape(2, -1, forces[0].shape[1]).sum(axis=0)
        system = ContactSystem(
            gap + closing * at.lag,
            np.asarray(0.5 * (compliance + compliance.T)),
            closing,
            self.bodies[0].arms @ halves,
            weight,
        )
        site = np.repeat(np.arange(len(gaps)), [len(gap.gap) for gap in gaps])[facing_hats]
        over = 2 * len(self.bodies[0].layers.planes) - 1
        line = np.concatenate(
            [number * over + np.arange(len(gap.gap)) % over for number, gap in enumerate(gaps)]
        )
        ends = np.concatenate(
            [np.repeat(at_end(self.pair, site, self.bodies[site.slave].body), over) for site in self.sites]
        )
        return LinearizedContact(system, forces, displacement, site, line[facing_hats], ends[facing_hats])

    def _forces(self, gaps: Sequence[FaceGap], number: int) -> FloatArray:
        """Return the forces (2 2 k f, h) of all pairs on one gear."""
        body = self.bodies[number]
        blocks = []
        for site, gap in zip(self.sites, gaps, strict=True):
            force = gap.forces[number]
            columns = body.columns[site.ahead]
            block = np.zeros((2, len(body.nodes), len(body.even) // len(body.nodes), force.shape[-1]))
            block[:, columns] = force.reshape(2, len(columns), -1, force.shape[-1])
            blocks.append(block.reshape(-1, force.shape[-1]))
        return np.concatenate(blocks, axis=1)

    def _full_weights(self, site: ContactSite) -> FloatArray:
        """Return the areas of the hats of a site's slave, (i j,) m^2."""
        body = self.bodies[site.slave]
        lengths = np.linalg.norm(np.diff(body.points[body.columns[site.ahead]], axis=0), axis=1)
        planes = body.layers.planes
        widths = np.diff(np.concatenate([-planes[:0:-1], planes]))
        along, over = (0.5 * (np.append(d, 0.0) + np.insert(d, 0, 0.0)) for d in (lengths, widths))
        return np.asarray(np.outer(along, over).ravel())


@dataclass(frozen=True)
class _Sections:
    """Sections of a pair across its axes in one configuration."""

    geometry: FaceGeometry
    at: Configuration

    @cached_property
    def _normals(self) -> dict[tuple[int, int], FloatArray]:
        """Outward normals (k, 2) at the nodes of each strip, by gear and pair index."""
        normals = {}
        for number, body in enumerate(self.geometry.bodies):
            for ahead, columns in body.columns.items():
                curve = FlankCurve(body.points[columns])
                normals[number, ahead] = curve.points(0.5 * np.arange(float(len(columns)))).normals
        return normals

    def gap(self, site: ContactSite, z: float) -> tuple[WeakGap, float]:
        """Return the weak gap at a face position, and the angle by which gear 2 is turned there."""
        geometry = self.geometry
        rate = -geometry.pair.wheel.sign / geometry.pair.wheel.base_radius
        opened = geometry.misalignment * z / geometry.pair.face_width
        angle = rate * (self.at.lag - opened)
        turn, center = rotation(angle), geometry.bodies[1].body.center
        rigid, displacement = zip(*(self._strip(number, site.ahead, z) for number in range(2)), strict=True)
        rigid = rigid[0], (rigid[1] - center) @ turn.T + center
        deformed = rigid[0] + displacement[0], rigid[1] + displacement[1] @ turn.T

        def lag(points: FloatArray) -> FloatArray:
            return np.asarray(rate * (points - center)[:, ::-1] * [-1.0, 1.0])

        curves = FlankCurve(deformed[0]), FlankCurve(deformed[1])
        return weak_gap(curves, FlankCurve(rigid[site.slave]), site.slave, lag), angle

    def _strip(self, number: int, ahead: int, z: float) -> tuple[FloatArray, FloatArray]:
        """Return the nodes of a strip with its modification at z, and their displacements, (k, 2) m."""
        body = self.geometry.bodies[number]
        gear = (self.geometry.pair.pinion, self.geometry.pair.wheel)[number]
        columns, strip = body.columns[ahead], body.body.strips[ahead]
        more = material_removed(gear, strip.s, z) - material_removed(gear, strip.s)
        positions = body.points[columns] - more[:, None] * self._normals[number, ahead]
        half = self.at.displacements[number].reshape(2, len(body.nodes), 2, -1)[0 if z > 0.0 else 1]
        return positions, half[columns] @ body.layers.functions(np.array([abs(z)]))[0]
