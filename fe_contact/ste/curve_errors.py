"""Errors of the 23 quantities of a curve (`curve_quantities`) by source, as a table stores them."""

from __future__ import annotations

import numpy as np

from fe_contact.ste.fields import SteFields
from fe_contact.ste.node_errors import NodePlaces
from fe_contact.ste.operating_point import OperatingPoint
from fe_contact.types import FloatArray

PLANE, METHOD = "finite_width", "method"
"""Sources of error: the plane model in place of a solid; the method in place of full contact, on any mesh."""


AT_NODES = ("discretisation", "slices", "contact_solver", PLANE, "position", METHOD)
"""Sources that act at stored loads and alignments as well."""


BETWEEN_NODES = ("force", "misalignment", "center_distance_change")
"""Interpolation along each axis: zero at its nodes; stored at the lower node of every interval."""


SOURCES = AT_NODES + BETWEEN_NODES


DERIVATIVES = "derivatives"
"""A source at nodes that follows all others in tables of which some base pitches are not solved."""


OF_LOAD_ARM = ("discretisation", "slices", "position")
"""Sources of the errors of the load arm at stored loads and alignments."""


def source_words(source: str) -> str:
    """Return a source as sentences and tables name it; the key in files keeps its older spelling."""
    return source.replace("discretisation", "discretization").replace("_", " ")


def errors_by_source(table: SteFields, point: OperatingPoint) -> FloatArray:
    """Return the errors of the quantities (sources, 23) in m at one load and alignment.

    Linear between the nodes. NaN: not estimated.
    """
    # (sources, 23, F, M, D) to (F, M, D, sources, 23)
    values, interpolation = np.moveaxis(table.curve_error, (2, 3, 4), (0, 1, 2)), source_places(table, point)
    at_nodes = interpolation.at_nodes(np.delete(values, np.s_[len(AT_NODES) : len(SOURCES)], axis=3))[0]
    between = [
        interpolation.of_interval(values[..., source, :], i)[0]
        for i, source in enumerate(range(len(AT_NODES), len(SOURCES)))
    ]
    first, derivatives = np.split(at_nodes, [len(AT_NODES)])
    return np.concatenate([first, np.array(between), derivatives])


def source_places(table: SteFields, point: OperatingPoint) -> NodePlaces:
    """Return the place of one point between the nodes of a table."""
    coordinates = point.force, point.misalignment, point.center_distance_change
    return NodePlaces.of(table, *(np.array([value]) for value in coordinates))


def source_names(errors: FloatArray) -> tuple[str, ...]:
    """Return the names of the sources (9 or 10, ...) of the errors of a table."""
    return (*SOURCES, DERIVATIVES)[: len(errors)]


def all_sources(errors: FloatArray) -> FloatArray:
    """Return the error (23,) of all sources (sources, 23) together, m: the root of the sum of their squares.

    Meshes, slices, positions and nodes of the axes know nothing of each other, so that their errors are as
    likely to cancel as to add up. A sum states a third more and holds hardly more often (docs/accuracy.md).
    """
    return np.asarray(np.sqrt(np.square(errors).sum(axis=0)))
