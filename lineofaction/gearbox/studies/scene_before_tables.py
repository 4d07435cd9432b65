"""Scenes before their tables are computed: their motion, and how many freedoms they have."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from dynamics.assembly.assemble import System, assemble
from dynamics.mechanism.kinematics import at_steady_speeds
from dynamics.meshes.stiffness_table import PeriodicCurve, stiffness_table
from dynamics.meshes.technique import PlainTable
from dynamics.scene import Scene
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.iso6336_stiffness import STEEL_STIFFNESS
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.checked_case import CheckedCases
from lineofaction.gearbox.convert.plan import costs_of
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.scene import SceneInput

CASES = CheckedCases(16)
"""Cases whose costs were predicted last: cases that a scene or several verbs share are checked once."""

_POSITIONS = 48
"""Number of positions of a usual table in a base pitch."""


@dataclass(frozen=True)
class SceneText:
    """A scene whose text is the key of a cache: several verbs work on the same scene."""

    text: str
    scene: SceneInput = field(compare=False)
    positions: tuple[int, ...] = ()
    """Positions in a base pitch of the tables of the meshes with one; empty: those of usual tables."""


def _pairs(scene: SceneInput) -> dict[str, ParallelAxes] | None:
    cases = {mesh.name: mesh.case for _, mesh in scene.with_database}
    if not all(isinstance(case, Case) for case in cases.values()):
        return None
    return {name: CASES.of(case).feasible.request.pair for name, case in cases.items() if case}


def scene_before_tables(scene: SceneInput) -> Scene | None:
    """Return a scene at steady speeds on usual tables, placeholders for solids; None: it names tables."""
    before = moving_before_tables(scene)
    return None if before is None else at_steady_speeds(before)


def moving_before_tables(scene: SceneInput) -> Scene | None:
    """Return a scene as `scene_before_tables` does, in the motion of its run."""
    return scene_in_motion(SceneText(scene.model_dump_json(), scene))


@lru_cache(2)
def scene_in_motion(text: SceneText) -> Scene | None:
    """Return a scene on usual tables in the motion of its run; None: a mesh names a table."""
    scene = text.scene
    pairs = _pairs(scene)
    if pairs is None:
        return None
    geometry = {name: PairGeometry.of(pair) for name, pair in pairs.items()}
    positions = text.positions or (_POSITIONS,) * len(pairs)
    numbered = zip(pairs.items(), positions, strict=True)
    return check_scene(scene, geometry, {name: _usual_table(pair, count) for (name, pair), count in numbered})


def planned_positions(scene: SceneInput, cache: Path | None) -> tuple[int, ...]:
    """Return how many positions in a base pitch the tables of the meshes are planned to have.

    `cache`: directory of compliances. The cases of the scene are written out, and every mesh has one.
    """
    cases = [mesh.case for _, mesh in scene.with_database if mesh.case is not None]
    return tuple(costs_of(CASES.of(case), cache)[-1].positions for case in cases)


def _usual_table(pair: ParallelAxes, positions: int) -> PlainTable:
    """Return a table by the usual stiffness of pairs in contact, (0.75 pairs + 0.25) c' as in ISO 6336-1.

    Pairs of a helical gear come into contact over the overlap ratio. Measured on three units, a run on such
    tables takes 0.4 to 1.3 of the steps of one on computed tables; on tables of constant stiffness 0.35.
    """
    position = np.arange(positions) / positions
    across = np.linspace(0.0, pair.overlap_ratio, positions, endpoint=False)
    entered = (position[:, None] - across) % 1.0
    pairs = np.mean(np.ceil(pair.transverse_contact_ratio - entered), axis=1)
    stiffness = pair.face_width * STEEL_STIFFNESS * (0.75 * pairs + 0.25)
    return stiffness_table(PeriodicCurve.tabulated(position.tolist(), stiffness.tolist()))


def sized(scene: SceneInput, highest_hz: float | None = None, positions: tuple[int, ...] = ()) -> System:
    """Return the system of a scene before its tables, its shafts resolved to a frequency if one is named.

    `positions`: those of its tables in a base pitch; empty: those of usual tables.
    """
    return _system(SceneText(scene.model_dump_json(), scene, positions), highest_hz)


@lru_cache(4)
def _system(text: SceneText, highest_hz: float | None) -> System:
    moving = scene_in_motion(text)
    assert moving is not None  # checked by the callers
    before = at_steady_speeds(moving)
    return assemble(before if highest_hz is None else replace(before, highest_frequency=highest_hz))
