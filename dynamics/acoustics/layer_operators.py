"""Layer operators of the Helmholtz equation on a hull by NGSolve: the one file that loads it.

A hull is a closed surface of T triangles (panels) and N nodes. Entries are Galerkin products: an operator of
a basis function, integrated over a panel.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from dynamics.acoustics.hull import Hull
from dynamics.types import ComplexArray
from dynamics.work_cost import Cost
from host import MissingExtra, Unavailable
from model_studies.progress import Report, unreported
from model_studies.workers import InProcess, Workers, divided

BLOCK = 512
"""Largest number of panels in a block; the rows of a block are one task."""
TESTED = "tested"
"""Name, in the mesh of NGSolve, of the panels of a block: their rows are computed."""
OTHER = "other"
"""Name of all other panels in the mesh of NGSolve."""
SECONDS, GROWTH = 1.40e-6, 2.24
"""Coefficient c, s, and exponent g of the CPU seconds of both operators, c T^g.

Fitted to spheres of 500 to 2880 panels, within a factor of 1.2; a box of 7040 panels took 615 CPU s, where
the law gives 585. The number of entries grows by T^2 alone; larger operators miss the cache more often.
"""
BYTES, LIBRARY = 110.0, 1e8
"""Memory of the operators over the square of the number of panels, bytes (5.9 GB measured with 7040 panels),
and memory of NGSolve, bytes.
"""


def operators_cost(panels: int) -> Cost:
    """Predict the cost of the dense operators of a hull."""
    return Cost(SECONDS * panels**GROWTH, LIBRARY + BYTES * float(panels) ** 2)


def layer_operators(
    hull: Hull,
    wavenumber: float,
    report: Report = unreported,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> tuple[ComplexArray, ComplexArray]:
    """Return the dense single layer (T, T), m^3, and double layer (T, N), m^2, each tested with the panels.

    Kernel e^{+ikr}/(4 pi r); the single layer acts on constants of the panels, the double layer on hats of
    the nodes. Singular pairs are integrated by the library's own transformations. `report` is called with the
    fraction of the panels that are done.
    """
    panels = len(hull.triangles)
    single = np.empty((panels, panels), dtype=complex)
    double = np.empty((panels, len(hull.nodes)), dtype=complex)
    block_count = math.ceil(panels / BLOCK)
    ends = np.linspace(0, panels, block_count + 1).astype(int).tolist()
    blocks = list(pairwise(ends))
    seconds = operators_cost(panels).seconds
    rows = divided(workers, _layer_rows, (hull, wavenumber), blocks, seconds)
    for (first, end), block_rows in zip(blocks, rows, strict=True):
        single[first:end], double[first:end] = block_rows
        report(end / panels)
    return single, double


def _layer_rows(shared: tuple[Hull, float], block: tuple[int, int]) -> tuple[ComplexArray, ComplexArray]:
    """Return the rows of the single and the double layer tested with the panels first to end of a block."""
    try:
        import ngsolve  # noqa: PLC0415 (an extra)
        from ngsolve.bem import HelmholtzDL, HelmholtzSL  # noqa: PLC0415
    except ModuleNotFoundError:
        raise MissingExtra("ngsolve", "boundary-elements") from None
    except ImportError as error:
        remedy = f"Debian: apt-get install libquadmath0 ({error})."
        raise Unavailable("the libraries under NGSolve", remedy) from None
    (hull, wavenumber), ds = shared, ngsolve.ds
    mesh = _mesh(hull, block)
    hats = ngsolve.H1(mesh, order=1, complex=True, definedon=mesh.Boundaries(".*")).TrialFunction()
    constant = ngsolve.SurfaceL2(mesh, order=0, complex=True).TrialFunction()
    test_function = ngsolve.SurfaceL2(
        mesh, order=0, complex=True, definedon=mesh.Boundaries(TESTED)
    ).TestFunction()
    single = HelmholtzSL(constant * ds, wavenumber, use_fmm=False) * test_function * ds(TESTED)
    double = HelmholtzDL(hats * ds, wavenumber, use_fmm=False) * test_function * ds(TESTED)
    return _dense(single.mat, block), _dense(double.mat, block)


def _mesh(hull: Hull, block: tuple[int, int]) -> Any:
    """Return the hull as a mesh of the library, nodes and panels in the same order."""
    import ngsolve  # noqa: PLC0415 (an extra)
    from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint, Pnt  # noqa: PLC0415

    mesh = Mesh(dim=3)
    for number, name in ((1, TESTED), (2, OTHER)):
        mesh.Add(FaceDescriptor(surfnr=number, domin=1, bc=number))
        mesh.SetBCName(number - 1, name)
    points = [mesh.Add(MeshPoint(Pnt(*(float(value) for value in node)))) for node in hull.nodes]
    for panel, triangle in enumerate(hull.triangles):
        number = 1 if block[0] <= panel < block[1] else 2
        mesh.Add(Element2D(number, [points[node] for node in triangle]))
    return ngsolve.Mesh(mesh)


def _dense(matrix: Any, block: tuple[int, int]) -> ComplexArray:
    """Return the rows of a block as a dense array; the sparse `matrix` has entries in these rows only."""
    rows, columns, values = (np.asarray(part) for part in matrix.COO())
    entries = np.zeros((block[1] - block[0], matrix.width), dtype=complex)
    entries[rows - block[0], columns] = values
    return entries
