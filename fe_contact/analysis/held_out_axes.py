"""Interpolation error of a table between the nodes of its axes, measured at points it does not hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.sampled import LOADS, sample_of, spread
from fe_contact.analysis.table_places import Place, Places, table_places
from fe_contact.effects import ContactScene
from fe_contact.errors import DatabaseError
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_quantities import QUANTITIES, quantity_changes
from fe_contact.ste.fields import DIMENSIONS
from fe_contact.types import FloatArray, IntArray, Json

LOAD_PROBES = np.array([0.25, 0.5, 0.75])
"""Held-out loads in every interval, on a logarithmic scale: a kink rounds the curve anywhere in it."""
FEWEST = 32
"""Positions at which loads and misalignments are judged, at least, if the table has as many."""
POSITIONS = 16
"""Positions at which an interval of centre distances is judged: each needs a compliance of its own."""

Curves = tuple[FloatArray, FloatArray]
"""Interpolant and solutions, (positions, L) in m."""


@dataclass(frozen=True)
class AxisError:
    """Error of STE between the nodes of one axis.

    Attributes
    ----------
    at : ndarray, shape (I,)
        The middle of every interval: of loads the geometric mean in N, beside which the quarters are held
        out, too; of misalignments or changes of the centre distance in m.
    error : ndarray, shape (I, L) or (I, 1)
        Largest difference between interpolant and solution over the positions in m, at each load of the
        table; of the held-out loads themselves for the axis of loads. NaN where a solution did not converge.
    change : ndarray, shape (22, I, L) or (22, I, 1)
        What that does to mean, peak-to-peak and harmonics, m; bounds of it from `error` for centre distances,
        which are not judged at all positions.
    """

    at: FloatArray
    error: FloatArray
    change: FloatArray

    def to_json(self) -> Json:
        """Return plain JSON; intervals without a solution hold null."""
        rows = [[float(e) if np.isfinite(e) else None for e in row] for row in self.error]
        return {"at": self.at.tolist(), "error_m": rows}


def held_out_axes(
    table: SteDatabase, places: Places, scene: ContactScene, choices: Mapping[str, str]
) -> dict[str, AxisError]:
    """Solve one held-out point in every interval of every axis that has one.

    Positions are some of the table's, so that the axis alone is interpolated; what is missed between
    positions `table_nodes` measures. Loads and misalignments are judged at 32 of them or more; centre
    distances at those where the curves of the neighbouring nodes differ most. On the other axes the point
    stands at the node nearest to zero; a longer period is judged in its first pitch.

    Parameters
    ----------
    table : SteDatabase
        As computed.
    places : Places
        That it was computed at.
    scene : ContactScene
        With the axes of the table.
    choices : mapping
        Effect name to "on" or "off", as decided for the whole table.

    Returns
    -------
    dict of str to AxisError
        By the name of the axis; empty for a table with failed points, or whose transmission error does not
        rise with load everywhere: neither can be interpolated.
    """
    if table.n_failed:
        return {}
    table = _first_pitch(table)
    try:
        table.force_table()
    except DatabaseError:
        return {}
    return _measured(table, places, scene, choices)


def _first_pitch(table: SteDatabase) -> SteDatabase:
    """Return the first base pitch of a longer period: at its own positions the rest does not matter."""
    if table.period == 1:
        return table
    rows = int(np.searchsorted(table.position, 1.0))
    arrays = {
        name: getattr(table, name)[:rows]
        for name, dimensions in DIMENSIONS.items()
        if dimensions[0] == "position"
    }
    return replace(table, **arrays, period=1)


def _measured(
    table: SteDatabase, places: Places, scene: ContactScene, choices: Mapping[str, str]
) -> dict[str, AxisError]:
    """Measure every axis of two nodes or more."""

    def curves(place: Place, rows: IntArray, load: FloatArray, *alignment: float) -> Curves:
        """Interpolant and solutions (positions, L), m; NaN where one did not converge."""
        position = table.position[rows]
        solved = place.solve(position, load)[1].deflection
        return table.ste(position[:, None], load, *alignment), solved

    def changes(found: Curves) -> FloatArray:
        """Return the changes of the quantities, (22, L) in m."""
        return quantity_changes(table.position[everywhere], *found, 1)

    found = {}
    everywhere = _some(int(np.searchsorted(table.position, 1.0)))
    m, d = _nearest(table.misalignment), _nearest(table.center_distance_change)
    if table.force.size > 1:
        loads = table.force[:-1, None] ** (1.0 - LOAD_PROBES) * table.force[1:, None] ** LOAD_PROBES
        (place,) = _places(places, scene, choices, m, d)
        pair = curves(place, everywhere, loads.ravel(), m[0], d[0])
        error = _worst(pair).reshape(loads.shape).max(axis=1)
        change = changes(pair).reshape(-1, *loads.shape).max(axis=2)
        found["force"] = AxisError(loads[:, 1], error[:, None], change[..., None])
    if table.misalignment.size > 1:
        middles = _middles(table.misalignment)
        held_out = zip(_places(places, scene, choices, middles, d), middles, strict=True)
        some = sample_of(table.force.size, LOADS)
        pairs = [curves(place, everywhere, table.force[some], x, d[0]) for place, x in held_out]
        change = spread(table.force, some, np.stack([changes(pair) for pair in pairs], axis=1), 2)
        error = spread(table.force, some, np.array([_worst(pair) for pair in pairs]), 1)
        found["misalignment"] = AxisError(middles, error, change)
    if table.center_distance_change.size > 1:
        middles = _middles(table.center_distance_change)
        held_out = zip(_places(places, scene, choices, m, middles), middles, strict=True)
        errors = np.array(
            [
                _worst(curves(place, rows, table.force, m[0], x))
                for (place, x), rows in zip(held_out, _telling(table), strict=True)
            ]
        )
        bounds = np.stack([errors, *[2.0 * errors] * (QUANTITIES - 1)])
        found["center_distance_change"] = AxisError(middles, errors, bounds)
    return found


def _some(rows: int) -> IntArray:
    """Return at least `FEWEST` rows of a base pitch, evenly taken."""
    return np.arange(0, rows, max(rows // FEWEST, 1))


def _worst(found: Curves) -> FloatArray:
    """Largest difference (L,) over the positions, m."""
    return np.asarray(np.abs(found[0] - found[1]).max(axis=0))


def _telling(table: SteDatabase) -> list[IntArray]:
    """Return the rows of the first pitch that tell most of the error of every interval of centre distances.

    Those in which the transmission errors at its two ends differ most, in parts of their largest difference
    at each load: there handovers move.
    """
    count = int(np.searchsorted(table.position, 1.0))
    m = int(np.argmin(np.abs(table.misalignment)))
    step = np.abs(np.diff(table.static_transmission_error[:count, :, m, :], axis=2))
    telling = (step / np.maximum(step.max(axis=0), 1e-300)).max(axis=1)
    return [np.sort(np.argsort(column, kind="stable")[-POSITIONS:]) for column in telling.T]


def _middles(nodes: FloatArray) -> FloatArray:
    """Return the middles of the intervals."""
    return np.asarray(0.5 * (nodes[:-1] + nodes[1:]))


def _nearest(nodes: FloatArray) -> FloatArray:
    """Return the node nearest to zero, as an axis of one."""
    return nodes[[int(np.argmin(np.abs(nodes)))]]


def _places(
    places: Places,
    scene: ContactScene,
    choices: Mapping[str, str],
    misalignment: FloatArray,
    change: FloatArray,
) -> tuple[Place, ...]:
    """Lay out held-out places like those of the table."""
    here = replace(scene, misalignment=misalignment, center_distance_change=change)
    return table_places(here, choices, places.nominal).places
