"""How wrong mean, peak-to-peak and harmonics are, by source.

Each quantity is computed from nested discretisations, the run's own and a rougher one, and the change between
the two is carried on to the error that is left by the order known of the discretisation, as the point bands
are (`error_estimate`). Errors common to all positions so count in the mean alone, and what bends the curve in
peak-to-peak and harmonics. Between the nodes of an axis the changes at held-out points count.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fe_contact.analysis.error_estimate import CORRECTION_ERROR_OF_CURVES, Nested, contact_error
from fe_contact.analysis.held_out_axes import AxisError
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.table_places import Places
from fe_contact.planning import FaceDiscretisation, Plan
from fe_contact.ste.curve_errors import AT_NODES, BETWEEN_NODES, SOURCES
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    missed_peaks,
    quantity_changes,
)
from fe_contact.types import FloatArray, Json

LEFT_BY_MIDDLES = 4.0 / 3.0
"""Error of the positions over what their middles change: second order. Peaks at handovers, which would fall
with the first power of the spacing, are looked for by themselves (`missed_peaks`)."""
LEFT_BY_MESH = {"plane": (0.25, 0.25, 0.29), "spur": (1.25, 2.6, 2.3), "helical": (1.5, 1.5, 1.6)}
"""Error left of mean, peak-to-peak and harmonics over the change to the coarse mesh: in the plane, of
elements half as large, orders 2.1 to 2.3; over the face, of elements of two thirds, orders 0.8 to 1.5, which
are not so small yet that errors fall with their square. Set on the cases of docs/accuracy.md not held out."""
SHOWN = {"mean_m": MEAN, "peak_to_peak_m": PEAK_TO_PEAK, "first_harmonic_m": FIRST_HARMONIC}


def curve_errors(
    places: Places, nested: Nested, nodes: PositionNodes, plan: Plan, stands_in: float = 0.0
) -> FloatArray:
    """Return the errors at the nodes of the table, (5, 22, F, M, D) in m: sources `AT_NODES`.

    `stands_in` is the relative error of plane strain where it stands in for a finite width uncorrected.
    """
    made = plan.discretisation
    knots = (np.arange(places.period)[:, None] + nodes.position).ravel()

    def changes(these: list[FloatArray], those: list[FloatArray], part: FloatArray | float) -> FloatArray:
        """Parts of the changes of every place, (22, F, M, D)."""
        pairs = zip(these, those, strict=True)
        found = [quantity_changes(knots, a, b, places.period) for a, b in pairs]
        return places.gathered([part * change for change in found])

    solver = [
        error_bound(knots, contact_error(solution), solution.deflection, places.period)
        for solution in nested.fine
    ]
    free_ends = changes(nested.table, nested.plane, CORRECTION_ERROR_OF_CURVES)
    if stands_in:
        free_ends = changes(nested.table, [np.zeros_like(curve) for curve in nested.table], stands_in)
    by_source = {
        "discretisation": changes(
            nested.plane, nested.coarse, _left_by_mesh(plan, places.nominal.pair.base_helix_angle != 0.0)
        ),
        "slices": changes(nested.table, nested.sliced, made.remaining_slices),
        "contact_solver": places.gathered(solver),
        "finite_width": free_ends,
        "position": places.gathered([_positions(nodes, knots, places.period, plan)] * len(nested.fine)),
    }
    return np.stack([by_source[name] for name in AT_NODES])


def _left_by_mesh(plan: Plan, helical: bool) -> FloatArray:
    """Error left over the change to the coarse mesh, (22, 1)."""
    over_face = isinstance(plan.discretisation, FaceDiscretisation)
    mean, ripple, harmonics = LEFT_BY_MESH[("helical" if helical else "spur") if over_face else "plane"]
    return np.array([mean, ripple, *[harmonics] * (QUANTITIES - FIRST_HARMONIC)])[:, None]


def _positions(nodes: PositionNodes, knots: FloatArray, period: int, plan: Plan) -> FloatArray:
    """Errors (22, F) of the judged curves for lack of positions, the largest at each load."""
    axis = np.append(knots, period)
    everywhere = np.sort(np.concatenate([knots, 0.5 * (axis[1:] + axis[:-1])]))
    both = np.stack([nodes.value, nodes.middle], axis=1).reshape(everywhere.size, -1)
    change = quantity_changes(knots, nodes.value, both, period, everywhere)
    change *= LEFT_BY_MIDDLES
    missed = np.ptp(both, axis=0) - np.ptp(nodes.value, axis=0) + missed_peaks(everywhere, both, period)
    change[PEAK_TO_PEAK] = np.maximum(change[PEAK_TO_PEAK], missed)
    worst: FloatArray = change.reshape(QUANTITIES, -1, plan.load.size).max(axis=1)
    return worst


def with_axes(at_nodes: FloatArray, axes: Mapping[str, AxisError]) -> FloatArray:
    """Append the interpolation along the axes: (8, 22, F, M, D).

    What was judged at one alignment stands for all of them. An interval that was not judged has NaN.
    """
    shape = at_nodes.shape[1:]
    between = []
    for i, name in enumerate(BETWEEN_NODES):
        errors = np.zeros(shape)
        intervals = np.moveaxis(errors, 1 + i, 1)[:, : shape[1 + i] - 1]  # a view
        intervals[...] = axes[name].change[..., None] if name in axes else np.nan
        between.append(errors)
    return np.concatenate([at_nodes, np.stack(between)])


def unestimated(places: Places, plan: Plan) -> FloatArray:
    """Return the errors of a run in which none was estimated, (8, 22, F, M, D): NaN."""
    return np.full((len(SOURCES), QUANTITIES, plan.load.size, *places.shape), np.nan)


def summary(errors: FloatArray) -> Json:
    """Return the largest over the alignments of each source by load, m, and what was not estimated.

    A source is not estimated if it is unknown anywhere.
    """
    known = {name: source for name, source in zip(SOURCES, errors, strict=True) if not np.isnan(source).any()}
    found = {
        name: {label: source[i].max(axis=(1, 2)).tolist() for label, i in SHOWN.items()}
        for name, source in known.items()
    }
    return {"curve_error": found, "not_estimated": [name for name in SOURCES if name not in known]}
