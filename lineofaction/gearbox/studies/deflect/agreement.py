"""Mesh load and shaft deflection in agreement: tables at the misalignments at which the meshes run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.deflection import Deflection, deflect
from dynamics.scene import Scene
from dynamics.settings.load_case import LoadCase
from lineofaction.gearbox.studies.deflect.mesh_contact import MeshContact
from model_studies.workers import InProcess, Workers

TOLERANCE = 1e-6
"""Change of every misalignment by the last pass, of its size or of `SMALL`."""
SMALL = 1e-6  # m
PASSES = 6
MARGIN, LEAST_MARGIN = 0.5, 2e-6
"""Of the first knots beyond the misalignments without contact: a part of their range, at least in m."""
CLOSEST = 2e-8
"""Least distance of knots, m: a closer one takes the place of the one before."""


@dataclass(frozen=True)
class Agreement:
    """The deflection with the tables that belong to it.

    `change`: largest change of a misalignment by the last pass, over its size or `SMALL`.
    """

    deflection: Deflection
    passes: int
    change: float

    @property
    def reached(self) -> bool:
        """Whether bodies and meshes agree."""
        return self.deflection.converged and self.change <= TOLERANCE


def in_agreement(
    scene: Scene,
    cases: Sequence[LoadCase],
    positions: int,
    contacts: Mapping[str, MeshContact],
    first: Deflection,
    complete: Callable[[Mapping[str, Sequence[float]]], object] = lambda _knots: None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> Agreement:
    """Deflect the scene until the misalignments are those of the tables.

    A table is exact at its knots, and each pass puts a knot where the meshes ran in the last one. Between
    knots bodies and mesh are in balance by Newton's method, so that soft shafts cost no more passes.

    Parameters
    ----------
    contacts : mapping
        Of the meshes whose load may vary over the face, by name.
    first : Deflection
        On the tables of the scene.
    complete : callable
        Called with the knots by mesh, m, before their tables are asked for.
    workers : Workers
        As of `deflect`.
    """
    if not contacts:
        return Agreement(first, 1, 0.0)
    stated = {mesh.name: mesh.misalignment for mesh in scene.meshes}
    knots = {name: _first_knots(_misalignments(first, name), stated[name]) for name in contacts}
    last, deflection, change, passes = first, first, float("inf"), 0
    while passes < PASSES:
        passes += 1
        complete(knots)
        tables = {name: contact.table(knots[name]) for name, contact in contacts.items()}
        meshes = tuple(replace(mesh, table=tables.get(mesh.name, mesh.table)) for mesh in scene.meshes)
        deflection = deflect(replace(scene, meshes=meshes), cases, positions, workers=workers)
        change = _change(last, deflection, contacts)
        if change <= TOLERANCE or not deflection.converged:
            break
        knots = {name: _with_knots(own, _misalignments(deflection, name)) for name, own in knots.items()}
        last = deflection
    return Agreement(deflection, passes, change)


def _misalignments(deflection: Deflection, mesh: str) -> list[float]:
    """Return the misalignments of a mesh over the load cases, m."""
    return [own.misalignment for case in deflection.cases for own in case.meshes if own.name == mesh]


def _first_knots(misalignments: Sequence[float], stated: float) -> list[float]:
    """Return knots from the misalignments without the moment of uneven loads, m, increasing.

    They reach to the misalignment that the scene states, at which its rest begins.
    """
    low, high = min(misalignments), max(misalignments)
    margin = max(MARGIN * (high - low), MARGIN * max(abs(low), abs(high)), LEAST_MARGIN)
    return _with_knots([min(low - margin, stated), max(high + margin, stated)], misalignments, 0.1 * margin)


def _with_knots(knots: Sequence[float], further: Sequence[float], closest: float = CLOSEST) -> list[float]:
    """Return knots with further ones, increasing; of closer ones than `closest` the later stays."""
    kept = list(knots)
    for knot in further:
        kept = [*(own for own in kept if abs(own - knot) >= closest), knot]
    return sorted(kept)


def _change(last: Deflection, deflection: Deflection, contacts: Mapping[str, MeshContact]) -> float:
    """Return the largest change of a misalignment, over its size or `SMALL`."""
    changes = [0.0]
    for name in contacts:
        before, now = (np.array(_misalignments(each, name)) for each in (last, deflection))
        changes.append(float(np.max(np.abs(now - before) / np.maximum(np.abs(now), SMALL))))
    return max(changes)
