"""A ring gear with trapezoidal teeth by plane finite elements, made by gmsh and scikit-fem alone."""

import math
from functools import cached_property

import gmsh
import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import eigsh, splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, MeshTri
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity

YOUNG, RATIO, DENSITY = 210e9, 0.3, 7850.0
DEPTH, ROOT, TIP = 2.1, 0.33, 0.16
"""Depth of a tooth in modules; half of its thickness at the root and at the tip in pitches."""


class ToothedRing:
    """Root radius, outer radius, teeth and module of a ring, 20 mm wide."""

    width = 0.02

    def __init__(self, root: float, outer: float, teeth: int, module: float) -> None:
        self.root, self.outer, self.teeth, self.module = root, outer, teeth, module

    @cached_property
    def mesh(self) -> MeshTri:
        gmsh.initialize(interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            shape, size = gmsh.model.geo, 0.6 * self.module
            tip, pitch = self.root - DEPTH * self.module, 2.0 * math.pi / self.teeth
            corners = ((-ROOT, self.root), (-TIP, tip), (TIP, tip), (ROOT, self.root))
            inner = [
                shape.addPoint(r * math.cos(a), r * math.sin(a), 0.0, size)
                for tooth in range(self.teeth)
                for a, r in (((tooth + part) * pitch, r) for part, r in corners)
            ]
            outer = [
                shape.addPoint(self.outer * math.cos(a), self.outer * math.sin(a), 0.0, size)
                for a in 2.0 * math.pi * np.arange(360) / 360
            ]
            loops = []
            for points in (outer, inner):
                lines = [shape.addLine(*ends) for ends in zip(points, [*points[1:], points[0]], strict=True)]
                loops.append(shape.addCurveLoop(lines))
            shape.addPlaneSurface(loops)
            shape.synchronize()
            gmsh.model.mesh.generate(2)
            tags, coordinates, _ = gmsh.model.mesh.getNodes()
            triangles = gmsh.model.mesh.getElements(2)[2][0].reshape(-1, 3)
        finally:
            gmsh.finalize()
        place = {int(tag): coordinates.reshape(-1, 3)[k, :2] for k, tag in enumerate(tags)}
        used, corner = np.unique(triangles, return_inverse=True)
        points = np.array([place[int(tag)] for tag in used]).T
        return MeshTri(np.ascontiguousarray(points), np.ascontiguousarray(corner.reshape(-1, 3).T))

    @cached_property
    def basis(self) -> Basis:
        return Basis(self.mesh, ElementVector(ElementTriP2()))

    @cached_property
    def stiffness(self) -> csr_matrix:
        shear = 0.5 * YOUNG / (1.0 + RATIO)
        return self.width * linear_elasticity(YOUNG * RATIO / (1.0 - RATIO**2), shear).assemble(self.basis)

    def free_modes(self) -> np.ndarray:
        """Return the first natural frequencies that are no rigid motion, Hz."""
        mass = self.width * BilinearForm(lambda u, v, _w: DENSITY * dot(u, v)).assemble(self.basis)
        square = eigsh(self.stiffness, 13, mass, sigma=-1e6, return_eigenvectors=False)
        return np.sqrt(np.sort(np.maximum(square, 0.0))[3:]) / (2.0 * np.pi)

    def row(self, nodes: np.ndarray, radial: float, tangential: float) -> np.ndarray:
        """Return the mean motion of nodes in a direction, (dofs,)."""
        angle = np.arctan2(*self.mesh.p[::-1, nodes])
        row = np.zeros(self.basis.N)
        row[self.basis.nodal_dofs[0, nodes]] = radial * np.cos(angle) - tangential * np.sin(angle)
        row[self.basis.nodal_dofs[1, nodes]] = radial * np.sin(angle) + tangential * np.cos(angle)
        return row / nodes.size

    def added(self, teeth: np.ndarray, lugs: int, stiffness: float, pressure_angle: float, half_lug: float):
        """Return angles of loaded flanks, their radius, and the compliance on lugs less that of a held ring.

        Lugs of an angle 2 `half_lug` hold the outer surface, radially and tangentially alike.
        """
        radius = np.hypot(*self.mesh.p)
        angle = np.arctan2(*self.mesh.p[::-1])
        outer = np.flatnonzero(radius > 0.999 * self.outer)
        pitch, at = 2.0 * math.pi / self.teeth, self.root - 1.25 * self.module
        flanks = np.array(
            [
                np.argmin(np.hypot(*(self.mesh.p.T - [at * math.cos(a), at * math.sin(a)]).T))
                for a in (teeth - 0.5 * (ROOT + TIP)) * pitch
            ]
        )
        direction = math.sin(pressure_angle), math.cos(pressure_angle)
        loads = np.array([self.row(np.array([node]), *direction) for node in flanks]).T
        held = self.basis.get_dofs(
            self.mesh.facets_satisfying(lambda x: np.hypot(*x) > 0.999 * self.outer, boundaries_only=True)
        ).all()
        free = np.setdiff1d(np.arange(self.basis.N), held)
        clamped = splu(self.stiffness.tocsc()[free][:, free]).solve(loads[free])
        matrix = self.stiffness
        for lug in 2.0 * math.pi * np.arange(lugs) / lugs:
            nodes = outer[np.abs(np.angle(np.exp(1j * (angle[outer] - lug)))) < half_lug]
            for sides in ((1.0, 0.0), (0.0, 1.0)):
                spring = csr_matrix(self.row(nodes, *sides))
                matrix = matrix + stiffness * spring.T @ spring
        moved = loads.T @ splu(matrix.tocsc()).solve(loads)
        return angle[flanks], at, moved - loads[free].T @ clamped
