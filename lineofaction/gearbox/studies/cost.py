"""What a study is predicted to cost before it begins, and how large a scene is that is not computed yet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError, SolveError
from dynamics.mechanism.kinematics import at_steady_speeds
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table
from dynamics.meshes.technique import PlainTable
from dynamics.scene import Scene
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.case import CheckedCases, boundary_errors
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.scene import SceneInput

if TYPE_CHECKING:
    from dynamics.simulation.run_cost import ProbedRun

_SMALL = 0.02
"""Share of the whole below which a part is not named."""
LONG = 3600.0
"""CPU seconds from which on a cost is said in hours too, and comes with advice."""
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
    """Predicted cost of a study: its parts in the order of the work, the largest memory if it is known.

    `advice` says why it is as much, and what to try instead; empty of a cost that can be afforded.
    """

    parts: tuple[Work, ...]
    bytes: float = 0.0
    advice: str = ""

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
        hours = f" ({engineering(whole / 3600.0, 2)} h)" if whole > LONG else ""
        return (
            f"about {engineering(whole, 2)} CPU s{hours}{memory}: {parts}{self.advice and f'. {self.advice}'}"
        )

    @property
    def _by_name(self) -> Iterator[Work]:
        """The parts, those of one name as one with their mean."""
        for name in dict.fromkeys(part.name for part in self.parts):
            same = [part for part in self.parts if part.name == name]
            count = sum(part.pieces for part in same)
            yield Work(name, sum(part.seconds for part in same) / max(count, 1.0), count)

    def __add__(self, later: StudyCost) -> StudyCost:
        """Return the cost of this work and another after it."""
        advice = " ".join(filter(None, (self.advice, later.advice)))
        return StudyCost((*self.parts, *later.parts), max(self.bytes, later.bytes), advice)


_PANELS = 6.0
"""CPU seconds of the panels of a gear case, measured 5 to 60 of cases and 0.3 of a block; they are kept."""


def panels_work(housings: int) -> Work:
    """Return what panels of so many housings usually take: their meshes are not made before."""
    return Work("panels", _PANELS, housings)


# Scenes before their tables are computed: what they have of freedoms follows without.


@dataclass(frozen=True)
class _Written:
    """A scene by its text: what is made of the last ones is kept, since several verbs are of the same."""

    text: str
    scene: SceneInput = field(compare=False)


def _pairs(scene: SceneInput) -> dict[str, ParallelAxes] | None:
    cases = {mesh.name: mesh.case for _, mesh in scene.with_database}
    if not all(isinstance(case, Case) for case in cases.values()):
        return None
    return {name: CASES.of(case).feasible.request.pair for name, case in cases.items() if case}


def scene_before_tables(scene: SceneInput) -> Scene | None:
    """Return a scene at steady speeds on usual tables and placeholders for solids; None: it names tables."""
    before = moving_before_tables(scene)
    return None if before is None else at_steady_speeds(before)


def moving_before_tables(scene: SceneInput) -> Scene | None:
    """Return a scene as `scene_before_tables` does, in the motion of its run."""
    return _moving(_Written(scene.model_dump_json(), scene))


@lru_cache(2)
def _moving(written: _Written) -> Scene | None:
    scene = written.scene
    pairs = _pairs(scene)
    if pairs is None:
        return None
    facts = {name: PairFacts.of(pair) for name, pair in pairs.items()}
    return check_scene(scene, facts, {name: _usual_table(pair) for name, pair in pairs.items()})


_SINGLE_STIFFNESS = 14e9
"""Of a pair of teeth per unit width, N/m^2: the usual value of ISO 6336-1:2019, 9.3."""
_POSITIONS = 48
"""Of a table in a base pitch, about as many as a computed one has."""


def _usual_table(pair: ParallelAxes) -> PlainTable:
    """Return a table by the usual stiffness of the pairs of teeth that the contact ratio says.

    Those of a helical pair come in over its overlap. Measured on three units, a run on such tables takes 0.4
    to 1.3 of the steps of one on computed tables; on tables of constant stiffness 0.35.
    """
    position = np.arange(_POSITIONS) / _POSITIONS
    across = np.linspace(0.0, pair.overlap_ratio, _POSITIONS, endpoint=False)
    entered = (position[:, None] - across) % 1.0
    pairs = np.mean(np.ceil(pair.transverse_contact_ratio - entered), axis=1)
    stiffness = pair.face_width * _SINGLE_STIFFNESS * (0.75 * pairs + 0.25)
    return stiffness_table(PeriodicCurve.tabulated(position.tolist(), stiffness.tolist()))


def sized(scene: SceneInput, highest_hz: float | None = None) -> System:
    """Return the system of a scene before its tables, its shafts resolved to a frequency if one is named."""
    return _system(_Written(scene.model_dump_json(), scene), highest_hz)


@lru_cache(4)
def _system(written: _Written, highest_hz: float | None) -> System:
    before = scene_before_tables(written.scene)
    assert before is not None  # its callers have asked
    return assemble(before if highest_hz is None else replace(before, highest_frequency=highest_hz))


Receipt = Literal["minimal", "full"]


def runs_cost(
    scene: SceneInput, runs: Callable[[Scene], tuple[list[float], float]], receipt: Receipt | None = None
) -> StudyCost | None:
    """Return the cost of runs of a scene: so many times its steps each, and CPU seconds beside the steps.

    None: nothing predicts it.
    """
    cost = run_cost(scene, receipt=receipt)
    before = None if cost is None else moving_before_tables(scene)
    if cost is None or before is None:
        return None
    try:
        times, beside = runs(before)
    except (InputError, SolveError):
        return None
    each = cost.seconds * float(np.mean(times)) + beside if times else 0.0
    return StudyCost((Work("runs", each, len(times)),))


def run_cost(scene: SceneInput, runs: int = 1, receipt: Receipt | None = None) -> StudyCost | None:
    """Return the cost of so many runs of a scene, by some steps of it; None: nothing predicts it.

    `receipt`: of the runs; None: as the scene says. Modes that a solid housing keeps are not known before
    and do not count. Raises `BadInput`: no such scene.
    """
    with boundary_errors():
        before = moving_before_tables(scene)
    if before is None:
        return None
    full = (receipt or before.outputs.receipt) == "full"
    try:
        probed = _probed(_Written(scene.model_dump_json(), scene))
    except (InputError, SolveError):
        return None  # it will be said by the run, on its own tables
    with_errors = full and bool(before.meshes)
    seconds = probed.seconds(runs, with_errors=with_errors)
    return StudyCost((Work("run" if runs == 1 else "runs", seconds / runs, runs),))


@lru_cache(1)
def _probed(written: _Written) -> ProbedRun:
    from dynamics.simulation.run_cost import probe_run  # noqa: PLC0415 (start-up time)

    before = _moving(written)
    assert before is not None  # its caller has asked
    return probe_run(before)
