"""Sidebands: lines beside the mesh orders, where something once per revolution modulates the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.position_grid import resample_to_position
from dynamics.orders.spectrum import spectrum
from dynamics.orders.valid_orders import checked_order
from dynamics.results import RunResult
from dynamics.types import FloatArray

ORDERS = 3
"""Mesh orders with sidebands where no number is given, as far as the output holds them."""
REVOLUTIONS = 4
"""Least length in periods of the modulation: under a Hann window a line reaches one line to either side."""


@dataclass(frozen=True)
class Sideband:
    """One line beside a mesh order.

    Attributes
    ----------
    source : str
        What modulates: the name of a gear, or that given.
    mesh_order, number : int
        Beside which multiple of the mesh frequency, and the how manieth: < 0 below, 0 the mesh order itself.
    order : float
        mesh_order + number * spacing, multiples of the mesh frequency.
    amplitude : float
        Peak amplitude, in the unit of the signal.
    """

    source: str
    mesh_order: int
    number: int
    order: float
    amplitude: float


def sidebands(
    result: RunResult,
    values: FloatArray,
    orders: int = 3,
    count: int = 3,
    mesh: int = 0,
    periods: Mapping[str, int] | None = None,
) -> tuple[Sideband, ...]:
    """Return `count` sidebands on either side of the first `orders` mesh orders of the signal `values` (T,).

    Parameters
    ----------
    periods : mapping of str to int, optional
        Names and periods of what may modulate, in base pitches; left out: both gears with their teeth. What
        a planet carrier modulates has the ring's teeth as its period.

    Raises
    ------
    InputError
        If the run is shorter than four periods, or its output does not hold the orders.
    """
    orders = checked_order(result, "orders", orders, mesh, ORDERS)
    integer("count", count, 0, 1000)
    if np.ndim(values) != 1:
        raise InputError("values", np.shape(values), "one signal, (T,)", "Pick one bearing and direction.")
    per_pitch = max(64, 8 * (orders + 1))
    grid, _, signal = resample_to_position(result, values, per_pitch, mesh)
    bands: list[Sideband] = []
    for source, period in (periods or _gear_periods(result, mesh)).items():
        turns = grid.size // (period * per_pitch)
        if turns < REVOLUTIONS:
            bound = f"at least {REVOLUTIONS * period} base pitches for sidebands of {source}"
            raise InputError("result", f"{grid.size // per_pitch} base pitches", bound, "Run for longer.")
        lines = spectrum(signal[-turns * period * per_pitch :], float(per_pitch)).amplitude
        for order in range(1, orders + 1):
            for number in range(-count, count + 1):
                line = (order * period + number) * turns
                at = order + number / period
                if line > 0:
                    bands.append(Sideband(source, order, number, at, float(lines[line])))
    return tuple(bands)


def _gear_periods(result: RunResult, mesh: int = 0) -> dict[str, int]:
    """Return the tooth numbers of both gears of a mesh by name: their revolutions in base pitches."""
    teeth = {gear["name"]: int(gear["teeth"]) for gear in result.case["gears"]}
    pair = result.case["meshes"][mesh]
    return {name: teeth[name] for name in (pair["driver"], pair["driven"])}
