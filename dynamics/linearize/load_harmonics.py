"""Harmonics of the loads over a common period at constant speed.

In the common period all meshes and loads return to the same phase. The leading law is the first drive or free
rotation that turns; speeds are those of it. A multiple is a frequency over that of the common period.

Shapes: S speeds, H harmonics, n freedoms.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.laws import Law, among
from dynamics.linearize.common_period import CommonPeriod
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.loads.load_course import BySpeed, Orders
from dynamics.loads.time_law import TimeLaw
from dynamics.mechanism.phases import load_orders, repeating_phases
from dynamics.types import ComplexArray, FloatArray, IntArray

Waves = dict[Fraction, ComplexArray]
"""Amplitudes (S,) of exp(2 pi i h t / period) by the multiple h, of both signs."""
ALONG: Waves = {Fraction(0): np.ones(1, dtype=complex)}
"""The constant 1: the direction of a force that does not turn."""
LARGEST_DENOMINATOR = 10_000
"""Largest denominator of speeds of laws over that of the leading law, which are read as fractions."""
ROUNDING = 1e-9
"""Relative rounding of a highest multiple."""


def load_harmonics(
    system: System, period: CommonPeriod, speed: FloatArray, harmonics: IntArray, time: float
) -> ComplexArray:
    """Return the forces of loads and unbalances on the freedoms at `speed` (S,), (S, H, n), N and N m.

    A system without loads has zeros of shape (1, H, n). Forces are complex peak amplitudes of the multiples
    `harmonics` (H,) of the common period's frequency; loads by time have their values at `time` (s). An
    unbalance acts by its centrifugal force and its weight.
    """
    elements, direction = system.arrays.elements, system.arrays.direction
    loads = np.flatnonzero(among(elements.law, (Law.APPLIED_FORCE, Law.UNBALANCE)))
    speeds = speed.size if loads.size else 1
    force = np.zeros((speeds, harmonics.size, direction.shape[1]), dtype=complex)
    column_of = {int(harmonic): column for column, harmonic in enumerate(harmonics)}
    course = _Course(system, period, np.abs(speed), time)
    for e in loads:
        entry, first = int(elements.entry[e]), int(elements.first[e])
        applied = elements.law[e] == Law.APPLIED_FORCE
        rows = course.of_force(entry) if applied else course.of_unbalance(entry)
        for row, waves in enumerate(rows, start=first):
            for multiple, amplitude in waves.items():
                if multiple.denominator == 1 and int(multiple) in column_of:
                    # twice: the wave of the opposite multiple is the conjugate
                    force[:, column_of[int(multiple)]] += 2.0 * amplitude[:, None] * direction[row]
    return force


def load_multiples(system: System, period: CommonPeriod, speed: float, time: float) -> IntArray:
    """Return the multiples of the common period's frequency at which loads excite at `speed`, rising."""
    multiples = np.arange(1, load_cycles(system, period) + 1, dtype=np.int64)
    force = load_harmonics(system, period, np.array([speed]), multiples, time)
    return multiples[np.any(force != 0.0, axis=(0, 2))]


class _Course:
    """Courses of the loads of a system at speeds (S,) of the leading law, rad/s."""

    def __init__(self, system: System, period: CommonPeriod, speed: FloatArray, time: float) -> None:
        self._system, self._time = system, time
        self._speed = speed
        part = [Fraction(float(p)).limit_denominator(LARGEST_DENOMINATOR) for p in period.proportion]
        # phases advance in the sense in which the leading law turns
        forward = 1 if system.scene.references[period.law].speed.extreme > 0.0 else -1
        self._multiple = [
            forward
            * period.revolutions
            * sum((r * p for r, p in zip(phase.rate, part, strict=True)), Fraction(0))
            for phase in repeating_phases(system.scene, system.kinematics)
        ]

    def of_force(self, entry: int) -> list[Waves]:
        """Return the force along each row of an applied force."""
        laws, scene = self._system.arrays.elements.laws.applied_force, self._system.scene
        course = scene.forces[entry].course
        factor: Waves = {Fraction(0): np.zeros(self._speed.size, dtype=complex)}
        if isinstance(course, TimeLaw):
            factor[Fraction(0)] += float(course(self._time))
        elif isinstance(course, BySpeed):
            factor[Fraction(0)] += course.curve(np.abs(self._shaft_speed(course.shaft)))
        else:
            factor = self._orders(course, self._multiple_of(int(laws.phase[entry])))
        size, frame = float(laws.size[entry]), int(laws.frame[entry])
        if frame < 0:  # the force does not turn with a shaft
            return [_product(factor, ALONG, size)]
        rows = [_product(factor, wave, size) for wave in _circle(self._multiple_of(frame), 0.0)]
        return [*rows, _product(factor, ALONG, size)][: int(laws.rows[entry])]

    def of_unbalance(self, entry: int) -> list[Waves]:
        """Return the force along each row of an unbalance."""
        laws, part = self._system.arrays.elements.laws.unbalance, self._system.scene.unbalances[entry]
        pull = np.array(part.amount * self._shaft_speed(part.shaft) ** 2, dtype=complex)
        cosine, sine = _circle(self._multiple_of(int(laws.phase[entry])), part.angle)
        arm = part.amount / float(laws.lever[entry])
        x, y = (arm * float(g) for g in laws.gravity)
        # the weight of the unbalance turns the shaft: its arm in the fixed frame times gravity
        still: Waves = {Fraction(0): np.ones(self._speed.size, dtype=complex)}
        weight = _product(still, _sum(_product(ALONG, cosine, y), _product(ALONG, sine, -x)), 1.0)
        return [*(_product({Fraction(0): pull}, wave, 1.0) for wave in (cosine, sine)), weight]

    def _orders(self, course: Orders, multiple: Fraction) -> Waves:
        """Return the factor of a load with orders of an angle, whose frequency is `multiple`."""
        ones = np.ones(self._speed.size, dtype=complex)
        waves: Waves = {Fraction(0): np.array(course.mean * ones, dtype=complex)}
        for order, amplitude, phase in zip(course.multiple, course.amplitude, course.phase, strict=True):
            phasor = np.array(0.5 * amplitude * np.exp(1j * phase) * ones, dtype=complex)
            waves = _sum(waves, _sum({order * multiple: phasor}, {-order * multiple: phasor.conj()}))
        return waves

    def _multiple_of(self, position: int) -> Fraction:
        """Return the multiple of a phase, by its position behind those of the meshes."""
        return self._multiple[position - len(self._system.scene.meshes)]

    def _shaft_speed(self, name: str) -> FloatArray:
        ratio = self._system.kinematics.float_ratio[self._system.scene.shaft_index(name)]
        return np.asarray(float(ratio @ law_speeds(self._system, 1.0)) * self._speed)


def _circle(multiple: Fraction, angle: float) -> tuple[Waves, Waves]:
    """Return cosine and sine of an angle that starts at `angle`, rad, and has the frequency `multiple`."""
    phasor = np.full(1, 0.5 * np.exp(1j * angle), dtype=complex)
    cosine = _sum({multiple: phasor}, {-multiple: phasor.conj()})
    return cosine, _sum({multiple: -1j * phasor}, {-multiple: 1j * phasor.conj()})


def _sum(first: Waves, second: Waves) -> Waves:
    keys = dict.fromkeys((*first, *second))
    return {key: np.asarray(first.get(key, 0.0) + second.get(key, 0.0), dtype=complex) for key in keys}


def _product(first: Waves, second: Waves, size: float) -> Waves:
    """Return `size` times the product of two series."""
    product: Waves = {}
    for f, a in first.items():
        for g, b in second.items():
            product = _sum(product, {f + g: np.asarray(size * a * b, dtype=complex)})
    return product


def load_cycles(system: System, period: CommonPeriod) -> int:
    """Return the highest multiple of the common period's frequency at which a load excites; 0 without one."""
    orders = load_orders(system.scene, system.kinematics) @ np.abs(period.proportion)
    return math.ceil(float(period.revolutions) * float(np.max(orders, initial=0.0)) * (1.0 - ROUNDING))
