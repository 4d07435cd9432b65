"""Hard scenes that the libraries must master: named, assessed by physics, run by users and by the tests.

A scene is a `HardScene` in the file of its subject, and a line in `registry`.
"""

from lineofaction.hardcases.registry import HARD_SCENES
from lineofaction.hardcases.scene import HardScene, Measured, Outcome, run_scenes

__all__ = ["HARD_SCENES", "HardScene", "Measured", "Outcome", "run_scenes"]
