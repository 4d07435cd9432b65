"""Operating points inserted between those of a solved table: their solutions join its arrays.

An alignment is a misalignment and a change of the center distance. It has one operating point, also called a
place, whose `contact` is shared by all misalignments at one center distance. Operating points that the table
has stay the same objects, so that `id` tells them from new ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from fe_contact.analysis.pairs.contact_lines import solve_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoint, OperatingPoints, operating_points
from fe_contact.analysis.pairs.solved_contact import SolvedContact
from fe_contact.analysis.request.solved_run import edges_neglected
from fe_contact.analysis.tables import SolvedTable, assembled_table
from fe_contact.contact import ContactProblem
from fe_contact.ste import SteDatabase
from fe_contact.ste.fields import CENTER_DISTANCE, INSERTED, MISALIGNMENT
from fe_contact.types import FloatArray, Status

Alignments = dict[str, FloatArray]
"""Misalignments and changes of the center distance in m, by the name of the axis."""


def with_inserted_nodes(solved_table: SolvedTable, axis: str, further: FloatArray) -> SolvedTable | None:
    """Return a solved table with further nodes of an axis of alignments; None if a point there failed.

    Only the new operating points are solved, at the positions, loads and support loads of the table: what
    it has stays as it is. The table marks the nodes as inserted; its errors are not estimated.

    Parameters
    ----------
    axis : str
        "misalignment" or "center_distance_change".
    further : ndarray
        Nodes of the axis between those of the table, m.
    """
    axes = {name: getattr(solved_table.table, name) for name in (MISALIGNMENT, CENTER_DISTANCE)}
    axes[axis] = np.sort(np.concatenate([axes[axis], further]))
    places = _merged_places(solved_table, axes)
    old = {id(point): k for k, point in enumerate(solved_table.places.places)}
    new = [point for point in places.places if id(point) not in old]
    # two lists of contacts: at the loads, and at the support loads
    further_sets = _solved(solved_table, replace(places, places=tuple(new)))
    if further_sets is None:
        return None
    number = old | {id(point): len(old) + k for k, point in enumerate(new)}
    order = [number[id(point)] for point in places.places]
    contacts, support = (
        [[*known, *others][k] for k in order]
        for known, others in zip((solved_table.contacts, solved_table.support), further_sets, strict=True)
    )
    return replace(
        solved_table,
        places=places,
        contacts=contacts,
        support=support,
        solved=[(contact.problem, contact.solution) for contact in contacts],
        table=_marked_database(solved_table, axes, places, (contacts, support)),
    )


def alignment_points(solved_table: SolvedTable, axes: Alignments) -> OperatingPoints:
    """Return the operating points of alignments.

    Those at a center distance of the table have its contact, so that its compliance is not assembled again.
    """
    scene = replace(
        solved_table.checked.request.scene,
        misalignment=axes[MISALIGNMENT],
        center_distance_change=axes[CENTER_DISTANCE],
    )
    points = operating_points(
        scene, solved_table.checked.decision, solved_table.places.nominal, solved_table.places.workers
    )
    distances = solved_table.table.center_distance_change.tolist()
    known = dict(zip(distances, (point.contact for point in solved_table.places.places), strict=False))
    places = [
        replace(point, contact=known.get(distance, point.contact))
        for (_, distance), point in zip(_alignments(axes), points.places, strict=True)
    ]
    return replace(points, places=tuple(places))


def _merged_places(solved_table: SolvedTable, axes: Alignments) -> OperatingPoints:
    """Return the operating points of a table with more alignments; those it has are the same objects."""
    table_axes = {name: getattr(solved_table.table, name) for name in axes}
    old = dict(zip(_alignments(table_axes), solved_table.places.places, strict=True))
    points = alignment_points(solved_table, axes)
    places = [
        old.get(alignment, point) for alignment, point in zip(_alignments(axes), points.places, strict=True)
    ]
    return replace(points, places=tuple(places))


def _alignments(axes: Alignments) -> list[tuple[float, float]]:
    """Return the pairs of misalignment and center distance, the center distance running fastest."""
    return list(product(axes[MISALIGNMENT].tolist(), axes[CENTER_DISTANCE].tolist()))


def _solved(solved_table: SolvedTable, places: OperatingPoints) -> list[list[SolvedContact]] | None:
    """Solve operating points at the loads and support loads of a table; None if a point failed."""
    for point in places.places:
        take_compliance(solved_table, point)
    loads = solved_table.plan.load, solved_table.plan.support
    edges = edges_neglected(solved_table.checked)
    sets, _ = solve_operating_points(
        places, solved_table.nodes.position, loads, conditioned=False, edges=edges
    )
    needed = solved_table.plan.load, solved_table.table.support_force
    for load, contacts in zip(needed, sets, strict=True):
        for contact in contacts:
            columns = np.isin(contact.solution.load, load)
            if np.any(contact.solution.status[:, columns] != Status.CONVERGED):
                return None
    return sets


def take_compliance(solved_table: SolvedTable, point: OperatingPoint) -> None:
    """Give the contact of a place the compliance that the table has of it at its positions, if any."""
    contact, model, position = point.contact, point.model, solved_table.nodes.position
    if contact.cached_problem(model, position) is not None:
        return
    problem = _problem_of(solved_table, point)
    if problem is not None:
        plain = replace(problem, candidates=contact.candidates(model, position))
        contact.take(model, plain)


def _problem_of(solved_table: SolvedTable, operating_point: OperatingPoint) -> ContactProblem | None:
    """Return the problem of the table's first operating point with the contact of a place."""
    for point, contact in zip(solved_table.places.places, solved_table.contacts, strict=True):
        if point.contact is operating_point.contact:
            return contact.problem
    return None


def _marked_database(
    solved_table: SolvedTable,
    axes: Alignments,
    places: OperatingPoints,
    contacts: tuple[Sequence[SolvedContact], Sequence[SolvedContact]],
) -> SteDatabase:
    """Assemble the table of all operating points, and mark the nodes that were inserted."""
    request = replace(
        solved_table.checked.request,
        misalignment=axes[MISALIGNMENT],
        center_distance_change=axes[CENTER_DISTANCE],
    )
    table = assembled_table(request, places, solved_table.nodes, *contacts)
    marks: dict[str, Any] = {}
    for axis, name in INSERTED.items():
        inserted = ~np.isin(getattr(table, axis), getattr(solved_table.checked.request, axis))
        marks[name] = inserted.astype(np.int8) if inserted.any() else np.empty(0, np.int8)
    return replace(table, **marks)
