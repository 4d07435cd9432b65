"""Runs in closed form: forces on bearings that follow meshes whose frequency changes evenly."""

from types import SimpleNamespace
from typing import cast

import numpy as np

from dynamics.results import RunResult

TEETH = 20
BEARINGS = ("input.left", "input.right", "output.left", "output.right")
RATE = 20_480.0


def swept_run(
    start, end, duration, force, *, ratios=(1.0,), modes=None, parted=None, rate=RATE, bearings=BEARINGS
) -> RunResult:
    """A run whose first mesh goes evenly from `start` to `end` Hz, below 0 backwards, the others with it.

    `force(cycles, hertz, time)` returns (b, 3, T) in N; cycles and hertz are (m, T). Flanks part where
    `parted(time)`.
    """
    time = np.arange(round(duration * rate) + 1) / rate
    own = start + (end - start) * time / duration
    turned = start * time + 0.5 * (end - start) * time**2 / duration
    ratio = np.array(ratios)[:, None]
    cycles = ratio * turned
    apart = np.zeros(time.size, bool) if parted is None else parted(time)
    sampling = {"rate": rate, "pass_frequency": rate / 2.56}
    run = SimpleNamespace(
        time=time,
        sample_rate=rate,
        mesh=tuple(f"mesh {number}" for number in range(len(ratios))),
        shaft=("input",),
        bearing=bearings,
        position=(cycles + 0.3) % 1.0,
        mesh_frequency=np.abs(ratio * own),
        speed=2.0 * np.pi * own[None] / TEETH,
        least_mesh_force=np.where(apart, 0.0, 100.0) * np.ones((len(ratios), 1)),
        bearing_force=force(cycles, ratio * own, time),
        bearing_moment=np.empty((0, 3, time.size)),
        case={"drives": [{"shaft": "input"}], "free_rotations": [], "outputs": {"sample_rate": rate}},
        receipt={"sampling": sampling},
        effect_ledger={},
        modes=modes or {},
    )
    return cast(RunResult, run)


def order_forces(amplitudes, scale=1.0):
    """Orders 1, 2, ... of the first mesh with phasors (b, 3, H); 500 N of mean and a drift."""

    def force(cycles, _hertz, time):
        waves = np.exp(2j * np.pi * np.outer(np.arange(1, amplitudes.shape[-1] + 1), cycles[0]))
        return scale * (500.0 + 20.0 * time / time[-1] + (amplitudes @ waves).real)

    return force


def drawn_amplitudes(orders, seed=3):
    draw = np.random.default_rng(seed).normal(size=(len(BEARINGS), 3, orders, 2))
    return 50.0 * draw @ np.array([1.0, 1j])
