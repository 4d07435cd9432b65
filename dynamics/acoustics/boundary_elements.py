"""Boundary elements on a closed hull: the sound of its own surface in free space, scattering included.

Burton and Miller's combination of the boundary integral equation and its normal derivative has no irregular
frequencies [1]_. Pressure is linear on the panels, normal velocity constant; the dense operators come from
NGSolve (`boundary_operators`). The radiated power is that of the far field: it is a sum of squares, and
unlike the product of pressure and velocity on the surface it is no small difference at low frequency.

References
----------
.. [1] Burton, A. J.; Miller, G. F.: The application of integral equation methods to the numerical solution of
   some exterior boundary-value problems. Proc. R. Soc. Lond. A 323 (1971), 201-210.
.. [2] Nedelec, J.-C.: Acoustic and Electromagnetic Equations. Springer 2001, section 3.4: the hypersingular
   operator by surface curls.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from bounds import engineering
from dynamics.acoustics.air import Air, directions
from dynamics.acoustics.hull import Hull, LinearPanels
from dynamics.errors import InputError, SolveError
from dynamics.types import ComplexArray, FloatArray
from dynamics.work_cost import Cost
from host import MissingExtra
from model_studies.progress import Progress, Report, by_cost, silent, unreported
from model_studies.workers import InProcess, Workers, divided

MARGIN = 8
"""Spherical harmonics above the wavenumber times the radius, whose part of the far field is below 1e-6."""
MIDDLES = 0.5 * (np.ones((3, 3)) - np.eye(3))  # barycentric coordinates of the edges' middles
BLOCK = 512
"""Panels, at most, whose rows of the operators are a task."""
TESTED = "tested"
"""Name of the panels of a block in the library's mesh."""
EDGES = 2.6
"""Least number of the longest edges in a wavelength: gear cases are within 0.4 dB of six."""
RESIDUAL = 1e-8
"""Greatest relative residual of the dense solve."""
MOST_PANELS = 8000
"""So many take 7 GB at the peak."""
SECONDS, GROWTH = 1.40e-6, 2.24
"""CPU seconds of one panel, and the power of their number by which they grow.

Fitted to spheres of 500 to 2880 panels, within 1.2; 7040 panels of a box took 615 CPU s, this says 585. That
is more than the square of assembly: larger operators miss the cache more often.
"""
BYTES, LIBRARY = 110.0, 1e8
"""For the square of the number of panels (5.9 GB measured with 7040), and of NGSolve."""
SHARES = {"operators": 0.98, "pressure": 0.02}
"""Usual shares in the time."""
STAGE = "boundary elements"


def _far_field_resistance(
    hull: Hull, wavenumber: float, pressure: ComplexArray, slope: ComplexArray
) -> ComplexArray:
    """Return the integral over all directions of conj(p_i) p_j, (M, M), Pa^2 m^2, p r in the far field.

    Of the kernel e^{+ikr}: `pressure` (N, M) at the nodes, linear in between, `slope` (T, M) dp/dn of panels.
    """
    center = hull.areas @ hull.centers / hull.area
    radius = float(np.linalg.norm(hull.nodes - center, axis=1).max())
    vectors, weights = directions(int(np.ceil(wavenumber * radius)) + MARGIN)
    cosines = vectors @ hull.normals.T
    far = np.zeros((len(vectors), pressure.shape[1]), dtype=complex)
    for middle in MIDDLES:  # quadrature of second degree on every panel
        points = np.einsum("c,tcd->td", middle, hull.corners) - center
        at = np.einsum("c,tcm->tm", middle, pressure[hull.triangles])
        phase = np.exp(-1j * wavenumber * vectors @ points.T) * hull.areas / 3.0
        far += (-1j * wavenumber * cosines * phase) @ at - phase @ slope
    far /= 4.0 * np.pi
    return np.asarray((far.conj().T * weights) @ far)


# Layer operators of the Helmholtz equation by NGSolve: the one module that loads it.


def _layer_operators(
    hull: Hull,
    wavenumber: float,
    done: Report = unreported,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> tuple[ComplexArray, ComplexArray]:
    """Return the dense single layer (T, T) and double layer (T, N), tested with the panels, m^3 and m^2.

    Kernel e^{+ikr}/(4 pi r); the single layer acts on constants of the panels, the double layer on hats of
    the nodes. Singular pairs are integrated by the library's own transformations. `done` is called with the
    fraction of the panels that are done.
    """
    panels = len(hull.triangles)
    single = np.empty((panels, panels), dtype=complex)
    double = np.empty((panels, len(hull.nodes)), dtype=complex)
    ends = np.linspace(0, panels, -(-panels // BLOCK) + 1).astype(int).tolist()
    blocks = list(pairwise(ends))
    seconds = BoundaryElements().cost(panels, 0.0, 0).seconds
    rows = divided(workers, _layer_rows, (hull, wavenumber), blocks, seconds)
    for (first, end), own in zip(blocks, rows, strict=True):
        single[first:end], double[first:end] = own
        done(end / panels)
    return single, double


def _layer_rows(shared: tuple[Hull, float], block: tuple[int, int]) -> tuple[ComplexArray, ComplexArray]:
    """Return the rows of both operators that are tested with the panels of a block: one task."""
    try:
        import ngsolve  # noqa: PLC0415 (an extra)
        from ngsolve.bem import HelmholtzDL, HelmholtzSL  # noqa: PLC0415
    except ModuleNotFoundError:
        raise MissingExtra("ngsolve", "boundary-elements") from None
    (hull, wavenumber), ds = shared, ngsolve.ds
    mesh = _mesh(hull, block)
    hats = ngsolve.H1(mesh, order=1, complex=True, definedon=mesh.Boundaries(".*")).TrialFunction()
    constant = ngsolve.SurfaceL2(mesh, order=0, complex=True).TrialFunction()
    own = ngsolve.SurfaceL2(mesh, order=0, complex=True, definedon=mesh.Boundaries(TESTED)).TestFunction()
    single = HelmholtzSL(constant * ds, wavenumber, use_fmm=False) * own * ds(TESTED)
    double = HelmholtzDL(hats * ds, wavenumber, use_fmm=False) * own * ds(TESTED)
    return _dense(single.mat, block), _dense(double.mat, block)


def _mesh(hull: Hull, block: tuple[int, int]) -> Any:
    """Return the hull as a mesh of the library, nodes and panels in the same order."""
    import ngsolve  # noqa: PLC0415 (an extra)
    from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint, Pnt  # noqa: PLC0415

    mesh = Mesh(dim=3)
    for number, name in ((1, TESTED), (2, "other")):
        mesh.Add(FaceDescriptor(surfnr=number, domin=1, bc=number))
        mesh.SetBCName(number - 1, name)
    points = [mesh.Add(MeshPoint(Pnt(*(float(value) for value in node)))) for node in hull.nodes]
    for panel, triangle in enumerate(hull.triangles):
        number = 1 if block[0] <= panel < block[1] else 2
        mesh.Add(Element2D(number, [points[node] for node in triangle]))
    return ngsolve.Mesh(mesh)


def _dense(matrix: Any, block: tuple[int, int]) -> ComplexArray:
    """Return the rows of a block, which are all that there are."""
    rows, columns, values = (np.asarray(part) for part in matrix.COO())
    entries = np.zeros((block[1] - block[0], matrix.width), dtype=complex)
    entries[rows - block[0], columns] = values
    return entries


@dataclass(frozen=True)
class _SurfacePressure:
    """The solution of the exterior problem at one frequency."""

    pressure: ComplexArray
    """At the nodes, Pa, complex peak amplitudes of e^{+i omega t} for the shapes with amplitude 1. Shape (N,
    M).
    """
    resistance: ComplexArray
    """From the far field, kg/s. Shape (M, M)."""
    surface_resistance: ComplexArray
    """From pressure and velocity on the hull, Hermitian part; equal but for the discretization. Shape (M, M).
    """
    residual: float
    """Of the linear solve, relative."""

    def imbalance(self, amplitudes: ComplexArray) -> float:
        """Return the power into the air at the hull less that in the far field, relative to the latter."""
        surface, far = (
            float(np.real(np.conj(amplitudes) @ matrix @ amplitudes))
            for matrix in (self.surface_resistance, self.resistance)
        )
        return surface / far - 1.0


@dataclass(frozen=True)
class BoundaryElements:
    """The radiation model without neglect but for its mesh; needs the extra `boundary-elements`."""

    model_name: str = "boundary_elements"
    progress: Progress = field(default=silent, repr=False, compare=False)
    """Called as progress("boundary elements", fraction) while the operators of a frequency are assembled."""
    workers: Workers = field(default=InProcess(), repr=False, compare=False)
    """Who assembles them, some panels each."""

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return the resistance in the far field; see `surface_pressure` for what it raises."""
        return surface_pressure(hull, frequency, shapes, air, self.progress, self.workers).resistance

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost: assembly of the dense operators."""
        del ka, shapes
        return Cost(SECONDS * panels**GROWTH, LIBRARY + BYTES * float(panels) ** 2)

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return what the mesh is off: 1 % on spheres and boxes, 0.3 dB by the rounding of a coarse hull."""
        del ka
        return -0.3, 0.3


def surface_pressure(
    hull: Hull,
    frequency: float,
    shapes: ComplexArray,
    air: Air,
    progress: Progress = silent,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> _SurfacePressure:
    """Solve for the pressure on a hull that vibrates in `shapes` (T, M) at a frequency, Hz.

    Memory grows with the square of the number of panels, time somewhat faster (`BoundaryElements.cost`).
    `progress` is called as progress("boundary elements", fraction); `workers` assemble the operators.

    Raises
    ------
    InputError
        The hull is open, has more than `MOST_PANELS` panels, or does not resolve the wavelength.
    MissingExtra
        NGSolve is not installed.
    SolveError
        The linear solve leaves a residual above `RESIDUAL`.
    """
    wavenumber = 2.0 * np.pi * frequency / air.sound_speed
    hull.require_closed()
    hull.require_resolved(wavenumber, air.sound_speed, EDGES)
    if len(hull.triangles) > MOST_PANELS:
        raise InputError("triangles", len(hull.triangles), f"at most {MOST_PANELS}", "Coarsen the hull.")
    panels = LinearPanels(hull)
    slope = 1j * wavenumber * air.impedance * shapes.conj()  # dp/dn of e^{-i omega t}, as the kernel has it
    parts = by_cost(lambda fraction: progress(STAGE, fraction), SHARES)
    operators = _layer_operators(hull, wavenumber, lambda done: parts("operators", done), workers)
    pressure, residual = _solve(hull, panels, wavenumber, slope, operators)
    parts("pressure", 1.0)
    if not residual <= RESIDUAL:
        left = engineering(residual, 2)
        raise SolveError(f"boundary elements: the relative residual {left} is above {RESIDUAL:g}")
    far = _far_field_resistance(hull, wavenumber, pressure, slope) / air.impedance
    surface = shapes.T @ (hull.areas[:, None] * np.asarray(panels.mean @ pressure))
    return _SurfacePressure(pressure.conj(), far.conj(), 0.5 * (surface.conj() + surface.T), residual)


def _solve(
    hull: Hull,
    panels: LinearPanels,
    wavenumber: float,
    slope: ComplexArray,
    operators: tuple[ComplexArray, ComplexArray],
) -> tuple[ComplexArray, float]:
    """Return the pressure (N, M) for its normal derivative `slope` (T, M), and the residual."""
    single, double = operators
    # of the derived equation: i/k above the first irregular frequency, near ka = pi; it vanishes with k,
    # where the plain equation is well conditioned and the derived one is not
    radius = hull.equivalent_radius
    coupling = 1j * wavenumber * radius**2 / (1.0 + (wavenumber * radius) ** 2)
    matrix = 0.5 * panels.mass.toarray() - np.asarray(panels.mean.T @ double)
    matrix = matrix + coupling * panels.hypersingular(single, wavenumber)
    right = np.asarray(panels.mean.T @ (single @ slope + 0.5 * coupling * hull.areas[:, None] * slope))
    right = -right - coupling * (double.T @ slope)
    pressure: ComplexArray = np.linalg.solve(matrix, right)
    scale = float(np.linalg.norm(right)) or 1.0
    return pressure, float(np.linalg.norm(matrix @ pressure - right)) / scale


def exterior_pressure(
    hull: Hull, frequency: float, shapes: ComplexArray, points: FloatArray, air: Air
) -> ComplexArray:
    """Return the sound pressure around a hull by boundary elements, its own scattering included.

    The Kirchhoff-Helmholtz integral of the pressure on the hull and its normal derivative. Points lie
    outside, a few of the longest edges away. Raises `InputError`, `MissingExtra`, `SolveError` as
    `surface_pressure` does.

    Parameters
    ----------
    shapes : (T, M) array
        Normal velocities of the panels, > 0 outwards.
    points : (P, 3) array
        m.

    Returns
    -------
    (P, M) complex array
        Pa per m/s, peak amplitudes of e^{+i omega t}.
    """
    wavenumber = 2.0 * np.pi * frequency / air.sound_speed
    pressure = surface_pressure(hull, frequency, shapes, air).pressure
    slope = -1j * wavenumber * air.impedance * shapes
    found = np.zeros((len(points), shapes.shape[1]), dtype=complex)
    for middle in MIDDLES:  # quadrature of second degree on every panel
        away = np.asarray(points)[:, None] - np.einsum("c,tcd->td", middle, hull.corners)
        distance = np.linalg.norm(away, axis=2)
        kernel = np.exp(-1j * wavenumber * distance) / (4.0 * np.pi * distance) * hull.areas / 3.0
        cosine = np.einsum("ptd,td->pt", away, hull.normals) / distance
        at = np.einsum("c,tcm->tm", middle, pressure[hull.triangles])
        found += (kernel * (1j * wavenumber + 1.0 / distance) * cosine) @ at - kernel @ slope
    return found
