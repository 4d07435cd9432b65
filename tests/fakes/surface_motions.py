"""The motion of a housing's surface across itself, by the elements' shape functions."""

import numpy as np

from dynamics.housings.quadrature import over_surface, triangle
from dynamics.housings.reduced_housing import SurfaceMotion


def normal_displacement(surface: SurfaceMotion) -> tuple[np.ndarray, np.ndarray]:
    """Return mean outward displacements of triangles per coordinate, (t, r), and areas, (t,) in m^2."""
    area, _ = over_surface(surface.points, surface.triangles)
    nodal = np.einsum("tpi,ap->tai", area, triangle().shape)
    size = np.linalg.norm(area, axis=2).sum(axis=1)
    flow = np.einsum("tai,tair->tr", nodal, surface.motion[surface.triangles], optimize=True)
    return flow / size[:, None], size
