"""Boundary elements on a closed hull: the sound of its vibration in free space, scattering included.

Burton and Miller's combination of the boundary integral equation and its normal derivative has no irregular
frequencies [1]_. Pressure is linear on the panels, normal velocity constant; the dense operators come from
NGSolve (`layer_operators`). The radiated power is that of the far field, a sum of squares: the product of
pressure and velocity on the surface is a small difference of large numbers at low frequency. Sizes: N nodes
and T panels of the hull, M shapes of vibration, which are normal velocities of the panels. Inside, the time
factor is e^{-i omega t}, as in the kernel e^{+ikr}; results are for e^{+i omega t}, hence the conjugates.

References
----------
.. [1] Burton, A. J.; Miller, G. F.: The application of integral equation methods to the numerical solution of
   some exterior boundary-value problems. Proc. R. Soc. Lond. A 323 (1971), 201-210.
.. [2] Nedelec, J.-C.: Acoustic and Electromagnetic Equations. Springer 2001, section 3.4: the hypersingular
   operator by surface curls.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bounds import engineering
from dynamics.acoustics.air import Air, directions
from dynamics.acoustics.hull import Hull, LinearPanels
from dynamics.acoustics.layer_operators import layer_operators, operators_cost
from dynamics.errors import InputError, SolveError
from dynamics.types import ComplexArray, FloatArray
from dynamics.work_cost import Cost
from model_studies.progress import Progress, by_cost, silent
from model_studies.workers import InProcess, Workers

MARGIN = 8
"""Orders of spherical harmonics, in the directions of the far field, above the wavenumber times the radius of
the hull. Higher orders are less than 1e-6 of the far field.
"""
MIDDLES = 0.5 * (np.ones((3, 3)) - np.eye(3))  # barycentric coordinates of the edges' middles
EDGES = 2.6
"""Least length of a sound wave over the longest edge of the hull: with it gear cases are within 0.4 dB of
their result with six edges."""
RESIDUAL = 1e-8
"""Greatest relative residual of the dense solve."""
MAX_PANELS = 8000
"""Most panels of a hull: 8000 take 7 GB at the peak."""
SHARES = {"operators": 0.98, "pressure": 0.02}
"""Usual shares of the stages in the time of a frequency, for progress."""
STAGE = "boundary elements"


def _far_field_resistance(
    hull: Hull, wavenumber: float, pressure: ComplexArray, slope: ComplexArray
) -> ComplexArray:
    """Return the integral over all directions of conj(P_i) P_j, (M, M) in Pa^2 m^2.

    P_j is the pressure of shape j in the far field times the distance. `pressure` (N, M) is that at the
    nodes, linear in between; `slope` (T, M) is dp/dn of the panels.
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


@dataclass(frozen=True)
class _SurfacePressure:
    """The solution of the exterior problem at one frequency."""

    pressure: ComplexArray
    """Pressure at the nodes for the shapes with amplitude 1, Pa: complex peak amplitudes of e^{+i omega t}.
    Shape (N, M).
    """
    resistance: ComplexArray
    """Resistance by the power in the far field, kg/s. Shape (M, M)."""
    surface_resistance: ComplexArray
    """Resistance by pressure and velocity on the hull, Hermitian part, kg/s: equal to `resistance` but for
    the discretization. Shape (M, M).
    """
    residual: float
    """Relative residual of the linear solve."""

    def imbalance(self, amplitudes: ComplexArray) -> float:
        """Return the power into the air at the hull less that in the far field, relative to the latter."""
        surface, far = (
            float(np.real(np.conj(amplitudes) @ matrix @ amplitudes))
            for matrix in (self.surface_resistance, self.resistance)
        )
        return surface / far - 1.0


@dataclass(frozen=True)
class BoundaryElements:
    """The radiation model that neglects nothing but the error of its mesh; needs `boundary-elements`."""

    model_name: str = "boundary_elements"
    progress: Progress = field(default=silent, repr=False, compare=False)
    """Called as progress("boundary elements", fraction) while the operators of a frequency are assembled."""
    workers: Workers = field(default=InProcess(), repr=False, compare=False)
    """Executor that assembles the operators, in parts by panels."""

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return the resistance in the far field; see `surface_pressure` for what it raises."""
        return surface_pressure(hull, frequency, shapes, air, self.progress, self.workers).resistance

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost: assembly of the dense operators."""
        del ka, shapes
        return operators_cost(panels)

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return the error bounds of the mesh: 1 % on spheres and boxes, 0.3 dB by a coarse hull."""
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
        The hull is open, has more than `MAX_PANELS` panels, or does not resolve the wavelength.
    MissingExtra
        NGSolve is not installed.
    SolveError
        The linear solve leaves a residual above `RESIDUAL`.
    """
    wavenumber = 2.0 * np.pi * frequency / air.sound_speed
    hull.require_closed()
    hull.require_resolved(wavenumber, air.sound_speed, EDGES)
    if len(hull.triangles) > MAX_PANELS:
        raise InputError("triangles", len(hull.triangles), f"at most {MAX_PANELS}", "Coarsen the hull.")
    panels = LinearPanels(hull)
    slope = 1j * wavenumber * air.impedance * shapes.conj()  # dp/dn of e^{-i omega t}, as the kernel has it
    parts = by_cost(lambda fraction: progress(STAGE, fraction), SHARES)
    operators = layer_operators(hull, wavenumber, lambda done: parts("operators", done), workers)
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
    # weight of the derived equation: i/k above the first irregular frequency, near ka = pi. At low k it goes
    # to 0: there the plain equation is well conditioned, and the derived one is not.
    radius = hull.equivalent_radius
    coupling = 1j * wavenumber * radius**2 / (1.0 + (wavenumber * radius) ** 2)
    matrix = 0.5 * panels.mass.toarray() - np.asarray(panels.mean.T @ double)
    matrix = matrix + coupling * panels.hypersingular(single, wavenumber)
    right = np.asarray(panels.mean.T @ (single @ slope + 0.5 * coupling * hull.areas[:, None] * slope))
    right = -right - coupling * (double.T @ slope)
    pressure: ComplexArray = np.linalg.solve(matrix, right)
    scale = float(np.linalg.norm(right)) or 1.0  # a hull at rest
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
        Positions of the points, m.

    Returns
    -------
    (P, M) complex array
        Pressure of each shape at the points, Pa: peak amplitudes of e^{+i omega t}.
    """
    wavenumber = 2.0 * np.pi * frequency / air.sound_speed
    pressure = surface_pressure(hull, frequency, shapes, air).pressure
    slope = -1j * wavenumber * air.impedance * shapes
    exterior = np.zeros((len(points), shapes.shape[1]), dtype=complex)
    for middle in MIDDLES:  # quadrature of second degree on every panel
        away = np.asarray(points)[:, None] - np.einsum("c,tcd->td", middle, hull.corners)
        distance = np.linalg.norm(away, axis=2)
        kernel = np.exp(-1j * wavenumber * distance) / (4.0 * np.pi * distance) * hull.areas / 3.0
        cosine = np.einsum("ptd,td->pt", away, hull.normals) / distance
        at = np.einsum("c,tcm->tm", middle, pressure[hull.triangles])
        exterior += (kernel * (1j * wavenumber + 1.0 / distance) * cosine) @ at - kernel @ slope
    return exterior
