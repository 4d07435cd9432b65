"""Compute the finished results that the gallery draws: examples/gallery/results. About three CPU minutes.

python scripts/gallery_results.py [NAME ...]     all results, or those of these names
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import lineofaction as loa

EXAMPLES = Path(__file__).parents[1] / "examples"
FOLDER = EXAMPLES / "gallery" / "results"

SPUR, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "palermo_scene.toml"
HELICAL = EXAMPLES / "helical_ev_23_67.toml"
COARSE = {"accuracy.level": "draft"}


def spur(torques: list[float], changes: Mapping[str, object] | None = None) -> loa.Case:
    """Return the published spur pair on a coarse mesh."""
    return loa.read(SPUR, {**COARSE, "load.torque_n_m": torques, **(changes or {})}, kind=loa.Case)


def helical() -> loa.Case:
    """Return the helical EV pair on a coarse mesh at one torque."""
    return loa.read(HELICAL, {**COARSE, "load.torque_n_m": [40.0, 80.0]}, kind=loa.Case)


def relief_map() -> object:
    """Return the ripple over torque and tip relief of both gears."""
    lengths = {f"pair.{gear}.tip_relief_length_mm": 2.0 for gear in ("pinion", "wheel")}
    case = spur([50.0, 100.0, 150.0, 200.0, 300.0, 400.0], lengths)
    return loa.sweep(case, over=["torque", "tip_relief=0:24:3"], show=["peak_to_peak"])


def run_up() -> loa.RunResult:
    """Return a short run-up of the spur pair, with the samples that its lowest orders need."""
    short = {"run.duration_s": 2.0, "drives.motor.time_s": [0.0, 2.0], "outputs.sample_rate_hz": 4000.0}
    return loa.simulate(loa.read(SCENE, short, kind=loa.Scene))


RESULTS: dict[str, Callable[[], object]] = {
    "spur": lambda: loa.analyze(spur([25.0, 50.0, 100.0, 200.0, 300.0, 400.0])),
    "helical": lambda: loa.analyze(helical()),
    "pressure": lambda: loa.flank(helical(), torque_n_m=80.0),
    "root": lambda: loa.root_stress(spur([100.0]), torque_n_m=100.0),
    "relief": relief_map,
    "scatter": lambda: loa.scatter(spur([100.0]), samples=200, exact=60, tolerance_class=6),
    "modes": lambda: loa.modes(SCENE, speed_rpm=list(range(0, 8001, 500))),
    "response": lambda: loa.response(SCENE, speed_rpm=list(range(100, 6001, 50))),
    "steady": lambda: loa.steady(SCENE, speed_rpm=list(range(2400, 4001, 100))),
    "run_up": run_up,
    "deflection": lambda: loa.deflect(EXAMPLES / "flexible_shafts_scene.toml"),
}


def main(names: list[str]) -> None:
    """Compute results and write them."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in names or RESULTS:
        print(loa.write(RESULTS[name](), FOLDER / f"{name}.nc"))


if __name__ == "__main__":
    main(sys.argv[1:])
