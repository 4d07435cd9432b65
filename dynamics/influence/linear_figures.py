"""Figures of a run by linear theory: mean, peak-to-peak and orders of transmission error, bearing forces.

A mesh order is a multiple of the frequency of the first mesh that turns. Linear theory keeps all flanks
pressed; the figures state where they would part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.influence.level_change import BearingForces, Lines, loudest_lines
from dynamics.influence.operating_conditions import FEWER, OperatingCondition
from dynamics.linearize.harmonic_response import HarmonicResponse, extremes
from dynamics.linearize.load_harmonics import load_multiples
from dynamics.linearize.natural_modes import natural_modes
from dynamics.linearize.operating_speeds import mesh_frequencies
from dynamics.linearize.parametric_response import parametric_response
from dynamics.linearize.steady_vibration import Excited, excited
from dynamics.mechanism.additions import SPEED_DEPENDENCE
from dynamics.types import ComplexArray, FloatArray

COMPARED = 5
"""Mesh orders of bearing forces that are compared, 1 to this."""
MODES, MET = 4, 3
"""Number of modes, and of mesh orders, at whose crossings the response of a run-up is computed."""
POSITIONS = 128
"""Positions in a base pitch at which tables are read."""
ON_ORDER = 1e-9
"""Largest difference of a computed order from a whole one, which is rounding."""


@dataclass(frozen=True)
class LinearFigures:
    """Figures that a run is expected to show; m meshes, b bearings."""

    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Mean and peak-to-peak of the dynamic transmission error, over all speeds and
    loads together, m. Shape (m,) each.
    """
    orders: FloatArray
    """Largest amplitudes of the mesh orders 1 to 5 of the dynamic transmission error, m. Shape (m, 5)."""
    bearing_orders: FloatArray
    """Largest amplitudes of the mesh orders 1 to 5 of the bearing forces, root of the sum of squares of the
    directions, N. Shape (b, 5).
    """
    bearing_loads: FloatArray
    """Largest amplitudes by loads at orders other than 1 to 5, root of the sum of squares, N. Shape (b,)."""
    parted: FloatArray
    """Largest tensile displacement of a linear mesh, where real flanks part, m; 0 if all stay in contact.
    Shape (m,).
    """
    freedoms: int
    rows: int
    """`freedoms`, `rows`: Size of the system: freedoms, and local coordinates of its force elements."""
    coasting: bool
    """Whether the model has the coast flank of any mesh."""
    lines: Lines = field(default_factory=dict)
    """Squares, by order up to 10, of the quantity for which the scene is computed, as far as a run has them.
    """

    @property
    def bearing_force(self) -> FloatArray:
        """Force on each bearing in mesh orders 1 to 5 and by loads, root of the sum of squares, (b,) N."""
        return np.asarray(np.sqrt(np.sum(self.bearing_orders**2, axis=1) + self.bearing_loads**2))


def linear_figures(
    system: System, conditions: Sequence[OperatingCondition], varying: bool = True
) -> LinearFigures:
    """Return the figures of `system` over the operating conditions of its run.

    The stiffness varies with position if `varying`, else it is its mean.

    Raises
    ------
    InputError
        If the meshes have no common period.
    SolveError
        If there is no static equilibrium.
    """
    rotating = system.ledger.adds(SPEED_DEPENDENCE)
    meshes, bearings = len(system.scene.meshes), len(system.supports.name)
    mean, low, high = np.zeros(meshes), np.full(meshes, np.inf), np.full(meshes, -np.inf)
    amplitude, parted = np.zeros((bearings, 3, COMPARED)), np.zeros(meshes)
    orders, loads = np.zeros((meshes, COMPARED)), np.zeros(bearings)
    quantity, lines = system.scene.quantity or BearingForces(), dict[float, float]()
    for point in conditions:
        at = excited(system, point.time, point.orders, POSITIONS)
        condition = point.passing(_resonances(at)) if np.any(point.rate) else point
        motion = condition.speed, condition.rate, point.orders, rotating
        harmonics, shift = parametric_response(at, *motion, varying=varying)
        static = [float(np.mean(cycle.static_error)) for cycle in at.cycles]
        rest = np.array(static)[:, None] + shift
        minimum, maximum = extremes(harmonics.dynamic_transmission_error, harmonics.order)
        low = np.minimum(low, np.min(rest + minimum, axis=1))
        high = np.maximum(high, np.max(rest + maximum, axis=1))
        mean += rest @ condition.weight
        orders = np.maximum(orders, _low_orders(harmonics.dynamic_transmission_error, harmonics))
        amplitude = np.maximum(amplitude, _low_orders(harmonics.bearing_force[:, :3], harmonics))
        loads = np.maximum(loads, _by_loads(at, condition, harmonics))
        compared = harmonics.order <= FEWER
        lines = loudest_lines(harmonics.order[compared], quantity.squares(harmonics)[:, compared], lines)
        pull = np.maximum(-np.min(harmonics.least_mesh_force, axis=1), 0.0)
        # 1e-300: a mesh without load may have no stiffness
        parted = np.maximum(parted, pull / np.maximum(harmonics.mean_stiffness, 1e-300))
    return LinearFigures(
        mean=mean,
        peak_to_peak=high - low,
        orders=orders,
        bearing_orders=np.sqrt(np.sum(amplitude**2, axis=1)),
        bearing_loads=loads,
        parted=parted,
        freedoms=system.arrays.mass.shape[0],
        rows=system.arrays.direction.shape[0],
        coasting=bool(system.flanks.coast),
        lines=lines,
    )


def _resonances(at: Excited) -> FloatArray:
    """Return the speeds of the leading law at which low mesh orders or loads excite the main modes.

    The main modes have the largest phi^2/(2 zeta k): phi is the motion of a mode along a line of action, zeta
    its damping ratio, and k its stiffness, omega^2 for a modal mass of 1.
    """
    modes = natural_modes(at.linear)
    along = modes.shape @ at.system.arrays.direction[at.system.driving_rows].T
    stiffness = (2.0 * np.pi * modes.frequency) ** 2
    height = np.max(along**2, axis=1, initial=0.0) * np.where(stiffness > 0.0, 1.0, 0.0)
    height = height / np.maximum(2.0 * modes.damping_ratio * stiffness, 1e-300)
    reported = modes.frequency[np.argsort(-height)[:MODES]]
    per_speed = np.unique(mesh_frequencies(at.system, np.ones(1)).ravel())
    order = np.arange(1, MET + 1)[:, None] * per_speed[per_speed > 0.0]
    of_loads = load_multiples(at.system, at.period, 1.0, at.time) / at.period.duration(1.0)
    return np.unique(reported[:, None] / np.concatenate([order.ravel(), of_loads]))


def _by_loads(at: Excited, condition: OperatingCondition, response: HarmonicResponse) -> FloatArray:
    """Return the force on every bearing at orders that only loads excite, (b,) N."""
    multiples = load_multiples(at.system, at.period, float(condition.speed[-1]), at.time)
    counted = np.arange(1, COMPARED + 1) * at.period.counted
    load_lines = np.isin(np.rint(response.order * at.period.counted), np.setdiff1d(multiples, counted))
    largest = np.max(np.abs(response.bearing_force[:, :3, :, load_lines]), axis=2)
    return np.asarray(np.sqrt(np.sum(largest**2, axis=(1, 2))))


def _low_orders(amplitude: ComplexArray, response: HarmonicResponse) -> FloatArray:
    """Return the largest amplitudes (..., 5) over S speeds at mesh orders 1 to 5 of harmonics (..., S, H)."""
    largest = np.zeros((*amplitude.shape[:-2], COMPARED))
    for k in range(COMPARED):
        column = np.flatnonzero(np.abs(response.order - (k + 1)) < ON_ORDER)
        if column.size:
            largest[..., k] = np.max(np.abs(amplitude[..., column[0]]), axis=-1)
    return largest
