"""Sensitivities of the largest sound power level to the design: change in dB(A) per change of a figure.

A *figure* is a number of the design, such as a crowning, or the factor on a guess. A *guess* is an uncertain
input of the sound, such as a damping ratio; its factor is 1 as guessed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache, partial

from bounds.brief import brief
from dynamics.acoustics import OrderPower
from dynamics.assembly.assemble import assemble
from dynamics.checks import finite
from dynamics.errors import DynamicsError, InputError
from dynamics.linearize import flank_transfer
from dynamics.noise.sound_band import GUESSES, SoundModel, forced_power, largest_level
from dynamics.noise.transferred_quantities import SoundPower
from dynamics.scene import Scene
from dynamics.types import FloatArray
from model_studies.progress import Progress
from model_studies.variants import run_variants

STEPS = {"housing_frequency": 0.02}  # steps of the factors for which `STEP` is too large
STEP = 0.1
"""Step of the factor on a guess."""
CURVED = 0.25
"""Largest change by the curvature, over that by the slope, at which a level counts as linear."""


@dataclass(frozen=True)
class DesignFigure:
    """A figure of a design, and a small step of it."""

    name: str
    unit: str
    """Unit of value and step; empty for a factor."""
    value: float
    """Value of the design."""
    step: float
    """Step from that value, not zero."""

    def __post_init__(self) -> None:
        finite("value", self.value)
        if not (math.isfinite(self.step) and self.step != 0.0):
            raise InputError("step", self.step, "a number other than zero")


@brief
@dataclass(frozen=True)
class Sensitivity:
    """The change of a level with a figure, from two steps of it."""

    figure: DesignFigure
    change: float
    change_of_two: float
    """`change`, `change_of_two`: Change of the level with one step of the figure and with two, dB."""

    @classmethod
    def of(cls, figure: DesignFigure, level: Callable[[float], float]) -> Sensitivity:
        """Return the sensitivity of a level to a figure.

        `level` returns the level, dB, at a value of the figure with all else unchanged; it is called three
        times. It must be smooth in the value: `largest_level` is, but not a level at a fixed speed near a
        resonance.
        """
        nominal, single, double = (level(figure.value + count * figure.step) for count in range(3))
        return cls(figure, single - nominal, double - nominal)

    @property
    def slope(self) -> float:
        """Return the derivative of the level, dB per unit, by the parabola through all three levels."""
        return (4.0 * self.change - self.change_of_two) / (2.0 * self.figure.step)

    @property
    def curvature(self) -> float:
        """Return the second derivative, dB per unit squared."""
        return (self.change_of_two - 2.0 * self.change) / self.figure.step**2

    @property
    def linear_range(self) -> float:
        """Return the range in which the slope holds within `CURVED`, in units of the figure; inf: any."""
        bend = 0.5 * abs(self.curvature)
        return CURVED * abs(self.slope) / bend if bend > 0.0 else math.inf

    @property
    def for_one_db_less(self) -> float:
        """Return the change of the figure that lowers the level by 1 dB at this slope; inf: slope zero."""
        return -1.0 / self.slope if self.slope != 0.0 else math.inf

    @property
    def linear(self) -> bool:
        """Whether the change by one step is within the linear range."""
        return abs(self.for_one_db_less) <= self.linear_range


def _ranked_sensitivities(rows: Iterable[Sensitivity]) -> tuple[Sensitivity, ...]:
    """Return sensitivities by the change of a step, the largest first."""
    return tuple(sorted(rows, key=lambda row: -abs(row.change)))


def _response_level(model: SoundModel, speed: FloatArray, orders: int) -> float:
    return largest_level(speed, forced_power(model, speed, orders)[1])


def _flank_levels(model: SoundModel, speed: FloatArray, orders: int) -> Callable[[Scene], float]:
    """Return the function from a scene with other flanks to its largest level.

    It uses the transfer functions of the model's scene, with the excitation, stiffness and bearing forces by
    the tables of the other flanks. A scene with other freedoms, because its flanks call for another effect,
    gets a full response.
    """
    transfer = flank_transfer(assemble(model.scene), speed, orders)
    form = SoundPower().form(transfer, model)

    def level(scene: Scene) -> float:
        try:
            inputs = transfer.inputs(transfer.excitation(assemble(scene)))
        except InputError:
            return _response_level(replace(model, scene=scene), speed, orders)
        return largest_level(speed, OrderPower(transfer.frequency.T, form.of(inputs).T))

    return level


def sound_sensitivities(
    model: SoundModel,
    speed: FloatArray,
    orders: int,
    flanks: Iterable[DesignFigure],
    scenes: Callable[[DesignFigure], Callable[[float], Scene]],
    progress: Progress,
) -> tuple[tuple[Sensitivity, ...], dict[str, str]]:
    """Return the sensitivities to the guesses of a model and to figures of its flanks, the largest first.

    Parameters
    ----------
    model, speed, orders
        Arguments of `forced_power`; the level is the `largest_level`.
    scenes : callable
        Function of a figure of the flanks that returns a function from its value to the scene. The level of
        such a scene is computed by `flank_transfer`.
    progress : callable
        Called as progress("sensitivities", fraction).

    Returns
    -------
    sensitivities : tuple of Sensitivity
    left_out : dict of str to str
        Name of a figure to the reason why it has none.
    """
    level_of = cache(partial(_flank_levels, model, speed, orders))

    def level(figure: DesignFigure) -> Callable[[float], float]:
        if figure.name not in GUESSES:
            scene_at, level_at = scenes(figure), level_of()
            return lambda value: level_at(scene_at(value))
        change = GUESSES[figure.name].varied
        return lambda value: _response_level(change(model, value) if value != 1.0 else model, speed, orders)

    def compute(figure: DesignFigure) -> Sensitivity:
        return Sensitivity.of(figure, level(figure))

    # guesses that the model has: a factor changes it
    known = [name for name, guess in GUESSES.items() if guess.varied(model, 2.0) is not model]
    figures = (DesignFigure(name, "", 1.0, STEPS.get(name, STEP)) for name in known)
    by_name = {figure.name: figure for figure in (*figures, *flanks)}
    rows, omitted = run_variants("sensitivities", by_name, compute, (DynamicsError,), progress)
    return _ranked_sensitivities(rows.values()), omitted
