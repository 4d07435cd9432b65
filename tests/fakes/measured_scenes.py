"""The small scene of two gears in a measured housing: a rigid mass of 40 kg, pushed at one bearing."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from measured_housings import function, universal_file
from scene_files import scene_file

MASS = 40.0
LINES = np.arange(20.0, 1201.0, 4.0)
"""Hz; at 1500 rpm order 2 of 20 teeth, 1000 Hz, is inside, order 3 is not."""
PUSHED = ((1, 1), (1, -2))
"""Reference nodes and directions: the bearing on the left along x, and against y."""
HOUSING = """
[[housings]]
name = "gearcase"
frf_file = "gearcase.uff"
seat_nodes = [{bearing = "left", node = 1}]
point_nodes = [{name = "lid", node = 11}, {name = "foot", node = 12}]
"""


def mass_lines(pushed: Iterable[tuple[int, int]] = PUSHED, **changed: Any) -> list[dict[str, Any]]:
    """Return the functions of the mass: the lid moves along x and y, the foot along x alone.

    Seats of higher numbers are pushed in vain at low frequencies: the mass is not rigid to them.
    """
    responses = ((11, 1), (11, 2), (12, 1))
    return [
        function(
            LINES,
            _accelerance(towards, along) * (LINES / LINES[-1]) ** (seat - 1),
            (node, towards, seat, along),
            **changed,
        )
        for node, towards in responses
        for seat, along in pushed
    ]


def _accelerance(towards: int, pushed: int) -> float:
    """Return the acceleration per force of the mass along axes that may be reversed."""
    return float(np.sign(towards * pushed)) / MASS if abs(towards) == abs(pushed) else 0.0


def measured_scene(folder: Path, housing: str = HOUSING, pushed: Iterable[tuple[int, int]] = PUSHED) -> Path:
    """Write the scene, its table and the file of the responses into a folder; return the scene's path."""
    universal_file(folder / "gearcase.uff", mass_lines(pushed))
    scene = scene_file(folder, speed=1500.0)
    scene.write_text(scene.read_text("utf-8").replace("[outputs]", f"{housing}[outputs]", 1), "utf-8")
    return scene
