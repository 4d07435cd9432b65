"""The output rate of a run, its anti-alias filter, and the highest mesh order that the output holds.

The inner grid is finer than the output. The anti-alias filter takes it to the output rate: frequencies up to
the pass frequency keep their amplitude.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from functools import lru_cache

import numpy as np

from dynamics.identity_cache import MAX_CACHED, cached_by
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.phases import cage_turns, load_orders
from dynamics.scene.scene import MIN_RATE, Scene, check_samples
from dynamics.types import FloatArray, Json

PER_BAND = 2.56
"""Output rate over the highest frequency that is passed, as vibration analyzers choose it."""
STOP_BAND = 80.0
"""Attenuation of frequencies that would fold, dB."""
DESIGN = STOP_BAND + 3.0
"""Attenuation required of Kaiser's formulas: they miss by up to 2 dB."""
INNER_PER_PITCH = 64.0
"""Inner samples per base pitch, or period of a load's highest order, at the least: as many as steps."""
MIN_FACTOR = 3
"""Inner samples at the least, per output sample and per sample that would pass the highest resolved mode."""
PASSING_ORDERS = 4
"""Multiples of the passing of elements that matter: the fifth is below 3 % of the first on loaded rows."""
SPEED_POINTS = 257  # times of a run at which speeds are evaluated, in addition to the knots of laws
DIGITS = 3  # significant digits of an automatic rate


@dataclass(frozen=True)
class Sampling:
    """The sampling of a run."""

    rate: float
    """Sample rate of the output grid, Hz."""
    chosen: str
    """Reason for the rate, in words."""
    mesh_frequency: float
    mode_frequency: float
    """`mesh_frequency`, `mode_frequency`: Highest mesh frequency of the kinematic motion, and highest
    resolved mode that the meshes excite (0: none), Hz.
    """
    mesh_orders: int
    """Number of mesh orders that the output resolves."""
    band: float
    """Frequency up to which an automatic rate resolves the output, Hz. Orders and modes reach beyond it where
    it is the lower one.
    """
    pass_frequency: float
    stop_frequency: float
    """`pass_frequency`, `stop_frequency`: Edges of the filter, Hz: it passes frequencies up to the first and
    stops those from the second on. Frequencies between both may fold, to above the first.
    """
    stop_band: float
    """Attenuation of the filter from `stop_frequency` on, dB; 0: the output are points of the motion,
    unfiltered.
    """
    inner_rate: float
    """Rate of the grid on which the steps are evaluated, filtered, and searched for peaks, Hz."""
    taps: int
    """Length of the filter in inner samples: linear phase, its delay compensated."""

    @property
    def factor(self) -> int:
        """Inner samples per output sample."""
        return round(self.inner_rate / self.rate)

    @property
    def edge(self) -> float:
        """Seconds at both ends in which the filter sees the motion held at its first or last state."""
        return (self.taps // 2) / self.inner_rate if self.stop_band else 0.0

    def filter_taps(self) -> FloatArray:
        """Return the weights (taps,) of the filter, symmetric, with the sum 1."""
        return _filter_taps(self.taps, self.factor if self.stop_band else 0)

    def points(self) -> Sampling:
        """Return a sampling of the same rate that looks nowhere else and filters nothing."""
        return replace(self, stop_band=0.0, inner_rate=self.rate, taps=3)

    def to_json(self) -> Json:
        """Return the entry of the receipt."""
        return {**asdict(self), "edge": self.edge}


@lru_cache(maxsize=MAX_CACHED)
def _filter_taps(taps: int, factor: int) -> FloatArray:
    """Return the weights (taps,) of a filter to every `factor`-th point; 0: of none."""
    at = np.arange(taps) - taps // 2
    if factor == 0:
        return np.asarray(at == 0, dtype=float)
    shape = 0.1102 * (DESIGN - 8.7)  # shape of the window for a stop band above 50 dB (Kaiser 1974)
    weight = np.sinc(at / factor) * np.kaiser(taps, shape)
    return np.asarray(weight / np.sum(weight))


def order_rate(scene: Scene, kinematics: Kinematics) -> float:
    """Return the rate, Hz, that passes the wanted mesh orders and those of loads at the highest speed.

    As far as they lie in the band of the output.
    """
    return max(PER_BAND * min(_top_order(scene, kinematics), scene.outputs.band), MIN_RATE)


def shaft_resolution(scene: Scene, kinematics: Kinematics) -> float:
    """Return the frequency to which shafts are resolved unless it is stated, Hz.

    Half the rate of the output as all wanted orders need it, or what holds the levels up to its band within
    0.1 dB: modes of a shaft reduced to lower ones are off by 0.3 dB there.
    """
    if scene.outputs.sample_rate is not None:
        return 0.5 * scene.outputs.sample_rate
    rate = max(PER_BAND * _top_order(scene, kinematics), MIN_RATE)
    return min(0.5 * rate, PER_BAND * scene.outputs.band)


def _top_order(scene: Scene, kinematics: Kinematics) -> float:
    """Return the highest frequency of the wanted mesh orders and of loads at the highest speed, Hz."""
    meshes = scene.outputs.mesh_orders * top_mesh_frequency(scene, kinematics)
    return max(meshes, top_load_frequency(scene, kinematics))


def top_mesh_frequency(scene: Scene, kinematics: Kinematics) -> float:
    """Return the highest mesh frequency of the kinematic motion over the run, Hz; 0 without a mesh."""
    return _highest(scene, kinematics.float_mesh_rate)


def top_load_frequency(scene: Scene, kinematics: Kinematics) -> float:
    """Return the highest frequency at which a load excites in the kinematic motion, Hz; 0 without one."""
    return _highest(scene, load_orders(scene, kinematics))


def top_passing_frequency(scene: Scene, kinematics: Kinematics) -> float:
    """Return the highest frequency at which elements of rolling bearings by geometry pass, Hz; 0 without one.

    It is that of a multiple, `PASSING_ORDERS`, of the passing itself.
    """
    names = frozenset(part.name for part in scene.rolling_bearings)
    turns = cage_turns(scene, kinematics, names)
    rows = [
        part.row.count * np.abs([float(turn) for turn in cage])
        for part, cage in zip(scene.rolling_bearings, turns, strict=True)
    ]
    return PASSING_ORDERS * _highest(scene, np.array(rows).reshape(len(rows), len(kinematics.law_shaft)))


def _highest(scene: Scene, rate: FloatArray) -> float:
    """Return the highest frequency over the run of turns at `rate` (r, k) per turn of each law, Hz."""
    speed = _speeds(scene, scene.duration)
    return float(np.max(np.abs(rate @ speed), initial=0.0)) / (2.0 * math.pi)


@cached_by(lambda scene: (scene.drives, scene.free_rotations))
def _speeds(scene: Scene, duration: float) -> FloatArray:
    """Return the speed of every law at points all over a run and at its knots, (k, T) in rad/s."""
    time = np.linspace(0.0, duration, SPEED_POINTS)
    knots = [np.asarray(part.speed.time, dtype=float) for part in scene.references]
    inside = np.concatenate(knots)
    time = np.union1d(time, inside[(inside >= 0.0) & (inside <= duration)])
    return np.array([part.speed(time) for part in scene.references])


def choose_sampling(scene: Scene, kinematics: Kinematics, mode: float) -> Sampling:
    """Return the sampling of the run of `scene`; `mode` is its highest resolved mode, Hz.

    Raises `InputError`: the run would have too many samples.
    """
    mesh, outputs = top_mesh_frequency(scene, kinematics), scene.outputs
    load = top_load_frequency(scene, kinematics)
    rate, chosen = outputs.sample_rate, "sample_rate of the scene"
    if rate is None:
        by_order, by_mode = order_rate(scene, kinematics), PER_BAND * min(mode, outputs.band)
        rate = _rounded_up(max(by_order, by_mode))
        highest = max(_top_order(scene, kinematics), mode)
        chosen = f"highest mode that meshes excite, {mode:.4g} Hz"
        if highest > outputs.band:
            chosen = f"band of the output, {outputs.band:.4g} Hz; orders and modes reach {highest:.4g} Hz"
        elif by_order >= by_mode and load > outputs.mesh_orders * mesh:
            chosen = f"highest order of a load, {load:.4g} Hz"
        elif by_order >= by_mode:
            chosen = f"{outputs.mesh_orders} orders of the highest mesh frequency, {mesh:.4g} Hz"
        check_samples(scene.duration, rate)
    inner = max(INNER_PER_PITCH * max(mesh, load), MIN_FACTOR * PER_BAND * mode)
    factor = max(MIN_FACTOR, math.ceil(inner / rate))
    stop_band = STOP_BAND if outputs.anti_alias else 0.0
    return Sampling(
        rate=rate,
        chosen=chosen,
        mesh_frequency=mesh,
        mode_frequency=mode,
        mesh_orders=outputs.mesh_orders,
        band=outputs.band,
        pass_frequency=rate / PER_BAND,
        stop_frequency=rate - rate / PER_BAND,
        stop_band=stop_band,
        inner_rate=factor * rate,
        taps=_taps(factor) if outputs.anti_alias else 2 * factor + 1,
    )


def _taps(factor: int) -> int:
    """Odd length of a Kaiser filter from the pass to the stop frequency (Kaiser 1974)."""
    width = 2.0 * math.pi * (1.0 - 2.0 / PER_BAND) / factor
    return 2 * math.ceil(0.5 * (DESIGN - 7.95) / (2.285 * width)) + 1


def _rounded_up(rate: float) -> float:
    unit = 10.0 ** (math.floor(math.log10(rate)) + 1 - DIGITS)
    return math.ceil(rate / unit * (1.0 - 1e-12)) * unit
