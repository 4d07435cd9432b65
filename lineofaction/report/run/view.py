"""View of a run in a report: the chosen series, its direction, and the scale of amplitudes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bounds import one_of
from dynamics.acoustics import Recording, principal_direction, series_recording
from dynamics.acoustics.recording import SAMPLE_RATE
from dynamics.errors import InputError
from dynamics.orders import driving_shaft, highest_valid_order, order_frequency
from dynamics.orders.spectrum import WINDOWS
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.run import DIRECTIONS, PRINCIPAL
from lineofaction.report.drawing.figure import Axis, FloatArray, number

MONOTONE = 0.2  # least change of speed over the highest speed of a run for a speed axis
SCALES = {"rms": float(np.sqrt(0.5)), "peak": 1.0}
"""Factors from a peak amplitude to the amplitude of each scale."""

PITCHES = 3
"""Number of base pitches of a window."""
STEADY = 0.1
"""Largest change of speed over a run, relative to the highest speed, at which the run counts as steady."""
ROUNDING = 1e-12  # variation over the largest value below which a series is constant


@dataclass(frozen=True)
class Quantity:
    """A series of a run that a report can show."""

    series: str
    """Field of the run."""
    part: Literal["bearing", "mesh"]
    """Kind of part that has the series."""
    noun: str
    """Name of the quantity with its preposition, before the name of the part."""
    unit: str = "N"
    factor: float = 1.0
    """Factor from the SI unit to `unit`."""
    setting: str = ""
    """Setting of a scene without which its run has no such series; empty: all runs have it."""


QUANTITIES = {
    "force": Quantity("bearing_force", "bearing", "force on"),
    "moment": Quantity("bearing_moment", "bearing", "moment on", "N m"),
    "acceleration": Quantity(
        "bearing_acceleration", "bearing", "acceleration at", "m/s²", 1.0, "outputs.accelerations = true"
    ),
    "mesh_force": Quantity("mesh_force", "mesh", "mesh force of"),
    "elastic_force": Quantity(
        "elastic_force", "mesh", "elastic force of", setting="outputs.elastic_forces = true"
    ),
    "transmission_error": Quantity("dynamic_transmission_error", "mesh", "transmission error of", "µm", 1e6),
}


@dataclass(frozen=True)
class RunView:
    """Choices of a reader about the view of a run; the run supplies the fields that are left out.

    An empty field is left out.
    """

    quantity: str = ""
    """One of `QUANTITIES`. Default: the force on bearings; of a run without bearings the mesh force."""
    bearing: str = ""
    """Bearing of a quantity of bearings. Default: the bearing at which the quantity varies most."""
    mesh: str = ""
    """Mesh whose orders are shown, and mesh of a quantity of meshes. Default: the first mesh."""
    orders: tuple[float, ...] = ()
    """Whole mesh orders of the order cuts. Default: the five largest."""
    window: str = "hann"
    """Window of the spectra."""
    scale: str = "rms"
    """Scale of amplitudes, one of `SCALES`."""
    direction: str = ""
    """Direction along which a quantity of bearings is shown, one of `DIRECTIONS`. The principal direction is
    the one in which the quantity varies most. Default: orders sum the power of all three components, and
    sound follows the principal direction.
    """


@dataclass(frozen=True)
class Signal:
    """A series of one run by the choices of a view."""

    quantity: Quantity
    row: int
    """Index of the bearing or mesh in the series."""
    part: str
    """Name of the bearing or mesh."""
    mesh: int
    """Index of the mesh whose orders are shown."""
    orders: tuple[int, ...]
    """Orders that the view names."""
    window: str
    scale: str
    direction: str = ""

    @property
    def name(self) -> str:
        """The quantity with its bearing or mesh, and the direction if one is named."""
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
        """Return the components (n,) over time by name, in the unit, without components that stay at zero."""
        values = self.quantity.factor * getattr(run, self.quantity.series)[self.row]
        if values.ndim == 1:
            return {"": values}
        return {name: row for name, row in zip("xyz", values, strict=True) if np.any(row)}

    def amplitude(self, peak: FloatArray) -> FloatArray:
        """Return the amplitude in the scale from peak amplitudes (rows, ...), see `magnitude`."""
        return np.asarray(SCALES[self.scale] * self.magnitude(peak))

    def magnitude(self, values: FloatArray) -> FloatArray:
        """Return the size in the unit from values (rows, ...); of a vector the root of the sum of squares."""
        own_values = self.quantity.factor * values[self.row]
        is_vector = self.quantity.part == "bearing"
        return np.asarray(np.sqrt(np.sum(own_values**2, axis=0)) if is_vector else np.abs(own_values))


def selected_signal(run: RunResult, view: RunView) -> Signal:
    """Return the signal of a run that the view names.

    Raises `BadInput`: the run has no such quantity, part or order, or the view no such window or scale.
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
        remedy = f"Run with {quantity.setting}." if quantity.setting else "Show another quantity."
        raise BadInput.of("quantity", name, "one that the run holds", remedy)
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
    """Return the view that shows the same signal of another run as `signal` of the first."""
    quantity = next(name for name, value in QUANTITIES.items() if value is signal.quantity)
    bearing = signal.part if signal.quantity.part == "bearing" else ""
    return replace(view, quantity=quantity, bearing=bearing)


def _index(field: str, name: str, names: tuple[str, ...]) -> int:
    if name not in names:
        raise BadInput.of(field, name, str(one_of(names)))
    return names.index(name)


def _orders(run: RunResult, orders: tuple[float, ...], mesh: int) -> tuple[int, ...]:
    valid = max(highest_valid_order(run, mesh), 1)
    for order in orders:
        if order != int(order) or not 1 <= order <= valid:
            bound = f"a whole number, 1 to {valid}: what the run's output holds"
            raise BadInput.of("orders", order, bound, "Run with outputs.mesh_orders for higher ones.")
    return tuple(map(int, orders))


def run_axis(run: RunResult, time: FloatArray, mesh: int = 0) -> tuple[Axis, FloatArray]:
    """Return the axis of blocks at `time` and their values on it: speed if it is monotonic, else time."""
    shaft = run.shaft.index(driving_shaft(run, mesh))
    return speed_axis(time, np.interp(time, run.time, np.abs(run.speed[shaft])))


def speed_axis(time: FloatArray, speed: FloatArray) -> tuple[Axis, FloatArray]:
    """Return the axis of values and their values on it: the speed, rad/s, if monotonic, else the time."""
    speed = speed * 30.0 / np.pi
    steps = np.diff(speed)
    is_monotonic = bool(np.all(steps > 0.0) or np.all(steps < 0.0))
    if is_monotonic and np.ptp(speed) > MONOTONE * speed.max():
        return Axis("speed of the driving gear, rpm"), speed
    return Axis("time, s"), time


def decibels(values: FloatArray, floor: float) -> FloatArray:
    """Return levels in dB re 1 unit; values below `floor` count as `floor`."""
    return np.asarray(20.0 * np.log10(np.maximum(values, max(floor, 1e-300))))


@dataclass(frozen=True)
class Travel:
    """Motion of a mesh's driving gear over a run, or of the leading shaft of a run without meshes."""

    speed_rpm: FloatArray
    """Speed without its sign. Shape (n,)."""
    position: FloatArray
    """Position, not wrapped, in base pitches; of a shaft in turns. Shape (n,)."""

    def window(self, target: float) -> slice:
        """Return the samples of a few whole base pitches around the first passing of a speed, rpm.

        Of a run at one speed they are the last ones: the transients of the start have decayed there.
        """
        traveled, speed = np.abs(self.position - self.position[0]), np.abs(self.speed_rpm)
        passing = int(np.argmax(speed >= target)) or int(np.argmin(np.abs(speed - target)))
        if is_steady(speed):
            passing = traveled.size - 1
        first = min(np.floor(traveled[passing] - PITCHES / 2), np.floor(traveled[-1]) - PITCHES)
        start = int(np.searchsorted(traveled, max(first, 0.0)))
        stop = int(np.searchsorted(traveled, max(first, 0.0) + PITCHES, side="right"))
        return slice(start, max(stop, start + 2))


def travel(run: RunResult, mesh: int = 0) -> Travel:
    """Return the travel of one mesh; of a run without meshes the travel of its leading shaft."""
    speed = np.abs(run.speed[run.shaft.index(driving_shaft(run, mesh))]) * 30.0 / np.pi
    if run.mesh:
        return Travel(speed, np.abs(np.unwrap(run.position[mesh], period=1.0)))
    frequency = order_frequency(run, mesh)
    turns = np.cumsum(0.5 * np.diff(run.time) * (frequency[1:] + frequency[:-1]))
    return Travel(speed, np.concatenate([[0.0], turns]))


def validity(valid_order: int, top: float, of: str = "mesh") -> str:
    """Return a sentence on the highest valid order of a picture, and the highest frequency `top` in Hz.

    `of` is "mesh" or "shaft", by whose turns orders count.
    """
    return f"Valid to {of} order {valid_order} at the highest {of} frequency, {number(top, 4)} Hz."


def counted_by(run: RunResult) -> str:
    """Return the base of a run's orders: "mesh", or "shaft" if the run has no mesh."""
    return "mesh" if run.mesh else "shaft"


def window_speeds(speed: FloatArray, fractions: tuple[float, ...] = (0.1, 0.4, 0.9)) -> tuple[float, ...]:
    """Return speeds of windows: rounded fractions of the highest speed of a run, none above it.

    Of a run at one speed, and of a run that passes none of these fractions, it is the speed at its end.
    """
    highest, lowest = float(np.max(np.abs(speed))), float(np.min(np.abs(speed)))
    candidates = [_rounded(fraction * highest, highest) for fraction in fractions]
    passed = tuple(dict.fromkeys(value for value in candidates if value > 0.0 and value >= lowest))
    return (float(f"{abs(speed[-1]):.4g}"),) if is_steady(speed) or not passed else passed


def is_steady(speed: FloatArray) -> bool:
    """Return whether a run has one speed alone."""
    size = np.abs(speed)
    return bool(np.ptp(size) <= STEADY * np.max(size))


def _rounded(value: float, highest: float) -> float:
    """Return a value with one digit, or with two where one digit would exceed the highest."""
    short = float(f"{value:.1g}")
    return short if short <= highest else float(f"{value:.2g}")


def along_direction(run: RunResult, signal: Signal) -> RunResult:
    """Return the run with the component of the quantity along the signal's direction, (rows, 1, T).

    Without a direction the run is unchanged. Raises `BadInput`: the direction is the principal one, and the
    quantity does not vary.
    """
    if not signal.direction:
        return run
    values = getattr(run, signal.quantity.series)  # (rows, 3, T)
    axis, _ = _axis(run, signal)
    component = np.einsum("c,bct->bt", axis, values)[:, None]
    return replace(run, **{signal.quantity.series: component})


def signal_recording(run: RunResult, signal: Signal, sample_rate: int = SAMPLE_RATE) -> Recording:
    """Return the signal of a run as a recording in its unit, for bearings along one direction.

    Raises `BadInput`: it does not vary, or the run is shorter than 4 samples.
    """
    values, where = getattr(run, signal.quantity.series)[signal.row], ""
    if values.ndim == 2:
        axis, where = _axis(run, signal)
        values = axis @ values
    name, unit = f"{signal.name}{where}; no sound pressure", signal.quantity.unit
    try:
        recording = series_recording(
            signal.quantity.factor * values, run.sample_rate, name, unit, sample_rate
        )
    except InputError as error:
        raise _silent(signal, error) from None
    if not recording.peak > ROUNDING * np.abs(signal.quantity.factor * values).max():
        raise _silent(signal, "It is silent.")
    return recording


def _axis(run: RunResult, signal: Signal) -> tuple[FloatArray, str]:
    """Return the direction (3,) of a vector signal, and the remark on it for the signal's name."""
    if signal.direction not in ("", PRINCIPAL):
        return np.eye(3)["xyz".index(signal.direction)], ""
    values = getattr(run, signal.quantity.series)[signal.row]
    try:
        axis, share = principal_direction(values, run.sample_rate)
    except InputError as error:
        raise _silent(signal, error) from None
    x, y, z = axis
    joint = "," if signal.direction else " along"
    return axis, f"{joint} ({x:.3f}, {y:.3f}, {z:.3f}), {number(100.0 * share, 3)} % of its variance"


def _silent(signal: Signal, reason: object) -> BadInput:
    return BadInput.of("quantity", signal.name, "one that varies over the run", f"{reason}")
