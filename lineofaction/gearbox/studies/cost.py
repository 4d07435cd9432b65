"""What a study is predicted to cost before it begins, and how large a scene is that is not computed yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from bounds import engineering
from dynamics.assembly.assemble import System, assemble
from dynamics.mechanism.kinematics import at_steady_speeds
from dynamics.scene import Scene
from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.case import CheckedCases
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.scene import SceneInput

_SMALL = 0.02
"""Share of the whole below which a part is not named."""
CASES = CheckedCases(16)
"""Cases whose costs were predicted last: those of a scene and of several verbs are checked once."""


class Work(NamedTuple):
    """Pieces of the same work: their name in the plural, CPU seconds of each, and how many."""

    name: str
    each: float
    pieces: float = 1.0

    @property
    def seconds(self) -> float:
        """CPU seconds of all pieces."""
        return self.each * self.pieces

    @property
    def words(self) -> str:
        """Say the work: "24 values at 1.6 s", of a single piece "gears 3.2 s"."""
        each = engineering(self.each, 2)
        return f"{self.name} {each} s" if self.pieces == 1.0 else f"{self.pieces:.0f} {self.name} at {each} s"


@dataclass(frozen=True)
class StudyCost:
    """Predicted cost of a study: its parts in the order of the work, the largest memory if it is known."""

    parts: tuple[Work, ...]
    bytes: float = 0.0

    @property
    def seconds(self) -> float:
        """CPU seconds of all parts."""
        return sum(part.seconds for part in self.parts)

    @property
    def words(self) -> str:
        """Say the cost: "about 40 CPU s, 1.2 GiB: gears 3.2 s, 24 values at 1.6 s"."""
        whole = self.seconds
        memory = f", {engineering(self.bytes / 2**30, 2)} GiB" if self.bytes else ""
        parts = ", ".join(part.words for part in self._by_name if part.seconds > _SMALL * whole)
        return f"about {engineering(whole, 2)} CPU s{memory}: {parts}"

    @property
    def _by_name(self) -> Iterator[Work]:
        """The parts, those of one name as one with their mean."""
        for name in dict.fromkeys(part.name for part in self.parts):
            same = [part for part in self.parts if part.name == name]
            count = sum(part.pieces for part in same)
            yield Work(name, sum(part.seconds for part in same) / max(count, 1.0), count)

    def __add__(self, later: StudyCost) -> StudyCost:
        """Return the cost of this work and another after it."""
        return StudyCost((*self.parts, *later.parts), max(self.bytes, later.bytes))


# Scenes before their tables are computed: what they have of freedoms follows without.


def _facts(scene: SceneInput) -> dict[str, PairFacts] | None:
    cases = {mesh.name: mesh.case for _, mesh in scene.with_database}
    if not all(isinstance(case, Case) for case in cases.values()):
        return None
    return {name: PairFacts.of(CASES.of(case).feasible.request.pair) for name, case in cases.items() if case}


def scene_before_tables(scene: SceneInput) -> Scene | None:
    """Return a scene at steady speeds on placeholders for tables and solids; None: a mesh names its table."""
    facts = _facts(scene)
    return None if facts is None else at_steady_speeds(check_scene(scene, facts))


def sized(scene: Scene, highest_hz: float | None = None) -> System:
    """Return the system of a scene, shafts that bend resolved to a frequency if one is named."""
    return assemble(scene if highest_hz is None else replace(scene, highest_frequency=highest_hz))
