"""Hulls of tests: spheres and boxes of triangles with outward normals."""

import numpy as np
from scipy.spatial import ConvexHull

from dynamics.acoustics import Hull


def _outward(nodes, triangles):
    corners = nodes[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normals * corners.mean(axis=1), axis=1) < 0.0
    return np.where(inward[:, None], triangles[:, ::-1], triangles).astype(int)


def sphere(divisions, radius=1.0):
    """Icosahedron with edges in `divisions` parts, 20 divisions^2 panels, of the volume of the sphere."""
    golden = (1.0 + 5.0**0.5) / 2.0
    signs = [(a, b) for a in (-1.0, 1.0) for b in (-golden, golden)]
    corners = np.array([p for a, b in signs for p in ((0.0, a, b), (a, b, 0.0), (b, 0.0, a))])
    faces = ConvexHull(corners).simplices
    steps = [(i, j) for i in range(divisions + 1) for j in range(divisions + 1 - i)]
    weights = np.array([(i, j, divisions - i - j) for i, j in steps]) / divisions
    points = np.unique(np.round(np.concatenate([weights @ corners[face] for face in faces]), 9), axis=0)
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = ConvexHull(points)
    scale = radius * (4.0 * np.pi / 3.0 / hull.volume) ** (1.0 / 3.0)
    return Hull(points * scale, _outward(points, hull.simplices))


def box(sides, divisions):
    """Closed box about the origin, its edges in that many parts, each rectangle in two triangles."""
    nodes, triangles = [], []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        for end in (-0.5, 0.5):
            start, across = len(nodes), divisions[second] + 1
            for i in range(divisions[first] + 1):
                for j in range(across):
                    node = np.zeros(3)
                    node[axis], node[first], node[second] = (
                        end,
                        i / divisions[first] - 0.5,
                        j / divisions[second] - 0.5,
                    )
                    nodes.append(node)
            for i in range(divisions[first]):
                for j in range(divisions[second]):
                    at = start + i * across + j
                    triangles += [(at, at + 1, at + across), (at + 1, at + across + 1, at + across)]
    merged, where = np.unique(np.round(np.array(nodes), 12), axis=0, return_inverse=True)
    return Hull(merged * np.asarray(sides), _outward(merged, where[np.array(triangles)]))
