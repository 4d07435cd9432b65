"""Cost of a step and of its parts: the paper's pair and a three-planet stage on finite-element tables."""

from __future__ import annotations

from typing import Any

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = (
    "from benchmarks.step_cost_cases import measured as cost\nmeasured = cost({stem!r}, {whole}, {part})\n"
)
DEFAULT_OVER_BARE = 1.25


def figures() -> list[Figure]:
    """Return times per part, per step and per run."""
    paper = measure(_CODE.format(stem="palermo_scene", whole=5.0, part=2.0))
    stage = measure(_CODE.format(stem="planetary_scene", whole=10.0, part=0.5))
    return [
        *_scene("the paper's pair, 5 s", paper, {}, 0.35),
        *_scene("three-planet stage, 10 s", stage, {"implicit": 6.0, "explicit": 3.0}, 4.0),
    ]


def _scene(subject: str, found: dict[str, Any], per_step: dict[str, float], whole: float) -> list[Figure]:
    """Return the figures of one scene."""
    return [
        *(Figure(subject, name, value, "ns") for name, value in found["parts"].items()),
        *(
            Figure(subject, f"a step with its samples, {method}", found[method], "us", per_step.get(method))
            for method in ("implicit", "explicit")
        ),
        *(
            Figure(subject, f"a step alone, {method}", found[f"{method} alone"], "us")
            for method in ("implicit", "explicit")
        ),
        Figure(subject, "run, default receipt", found["default"], "CPU s", whole),
        Figure(subject, "default over bare run", found["default"] / found["bare"], "-", DEFAULT_OVER_BARE),
    ]
