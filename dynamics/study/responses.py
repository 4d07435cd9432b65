"""Responses of a run by name: the figures that a study takes of each run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from dynamics.checks import integer, one_of, within
from dynamics.errors import InputError
from dynamics.orders.resampling import checked_order
from dynamics.results import RunResult
from dynamics.results.mesh_figures import ContactState, planet_load_sharing
from dynamics.results.order_fit import order_amplitudes, unwrapped
from dynamics.types import FloatArray

SOURCES = ("time_step", "table_interpolation")
"""Sources of a run's error, as its receipt states them."""


@dataclass(frozen=True)
class _Window:
    """A run from a time on."""

    run: RunResult
    part: slice
    """Samples of the run from that time on."""
    highest_order: int
    """Highest order that is fitted; all orders are fitted together."""
    bearings: tuple[int, ...]
    """Bearings whose forces are fitted."""
    mesh: int = 0
    """Mesh by which the orders count."""
    _fits: dict[int, tuple[FloatArray, dict[int, FloatArray]]] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, run: RunResult, start: float, highest_order: int, bearings: tuple[int, ...]) -> _Window:
        """Take a run from `start` (s) on.

        Raises `InputError`: the run ends before, or its output does not hold the order.
        """
        end = float(run.time[-1])
        return cls(run, run.window(within("start", start, 0.0, end), end), highest_order, bearings)

    def along(self, mesh: int) -> _Window:
        """Return the same with the orders of a mesh."""
        return replace(self, mesh=mesh)

    def transmission_error(self, mesh: int) -> FloatArray:
        """Return the dynamic transmission error (T,), m."""
        return self.run.dynamic_transmission_error[mesh, self.part]

    @property
    def orders(self) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Amplitudes of the transmission error (H,) in m, and of the force of each bearing (3, H) in N.

        All orders come from one fit, up to the highest order H.
        """
        if self.mesh not in self._fits:
            checked_order(self.run, "order", self.highest_order, self.mesh)
            position = unwrapped(self.run.position[self.mesh, self.part])
            forces = (self.run.bearing_force[bearing, :, self.part] for bearing in self.bearings)
            signals = np.vstack([self.transmission_error(self.mesh)[None], *forces])
            error, *force = order_amplitudes(position, signals, self.highest_order)
            by_bearing = np.reshape(force, (-1, 3, self.highest_order))
            self._fits[self.mesh] = error, dict(zip(self.bearings, by_bearing, strict=True))
        return self._fits[self.mesh]

    def error(self, name: str, order: int = 0) -> float:
        """Return the sum of the errors by source that the receipt states under a name; NaN without any."""
        known = []
        for source in SOURCES:
            error = self.run.receipt["error"].get(source, {}).get(name)
            if order and error is not None:  # errors by order, from 1
                error = error[order - 1] if order <= len(error) else None
            if error is not None:
                known.append(float(error))
        return float(np.sum(known)) if known else float("nan")


class _Value(NamedTuple):
    """The value of a response in SI, and its error where the run states one, else NaN."""

    value: float
    error: float = float("nan")


@dataclass(frozen=True)
class _Quantity:
    """A quantity that a response may be."""

    title: str
    unit: str
    """SI unit; empty for a ratio."""
    of: str
    """Kind of part that has the quantity; empty: the whole run."""
    take: Callable[[_Window, int, int], _Value]
    """``take(window, row, order)`` returns the value."""
    by_order: bool = False
    """Whether the quantity is an amplitude at a multiple of the mesh frequency."""


@dataclass(frozen=True)
class Response:
    """A named response."""

    quantity: str
    """A name of `QUANTITIES`."""
    part: str = ""
    """Name of its mesh or bearing; empty: the largest of all."""
    order: int = 0
    """Multiple of the mesh frequency, for amplitudes by order; else 0."""
    mesh: str = ""
    """Whose frequency the orders of a bearing are of; empty: the first mesh."""

    def __post_init__(self) -> None:
        one_of("quantity", self.quantity, QUANTITIES)
        if self.kind.by_order:
            integer("order", self.order, 1, 1000)
        elif self.order:
            raise InputError("order", self.order, f"left out: {self.quantity} has no order")
        if self.part and not self.kind.of:
            raise InputError("part", self.part, f"left out: {self.quantity} is of the whole run")
        if self.mesh and self.kind.of != "bearing":
            bound = f"left out: the orders of {self.quantity} are of its own mesh"
            raise InputError("mesh", self.mesh, bound)

    @property
    def kind(self) -> _Quantity:
        """Quantity of the response."""
        return QUANTITIES[self.quantity]

    @property
    def title(self) -> str:
        """Name in words, without the unit."""
        order = f", order {self.order}" if self.order else ""
        return f"{self.kind.title}{f' of {self.part}' if self.part else ''}{order}"

    def rows(self, run: RunResult) -> tuple[int, ...]:
        """Return the meshes or bearings of a run that have the response; the whole run is one row."""
        names = {"mesh": run.mesh, "bearing": run.bearing, "": ("",)}[self.kind.of]
        if not names:
            raise InputError("outputs.bearing_forces", False, "true", "The responses of bearings need them.")
        if not self.part:
            return tuple(range(len(names)))
        return (names.index(one_of(self.kind.of, self.part, names)),)

    def of(self, window: _Window) -> _Value:
        """Return the value of the response in a window of a run; of several parts the largest one."""
        run, rows = window.run, self.rows(window.run)
        mesh = run.mesh.index(one_of("mesh", self.mesh, run.mesh)) if self.mesh else 0
        projected = window if self.kind.of == "mesh" else window.along(mesh)
        values = [self.kind.take(projected, row, self.order) for row in rows]
        return max(values, key=lambda value: value.value)


def responses_of(
    run: RunResult, responses: Sequence[Response], start: float = 0.0
) -> tuple[list[float], list[float]]:
    """Return values and errors of `responses` from the time `start` (s) of a run on.

    Raises `InputError`: no such part, an order that the output does not hold, or a `start` behind the end.
    """
    bearings = {row for item in responses if item.kind.of == "bearing" for row in item.rows(run)}
    highest = max((response.order for response in responses), default=0)
    window = _Window.of(run, start, highest, tuple(sorted(bearings)))
    values = [response.of(window) for response in responses]
    return [value.value for value in values], [value.error for value in values]


def _bearing_force(window: _Window, row: int, order: int) -> _Value:
    """Return the amplitude of the force vector at an order: root of the sum of squares over x, y, z."""
    amplitude = window.orders[1][row][:, order - 1]
    return _Value(float(np.linalg.norm(amplitude)), window.error("bearing_force_orders", order))


def _dte_order(window: _Window, row: int, order: int) -> _Value:
    """Return the amplitude of the dynamic transmission error at an order of its mesh."""
    amplitude = window.along(row).orders[0]
    return _Value(float(amplitude[order - 1]), window.error("transmission_error_orders", order))


def _peak_mesh_force(window: _Window, row: int, _order: int) -> _Value:
    return _Value(float(np.max(window.run.largest_mesh_force[row, window.part])))


def _dynamic_factor(window: _Window, row: int, order: int) -> _Value:
    """Return K_v of ISO 6336-1: the largest over the nominal force."""
    nominal = float(window.run.nominal_force[row])
    return _Value(_peak_mesh_force(window, row, order).value / nominal if nominal > 0.0 else float("nan"))


def _contact_loss(window: _Window, row: int, _order: int) -> _Value:
    """Return the share of the samples in which no flank touches."""
    return _Value(float(np.mean(window.run.contact[row, window.part] == ContactState.OFF)))


def _mesh_load_factor(window: _Window, _row: int, _order: int) -> _Value:
    """Return K_gamma of ISO 6336-1 at the central gear where planets share worst, over the whole run."""
    shared = planet_load_sharing(window.run)
    if not shared:
        raise InputError("quantity", "mesh_load_factor", "of a scene with planets")
    return _Value(max(sharing.mesh_load_factor for sharing in shared))


QUANTITIES: dict[str, _Quantity] = {
    "bearing_force": _Quantity("bearing force", "N", "bearing", _bearing_force, by_order=True),
    "dte_order": _Quantity("dynamic transmission error", "m", "mesh", _dte_order, by_order=True),
    "dte_rms": _Quantity(
        "dynamic transmission error, rms",
        "m",
        "mesh",
        lambda window, row, _: _Value(float(np.std(window.transmission_error(row))), window.error("rms")),
    ),
    "dte_peak_to_peak": _Quantity(
        "dynamic transmission error, peak to peak",
        "m",
        "mesh",
        lambda window, row, _: _Value(float(np.ptp(window.transmission_error(row)))),
    ),
    "peak_mesh_force": _Quantity("peak mesh force", "N", "mesh", _peak_mesh_force),
    "dynamic_factor": _Quantity("dynamic factor K_v", "", "mesh", _dynamic_factor),
    "contact_loss": _Quantity("contact loss", "", "mesh", _contact_loss),
    "mesh_load_factor": _Quantity("mesh load factor K_gamma", "", "", _mesh_load_factor),
}
"""Responses by name."""
