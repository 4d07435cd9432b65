"""Layer operators of the Helmholtz equation by NGSolve: the one module that loads it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dynamics.acoustics.hull import ComplexArray, Hull
from host import MissingExtra


def layer_operators(
    hull: Hull, wavenumber: float, done: Callable[[str], None] = lambda _layer: None
) -> tuple[ComplexArray, ComplexArray]:
    """Return the dense single layer (T, T) and double layer (T, N), tested with the panels, m^3 and m^2.

    Kernel e^{+ikr}/(4 pi r); the single layer acts on constants of the panels, the double layer on hats of
    the nodes. Singular pairs are integrated by the library's own transformations. `done` is called with
    "single layer" and "double layer".

    Raises
    ------
    MissingExtra
        If NGSolve is not installed.
    """
    try:
        import ngsolve  # noqa: PLC0415 (an extra)
        from ngsolve.bem import HelmholtzDL, HelmholtzSL  # noqa: PLC0415
    except ModuleNotFoundError:
        raise MissingExtra("ngsolve", "boundary-elements") from None
    mesh = _mesh(hull)
    hats = ngsolve.H1(mesh, order=1, complex=True, definedon=mesh.Boundaries(".*")).TrialFunction()
    constant, test = ngsolve.SurfaceL2(mesh, order=0, complex=True).TnT()
    ds = ngsolve.ds
    single = _dense((HelmholtzSL(constant * ds, wavenumber, use_fmm=False) * test * ds).mat)
    done("single layer")
    double = _dense((HelmholtzDL(hats * ds, wavenumber, use_fmm=False) * test * ds).mat)
    done("double layer")
    return single, double


def _mesh(hull: Hull) -> Any:
    """Return the hull as a mesh of the library, nodes and panels in the same order."""
    import ngsolve  # noqa: PLC0415 (an extra)
    from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint, Pnt  # noqa: PLC0415

    mesh = Mesh(dim=3)
    mesh.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    points = [mesh.Add(MeshPoint(Pnt(*(float(value) for value in node)))) for node in hull.nodes]
    for triangle in hull.triangles:
        mesh.Add(Element2D(1, [points[node] for node in triangle]))
    return ngsolve.Mesh(mesh)


def _dense(matrix: Any) -> ComplexArray:
    """Return the entries of a matrix of the library as an array."""
    rows, columns, values = (np.asarray(part) for part in matrix.COO())
    entries = np.zeros((matrix.height, matrix.width), dtype=complex)
    entries[rows, columns] = values
    return entries
