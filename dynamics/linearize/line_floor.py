"""The floor of a long period: the lines that a response leaves out, in sum, by transfer functions.

Lines of different frequency add up in power. Over the frequency a unit force does the same at every speed, as
long as no frame turns: its transfer functions are solved once, on frequencies that are close where modes are.
Every power or mean square of a line is a Hermitian form of its forces, as with `FlankTransfer`; between the
frequencies the form is linear.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.linearize.natural_modes import natural_modes
from dynamics.linearize.steady_vibration import Excited, flank_forces
from dynamics.types import ComplexArray, FloatArray, IntArray

WIDEST = 0.01
"""Widest step between two frequencies, over the frequency, where no mode is near."""
MODE_STEP = 0.25
"""Widest step over the damping ratio of the nearest mode, or over the relative distance from it where that is
larger.
"""
LINE_ERROR = 1.0 / 7.0
"""Largest error of a straight line between two frequencies, over second derivative times square of the step:
1/8 for a parabola, more for other curves.
"""
MIN_RATIO = 1e-4  # damping ratio that stands for a smaller one
COUNTED = 1e-10
"""Least share of a direction of the rows in the power of all lines, from which the direction is an input."""
BINS = 8
"""Number of bins in a third octave, in which powers are returned."""


class FloorPower(NamedTuple):
    """Power or mean square of lines left out at S speeds in K bins of frequency."""

    frequency: FloatArray
    """Mean frequency of the lines with power in a bin, Hz. Shape (S, K)."""
    power: FloatArray
    missed: FloatArray
    """`power`, `missed`: Power or mean square, and its largest error in the same unit: by straight lines
    between the frequencies, and by a varying stiffness. Shape (S, K) each.
    """

    @classmethod
    def of_all(cls, parts: Sequence[FloorPower]) -> FloorPower:
        """Return the sum of several powers of the same lines."""
        power = np.sum([part.power for part in parts], axis=0)
        share = [part.power / np.maximum(power, 1e-300) for part in parts]
        mean = np.sum([part.frequency * ratio for part, ratio in zip(parts, share, strict=True)], axis=0)
        frequency = np.where(power > 0.0, mean, parts[0].frequency)
        return cls(frequency, power, np.sum([part.missed for part in parts], axis=0))


@dataclass(frozen=True)
class LineFloor:
    """Transfer functions at G frequencies of e inputs, and the inputs in L lines at S speeds."""

    bearing: tuple[str, ...]
    pace: FloatArray
    """Frequency of the common period at the speeds, Hz. Shape (S,)."""
    harmonic: IntArray
    """Multiples of that frequency at which the lines are. Shape (L,)."""
    inputs: ComplexArray
    """Inputs in the lines, complex peak amplitudes. Shape (e, L)."""
    frequency: FloatArray
    """Frequencies of the transfer functions, Hz, rising. They cover the lines at all speeds. Shape (G,)."""
    bearing_force: ComplexArray
    """Forces of bearings per input. Shape (b, 3 or 6, G, e)."""
    changed: FloatArray
    """Relative change of the mean squares of forces that a varying stiffness may make. Shape (b, S)."""

    def power(self, matrix: ComplexArray, changed: FloatArray | None = None) -> FloorPower:
        """Return a power or mean square of all lines: y^H M y of their inputs y, by `matrix` M (G, e, e).

        `changed` (S,) is its relative change by a varying stiffness; None: the change of the worst bearing.
        """
        changed = np.max(self.changed, axis=0, initial=0.0) if changed is None else changed
        form, products = _real_terms(matrix), _products(self.inputs)
        sizes = np.abs(products)
        error_form = [_largest_nearby(np.abs(term)) for term in _real_terms(self._line_error(matrix))]
        first, last = self._bin(self.frequency[[0, -1]])
        bins = int(last - first) + 1
        moment, power, error = np.zeros((3, self.pace.size, bins))  # moment: power times frequency
        for row, pace in enumerate(self.pace):
            hertz = self.harmonic * pace
            line_power = np.maximum(self._along(hertz, products, form), 0.0)
            line_error = self._along(hertz, sizes, error_form) + changed[row] * line_power
            index = self._bin(hertz) - first
            moment[row] = np.bincount(index, line_power * hertz, bins)
            power[row] = np.bincount(index, line_power, bins)
            error[row] = np.bincount(index, line_error, bins)
        middle = 10.0 ** (((np.arange(first, last + 1) + 0.5) / BINS - 0.5) / 10.0)
        mean = np.divide(moment, power, out=np.tile(middle, (self.pace.size, 1)), where=power > 0.0)
        return FloorPower(mean, power, error)

    def of_bearing(self, index: int) -> FloorPower:
        """Return the mean square of the force on a bearing, all directions together, N^2."""
        force = np.moveaxis(self.bearing_force[index, :3], 0, 2)
        return self.power(0.5 * force.conj() @ np.swapaxes(force, 1, 2), self.changed[index])

    def of_bearings(self) -> tuple[FloatArray, FloatArray]:
        """Return the mean squares of the forces on bearings, (b, S) N^2, and their errors."""
        squares = [self.of_bearing(index) for index in range(len(self.bearing))]
        shape = len(squares), self.pace.size
        power = np.reshape([np.sum(square.power, axis=1) for square in squares], shape)
        return power, np.reshape([np.sum(square.missed, axis=1) for square in squares], shape)

    def _along(self, hertz: FloatArray, products: Iterable[FloatArray], form: list[FloatArray]) -> FloatArray:
        terms = zip(products, form, strict=True)
        return np.asarray(sum(column * np.interp(hertz, self.frequency, term) for column, term in terms))

    @staticmethod
    def _bin(hertz: FloatArray) -> IntArray:
        """Return bins of frequencies; the edges of third octaves are among theirs."""
        return np.floor((10.0 * np.log10(hertz) + 0.5) * BINS).astype(np.int64)

    def _line_error(self, matrix: ComplexArray) -> ComplexArray:
        """Return the error of a straight line midway between two frequencies, for forms (G, e, e)."""
        step = np.diff(self.frequency)[:, None, None]
        bend = 2.0 * np.diff(np.diff(matrix, axis=0) / step, axis=0) / (step[1:] + step[:-1])
        curvature_error = np.square(np.maximum(step[1:], step[:-1])) * bend * LINE_ERROR
        return np.concatenate([curvature_error[:1], curvature_error, curvature_error[-1:]])


def _largest_nearby(size: FloatArray) -> FloatArray:
    """Return the largest of each size (G,) and its neighbors, since the curvature at an inflection is 0."""
    wide = np.pad(size, 1, mode="edge")
    return np.maximum(np.maximum(wide[:-2], wide[2:]), size)


def _real_terms(matrix: ComplexArray) -> list[FloatArray]:
    """Return the terms (G,) of Hermitian forms that `_products` multiply, diagonals first."""
    axis = range(matrix.shape[1])
    mixed = [matrix[:, a, b] for a in axis for b in axis[a + 1 :]]
    return [matrix[:, a, a].real for a in axis] + [part for term in mixed for part in (term.real, term.imag)]


def _products(inputs: ComplexArray) -> list[FloatArray]:
    """Return the products (L,) of inputs that the terms of a form multiply, squares first."""
    single = range(len(inputs))
    squares = [np.square(np.abs(term)) for term in inputs]
    mixed = [2.0 * inputs[a].conj() * inputs[b] for a in single for b in single[a + 1 :]]
    return squares + [part for term in mixed for part in (term.real, -term.imag)]


class FloorInputs(NamedTuple):
    """Directions in which lines excite the rows of the flanks, with their amplitudes."""

    row: FloatArray
    """Generalized forces per input. Shape (e, n)."""
    size: ComplexArray
    """Complex peak amplitudes. Shape (e, L)."""


def floor_inputs(at: Excited, omitted: IntArray) -> FloorInputs:
    """Return the excitation in lines (L,), in as few directions as hold its power."""
    _, force = flank_forces(at, omitted)
    size = np.max(np.abs(force), axis=1, keepdims=True)
    rows = np.flatnonzero(size)
    scaled = force[rows] / size[rows]
    parts = np.concatenate([scaled.real, scaled.imag], axis=1)
    direction, strength = np.linalg.svd(parts, full_matrices=False)[:2]
    direction = direction[:, np.square(strength) > COUNTED * np.sum(np.square(strength))]
    return FloorInputs((direction * size[rows]).T @ at.system.arrays.direction[rows], direction.T @ scaled)


def floor_frequencies(at: Excited, lowest: float, highest: float) -> FloatArray:
    """Return frequencies (G,) from `lowest` to `highest`, Hz, that resolve every mode of the system."""
    modes = natural_modes(at.linear)
    elastic = modes.frequency > 0.0
    natural, ratio = modes.frequency[elastic], np.maximum(modes.damping_ratio[elastic], MIN_RATIO)
    hertz = [lowest]
    while hertz[-1] < highest:
        near = MODE_STEP * np.maximum(ratio, np.abs(hertz[-1] / natural - 1.0))
        hertz.append(hertz[-1] * (1.0 + min(WIDEST, float(np.min(near, initial=WIDEST)))))
    return np.array([*hertz[:-1], highest])
