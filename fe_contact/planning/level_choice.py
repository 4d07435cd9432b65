"""Which mesh a tolerance or a time asks for: the cheapest that meets it, by the models of error and cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fe_contact.planning.error_model import LEVELS, ExpectedError
from fe_contact.types import Json


@dataclass(frozen=True)
class LevelChoice:
    """A mesh level, why, and whether the wish can be had.

    Attributes
    ----------
    level : str
        "draft", "standard" or "fine".
    met : bool
        Whether the models promise what was asked for.
    reason : str
        In words.
    """

    level: str
    met: bool
    reason: str

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"level": self.level, "met": self.met, "reason": self.reason}


def level_for_tolerance(tolerance: float, error: Callable[[str], ExpectedError]) -> LevelChoice:
    """Return the coarsest mesh whose own error is expected to be within the tolerance, else the finest.

    The error of the model is not the mesh's to mend: it is said, and only a mesh is chosen.
    """
    for level in LEVELS:
        found = error(level)
        if found.total <= tolerance:
            return LevelChoice(level, True, f"expected error {100.0 * found.total:.2g} %")
    finest = error(LEVELS[-1])
    enough = next((level for level in LEVELS if error(level).mesh <= tolerance), LEVELS[-1])
    level = enough if finest.model > tolerance else LEVELS[-1]
    found = error(level)
    parts = f"mesh {100.0 * found.mesh:.2g} %, model {100.0 * found.model:.2g} %"
    return LevelChoice(level, False, f"no mesh is expected within {100.0 * tolerance:.2g} % ({parts})")


def level_for_time(budget: float, seconds: Callable[[str], float]) -> LevelChoice:
    """Return the finest mesh that is predicted to fit into `budget` CPU seconds, else the coarsest."""
    for level in reversed(LEVELS):
        found = seconds(level)
        if found <= budget:
            return LevelChoice(level, True, f"predicted {found:.2g} CPU s")
    found = seconds(LEVELS[0])
    return LevelChoice(LEVELS[0], False, f"even a draft is predicted to take {found:.2g} CPU s")
