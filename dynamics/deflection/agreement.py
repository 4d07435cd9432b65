"""Mesh load and shaft deflection in agreement: tables at the misalignments at which the meshes run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from dynamics.deflection.deflect import Deflection, deflect
from dynamics.meshes import MeshTable
from dynamics.scene import Scene
from dynamics.settings.load_case import LoadCase
from model_studies.workers import InProcess, Workers

TOLERANCE = 1e-6
"""Largest change of a misalignment by the last pass, over its size or `SMALL`."""
SMALL = 1e-6
"""Misalignment, m: the change of a smaller one is divided by this size, not by its own."""
PASSES = 6
"""Most passes between table and deflection."""
MARGIN = 0.5
"""Distance of the outermost first knots beyond the misalignments, over their range or the largest of them."""
MIN_MARGIN = 2e-6
"""Least distance of the outermost first knots beyond the range of misalignments, m."""
CLOSEST = 2e-8
"""Least distance of knots, m: a closer one takes the place of the one before."""


class FaceContact(Protocol):
    """The contact of a mesh whose load may vary over the face."""

    def table(self, misalignments: Sequence[float], /) -> MeshTable:
        """Return the mesh-force table over misalignments, m, increasing."""


@dataclass(frozen=True)
class Agreement:
    """The deflection with the tables that belong to it."""

    deflection: Deflection
    passes: int
    change: float
    """Largest change of a misalignment by the last pass, over its size or `SMALL`."""

    @property
    def reached(self) -> bool:
        """Whether bodies and meshes agree."""
        return self.deflection.converged and self.change <= TOLERANCE


def in_agreement(
    scene: Scene,
    cases: Sequence[LoadCase],
    positions: int,
    contacts: Mapping[str, FaceContact],
    first: Deflection,
    prepare: Callable[[Mapping[str, Sequence[float]]], object] = lambda _knots: None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Agreement:
    """Deflect the scene until the misalignments are those of the tables.

    A table is exact at its knots, and each pass puts a knot where the meshes ran in the last one. Between
    knots bodies and mesh are in balance by Newton's method, so that soft shafts cost no more passes.

    Parameters
    ----------
    contacts : mapping
        Contacts of the meshes whose load may vary over the face, by name.
    first : Deflection
        Deflection with the tables of the scene.
    prepare : callable
        Called with the knots by mesh, m, before their tables are asked for; it may compute all at once.
    workers : Workers
        Workers as in `deflect`.
    """
    if not contacts:
        return Agreement(first, 1, 0.0)
    in_scene = {mesh.name: mesh.misalignment for mesh in scene.meshes}
    knots = {name: _first_knots(_misalignments(first, name), in_scene[name]) for name in contacts}
    deflection, passes, change = first, 0, float("inf")
    while passes < PASSES:
        passes += 1
        prepare(knots)
        tables = {name: contact.table(knots[name]) for name, contact in contacts.items()}
        meshes = tuple(replace(mesh, table=tables.get(mesh.name, mesh.table)) for mesh in scene.meshes)
        last = deflection
        deflection = deflect(replace(scene, meshes=meshes), cases, positions, workers=workers)
        change = _change(last, deflection, contacts)
        if change <= TOLERANCE or not deflection.converged:
            break
        knots = {name: _with_knots(row, _misalignments(deflection, name)) for name, row in knots.items()}
    return Agreement(deflection, passes, change)


def _misalignments(deflection: Deflection, name: str) -> list[float]:
    """Return the misalignments of a mesh over the load cases, m."""
    return [mesh.misalignment for case in deflection.cases for mesh in case.meshes if mesh.name == name]


def _first_knots(misalignments: Sequence[float], in_scene: float) -> list[float]:
    """Return first knots, m, increasing, about misalignments found without the moment of uneven loads.

    They reach to the misalignment that the scene states, at which the search for rest positions begins.
    """
    low, high = min(misalignments), max(misalignments)
    margin = max(MARGIN * max(high - low, abs(low), abs(high)), MIN_MARGIN)
    ends = [min(low - margin, in_scene), max(high + margin, in_scene)]
    return _with_knots(ends, misalignments, closest=0.1 * margin)  # a first table needs no closer knots


def _with_knots(knots: Sequence[float], further: Sequence[float], closest: float = CLOSEST) -> list[float]:
    """Return knots with further ones, increasing; of closer ones than `closest` the later stays."""
    row = list(knots)
    for knot in further:
        row = [*(earlier for earlier in row if abs(earlier - knot) >= closest), knot]
    return sorted(row)


def _change(last: Deflection, deflection: Deflection, meshes: Mapping[str, object]) -> float:
    """Return the largest change of a misalignment of the meshes, over its size or `SMALL`."""
    changes = [0.0]
    for name in meshes:
        before, now = (np.array(_misalignments(result, name)) for result in (last, deflection))
        changes.append(float(np.max(np.abs(now - before) / np.maximum(np.abs(now), SMALL))))
    return max(changes)
