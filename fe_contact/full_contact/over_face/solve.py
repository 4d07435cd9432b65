"""Full finite-element contact over the face: positions x torques x misalignments."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq

from fe_contact.errors import InputError
from fe_contact.full_contact.condensation.contact_model import at_end, softness
from fe_contact.full_contact.condensation.linearized_contact import (
    LEAST_FACING,
    Configuration,
    ContactGeometry,
    ContactSystem,
    LinearizedContact,
    Solution,
    rotation,
    turned_back,
)
from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.full_contact.condensation.sites import (
    ContactSite,
    Resolution,
    material_removed,
    removed_at_roll,
)
from fe_contact.full_contact.condensation.solve import contact_tables, resolutions
from fe_contact.full_contact.condensation.weak_gap import FlankCurve, WeakGap, weak_gap
from fe_contact.full_contact.over_face.extruded_body import ExtrudedBody, extruded_body
from fe_contact.full_contact.over_face.extruded_stiffness import Layers, graded_layers
from fe_contact.full_contact.table import FullContactTable, LineLoad, line_loads
from fe_contact.full_contact.validity import check_axes, refusal_over_face
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray
from model_studies.progress import Report

# Weak gap of one tooth pair over the face: that of its sections, against hats along the face.


Section = Callable[[float], tuple[WeakGap, float]]
"""The weak gap at a face position from mid-face, m, and the angle by which gear 2 is turned there, rad."""

_ACROSS = 201
USUAL = Resolution(per_half_width=2.5, layers=7)


@dataclass(frozen=True)
class FaceGap:
    """Weak gap of one pair; h = i j hats, i along the profile times j = 2 p - 1 over the face."""

    gap: FloatArray
    weight: FloatArray
    """`gap`, `weight`: m^3 and m^2. Shape (h,) each."""
    closing: FloatArray
    """-dG by the lag of the driven gear, m^2. Shape (h,)."""
    forces: tuple[FloatArray, FloatArray]
    """On the functions of both gears' strips by unit pressures, m^2; in the half of positive and of negative
    face position, each as seen from mid-face. In the frames of the meshes. ((2, 2 k_1 f, h), (2, 2 k_2 f, h))
    arrays.
    """


def face_gap(section: Section, layers: Layers) -> FaceGap:
    """Integrate the sections over the face, three in each layer of either half."""
    z, weights = layers.quadrature
    hats, functions = layers.hats(z), layers.functions(z)
    planes = len(layers.planes)
    scalars, forces = [], []
    for side in (1, -1):
        sections = [section(side * position) for position in z.tolist()]
        over = np.zeros((len(z), 2 * planes - 1))
        over[:, planes - 1 :] = hats
        over = over if side > 0 else over[:, ::-1]
        weighted = weights[:, None] * over
        gaps = [np.stack([gap.gap, gap.weight, gap.closing]) for gap, _ in sections]
        scalars.append(np.einsum("qsi,qj->sij", np.array(gaps), weighted))
        products = (functions[:, :, None] * weighted[:, None]).reshape(len(z), -1)
        first = np.array([gap.forces[0] for gap, _ in sections])
        second = np.array([turned_back(gap.forces[1], rotation(turn)) for gap, turn in sections])
        forces.append([_over_functions(own, products, functions.shape[1]) for own in (first, second)])
    gap, weight, closing = (scalars[0] + scalars[1]).reshape(3, -1)
    on_first, on_second = (np.stack(pair) for pair in zip(*forces, strict=True))
    return FaceGap(gap, weight, closing, (on_first, on_second))


def _over_functions(sections: FloatArray, products: FloatArray, functions: int) -> FloatArray:
    """Return forces (2 k f, i j) from those of sections (q, 2 k, i) and products of f and hats (q, f j)."""
    points, rows, hats = sections.shape
    total = (sections.reshape(points, -1).T @ products).reshape(rows, hats, functions, -1)
    return np.asarray(total.transpose(0, 2, 1, 3).reshape(rows * functions, -1))


# All weak gaps of a pair over its face under one misalignment, as one contact system.


@dataclass(frozen=True)
class _FaceGeometry:
    """Two condensed bodies over their face that may touch at sites.

    Displacements of a gear are those of the functions of its strips, (2, 2 k f) flat: in the half of positive
    and of negative face position, each as seen from mid-face.
    """

    pair: ParallelAxes
    """Of equal face widths."""
    sites: tuple[ContactSite, ...]
    bodies: tuple[ExtrudedBody, ExtrudedBody]
    misalignment: float
    """Growth of the gap over the face in the plane of action, zero at mid-face, m."""
    thickness: float = 1.0

    @property
    def undeformed(self) -> Configuration:
        first, second = (np.zeros(2 * len(body.even)) for body in self.bodies)
        return Configuration(0.0, (first, second))

    def linearized(self, at: Configuration) -> LinearizedContact:
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
                reactions.append(float(body.held_moment @ on_halves))
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
        kept = np.concatenate(
            [gap.weight > LEAST_FACING * most for gap, most in zip(gaps, full, strict=True)]
        )
        forces = (self._forces(gaps, 0)[:, kept], self._forces(gaps, 1)[:, kept])
        rows = [sp.csr_array(own.T) for own in forces]  # a hat loads few nodes and functions
        moved = (self.bodies[0].moved(rows[0]), self.bodies[1].moved(rows[1]))
        compliance = rows[0] @ moved[0] + rows[1] @ moved[1]
        gap, closing, weight = (
            np.concatenate([getattr(gap, name) for gap in gaps])[kept]
            for name in ("gap", "closing", "weight")
        )
        for own, deformed in zip(forces, at.displacements, strict=True):
            gap -= own.T @ deformed
        halves = forces[0].reshape(2, -1, forces[0].shape[1]).sum(axis=0)
        system = ContactSystem(
            gap + closing * at.lag,
            np.asarray(0.5 * (compliance + compliance.T)),
            closing,
            self.bodies[0].arms @ halves,
            weight,
        )
        site = np.repeat(np.arange(len(gaps)), [len(gap.gap) for gap in gaps])[kept]
        over = 2 * len(self.bodies[0].layers.planes) - 1
        line = np.concatenate(
            [number * over + np.arange(len(gap.gap)) % over for number, gap in enumerate(gaps)]
        )
        ends = np.concatenate(
            [np.repeat(at_end(self.pair, site, self.bodies[site.slave].body), over) for site in self.sites]
        )
        return LinearizedContact(system, forces, moved, site, line[kept], ends[kept])

    def _forces(self, gaps: Sequence[FaceGap], number: int) -> FloatArray:
        """Return the forces (2 2 k f, h) of all pairs on one gear."""
        body = self.bodies[number]
        blocks = []
        for site, gap in zip(self.sites, gaps, strict=True):
            own = gap.forces[number]
            columns = body.columns[site.ahead]
            block = np.zeros((2, len(body.nodes), len(body.even) // len(body.nodes), own.shape[-1]))
            block[:, columns] = own.reshape(2, len(columns), -1, own.shape[-1])
            blocks.append(block.reshape(-1, own.shape[-1]))
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

    geometry: _FaceGeometry
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
        rigid, moved = zip(*(self._strip(number, site.ahead, z) for number in range(2)), strict=True)
        rigid = rigid[0], (rigid[1] - center) @ turn.T + center
        deformed = rigid[0] + moved[0], rigid[1] + moved[1] @ turn.T

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


# The whole face: misalignments that share the bodies of a position.


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
        contacts = tuple(_FaceGeometry(pair, sites, both, growth) for growth in self.misalignments)
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
