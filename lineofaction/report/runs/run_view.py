"""What of a run its page shows: a quantity, where it is taken, which orders, by which window, rms or peak."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bounds import one_of
from dynamics.orders import highest_valid_order
from dynamics.orders.spectrum import WINDOWS
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.sound_figures import driving_shaft
from lineofaction.gearbox.studies.listen.through_housing import DIRECTIONS, PRINCIPAL
from lineofaction.report.drawing.figure import Axis, FloatArray

MONOTONE = 0.2  # least change of speed over the run, of the highest, for a speed axis
SCALES = {"rms": float(np.sqrt(0.5)), "peak": 1.0}
"""Of an amplitude."""
"""Along which a quantity of bearings is taken; the principal one is that in which it varies most."""


@dataclass(frozen=True)
class Quantity:
    """A series of a run that is shown: its field, where it is taken, its noun, and its unit over SI."""

    series: str
    part: Literal["bearing", "mesh"]
    noun: str
    unit: str = "N"
    factor: float = 1.0
    asked_for: str = ""


QUANTITIES = {
    "force": Quantity("bearing_force", "bearing", "force on"),
    "moment": Quantity("bearing_moment", "bearing", "moment on", "N m"),
    "acceleration": Quantity(
        "bearing_acceleration", "bearing", "acceleration at", "m/s²", 1.0, "outputs.accelerations = true"
    ),
    "mesh_force": Quantity("mesh_force", "mesh", "mesh force of"),
    "transmission_error": Quantity("dynamic_transmission_error", "mesh", "transmission error of", "µm", 1e6),
}


@dataclass(frozen=True)
class RunView:
    """What a reader wants to see of a run; what is left out, the run decides.

    Attributes
    ----------
    quantity : str
        One of `QUANTITIES`; empty: the force on bearings, of a run without them that of the mesh.
    bearing : str
        Empty: where the quantity varies most.
    mesh : str
        Whose orders are shown, and where quantities of meshes are taken; empty: the first.
    orders : tuple of float
        Mesh orders of the order cuts, whole numbers; empty: the five largest.
    window : str
        Of the spectra.
    scale : str
        Whether amplitudes are effective or peak values.
    direction : str
        One of `DIRECTIONS`, along which a quantity of bearings is taken for orders and sound; empty: orders
        of all three components in power, sound along the principal one.
    """

    quantity: str = ""
    bearing: str = ""
    mesh: str = ""
    orders: tuple[float, ...] = ()
    window: str = "hann"
    scale: str = "rms"
    direction: str = ""


@dataclass(frozen=True)
class Signal:
    """What is shown of one run: a series, the row of its first axis, and how amplitudes are written.

    Attributes
    ----------
    quantity : Quantity
    row : int
    part : str
        Name of the bearing or the mesh.
    mesh : int
        Whose orders are shown.
    orders : tuple of int
        Those that were named.
    window, scale, direction : str
    """

    quantity: Quantity
    row: int
    part: str
    mesh: int
    orders: tuple[int, ...]
    window: str
    scale: str
    direction: str = ""

    @property
    def name(self) -> str:
        """What and where, and along which direction if that is named."""
        where = f"bearing {self.part}" if self.quantity.part == "bearing" else self.part
        along = {"": "", PRINCIPAL: " along its principal direction"}.get(
            self.direction, f" along {self.direction}"
        )
        return f"{self.quantity.noun} {where}{along}"

    @property
    def heading(self) -> str:
        """The name as a heading."""
        return self.name[0].upper() + self.name[1:]

    @property
    def label(self) -> str:
        """The quantity with its unit, as on an axis over time."""
        return f"{self.quantity.noun.rpartition(' ')[0]}, {self.quantity.unit}"

    @property
    def unit(self) -> str:
        """The unit with the scale, as on an axis."""
        return f"{self.quantity.unit} {self.scale}"

    def components(self, run: RunResult) -> dict[str, FloatArray]:
        """Return the components (n,) over time by name, in the unit; those that stay at zero are left out."""
        values = self.quantity.factor * getattr(run, self.quantity.series)[self.row]
        if values.ndim == 1:
            return {"": values}
        return {name: row for name, row in zip("xyz", values, strict=True) if np.any(row)}

    def amplitude(self, peak: FloatArray) -> FloatArray:
        """Take the row of peak amplitudes (rows, ...) in the scale; three components are added in power."""
        return np.asarray(SCALES[self.scale] * self.magnitude(peak))

    def magnitude(self, values: FloatArray) -> FloatArray:
        """Take the row of values (rows, ...) in the unit; three components are added in power."""
        taken = self.quantity.factor * values[self.row]
        vector = self.quantity.part == "bearing"
        return np.asarray(np.sqrt(np.sum(taken**2, axis=0)) if vector else np.abs(taken))


def shown_signal(run: RunResult, view: RunView) -> Signal:
    """Find what the view names in a run.

    Raises
    ------
    BadInput
        The run has no such quantity, part or order, or the view no such window or scale.
    """
    for field, name, names in (("window", view.window, WINDOWS), ("scale", view.scale, SCALES)):
        if name not in names:
            raise BadInput.of(field, name, str(one_of(names)))
    name = view.quantity or ("mesh_force" if run.mesh and not run.bearing else "force")
    if name not in QUANTITIES:
        raise BadInput.of("quantity", name, str(one_of(QUANTITIES)))
    quantity = QUANTITIES[name]
    values = getattr(run, quantity.series)
    if not values.shape[0]:
        advice = f"Run with {quantity.asked_for}." if quantity.asked_for else "Show another quantity."
        raise BadInput.of("quantity", name, "one that the run holds", advice)
    mesh = _index("mesh", view.mesh, run.mesh) if view.mesh else 0
    parts, row = run.mesh, mesh
    if quantity.part == "bearing":
        parts, row = run.bearing, int(np.argmax(np.var(values, axis=-1).sum(axis=-1)))
        row = _index("bearing", view.bearing, parts) if view.bearing else row
    if view.direction and (view.direction not in DIRECTIONS or quantity.part != "bearing"):
        bound = str(one_of(DIRECTIONS)) + ", of a quantity of bearings"
        raise BadInput.of("direction", view.direction, bound)
    orders = _orders(run, view.orders, mesh)
    return Signal(quantity, row, parts[row], mesh, orders, view.window, view.scale, view.direction)


def same_view(view: RunView, signal: Signal) -> RunView:
    """Return the view that shows of another run what `signal` shows of the first."""
    quantity = next(name for name, value in QUANTITIES.items() if value is signal.quantity)
    bearing = signal.part if signal.quantity.part == "bearing" else ""
    return replace(view, quantity=quantity, bearing=bearing)


def _index(field: str, name: str, names: tuple[str, ...]) -> int:
    if name not in names:
        raise BadInput.of(field, name, str(one_of(names)))
    return names.index(name)


def _orders(run: RunResult, orders: tuple[float, ...], mesh: int) -> tuple[int, ...]:
    """Return the orders that were named, which the output holds."""
    valid = max(highest_valid_order(run, mesh), 1)
    for order in orders:
        if order != int(order) or not 1 <= order <= valid:
            bound = f"a whole number, 1 to {valid}: what the run's output holds"
            raise BadInput.of("orders", order, bound, "Run with outputs.mesh_orders for higher ones.")
    return tuple(map(int, orders))


def run_axis(run: RunResult, time: FloatArray, mesh: int = 0) -> tuple[Axis, FloatArray]:
    """Return the axis for blocks at `time`: speed where it rises or falls all along, else time."""
    shaft = run.shaft.index(driving_shaft(run, mesh))
    return speed_axis(time, np.interp(time, run.time, np.abs(run.speed[shaft])))


def speed_axis(time: FloatArray, speed: FloatArray) -> tuple[Axis, FloatArray]:
    """Return the axis of what is at speeds (rad/s) over time: the speed where it rises or falls all along."""
    speed = speed * 30.0 / np.pi
    steps = np.diff(speed)
    swept = bool(np.all(steps > 0.0) or np.all(steps < 0.0))
    if swept and np.ptp(speed) > MONOTONE * speed.max():
        return Axis("speed of the driving gear, rpm"), speed
    return Axis("time, s"), time


def decibels(values: FloatArray, floor: float) -> FloatArray:
    """Return levels in dB re 1 unit, of nothing below `floor`."""
    return np.asarray(20.0 * np.log10(np.maximum(values, max(floor, 1e-300))))
