"""The mesh-force table of an STE database.

Axis letters: P positions, F stored loads, S support loads, M misalignments, D changes of the center distance,
L levels of the table, n pairs of teeth. A support load is solved to carry the table down to lift-off and
beyond the highest stored load; results do not show it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.errors import DatabaseError
from fe_contact.ste.fields import SteFields
from fe_contact.ste.force_table import ForceTable
from fe_contact.ste.interpolation import Axis, monotone_slopes, ordered_slopes
from fe_contact.ste.level_grid import deflection_grid, monotone_stiffness, stiffness_grid
from fe_contact.ste.load_levels import SMOOTHING, LoadLevels, refined_levels, smooth_share
from fe_contact.types import FloatArray, IntArray

SHORT_LINE = 1e-9
"""Half length of a line of contact over the width of the smoothed sign, below which it counts as a point."""


def sliding_sums(database: SteFields) -> tuple[FloatArray, FloatArray]:
    """Return sum of share sign(y) and sum of share |y| (m) over the pairs, both (P, F, M, D).

    `y` is the distance of a pair from the pitch point along the line of action, m. The sign is smoothed,
    y/sqrt(y^2 + h^2) with h of `SMOOTHING` base pitches. On helical teeth the load of a pair lies
    uniformly on its line of contact over the whole face, which spans b tan(beta_b) of the path.
    """
    gears = database.geometry
    phase = database.position - np.floor(database.position)
    y = (phase[:, None] + database.pair) * gears.base_pitch
    half = 0.5 * gears.face_width * math.tan(gears.base_helix_angle)
    direction, arm = _averages(y, half, SMOOTHING * gears.base_pitch)
    total = database.load_share.sum(axis=-1)
    share = database.load_share / np.where(total > 0.0, total, 1.0)[..., None]
    return np.einsum("pfmdn,pn->pfmd", share, direction), np.einsum("pfmdn,pn->pfmd", share, arm)


def _averages(y: FloatArray, half: float, width: float) -> tuple[FloatArray, FloatArray]:
    """Return the means of the smoothed sign(y) and of y sign(y) over y - half .. y + half."""
    if half <= SHORT_LINE * width:
        root = np.sqrt(y**2 + width**2)
        return np.asarray(y / root), np.asarray(y**2 / root)
    low, high = y - half, y + half
    root_low, root_high = np.sqrt(low**2 + width**2), np.sqrt(high**2 + width**2)
    arm = high * root_high - low * root_low - width**2 * (np.arcsinh(high / width) - np.arcsinh(low / width))
    return np.asarray((root_high - root_low) / (2.0 * half)), np.asarray(arm / (4.0 * half))


def force_table(database: SteFields) -> ForceTable:
    """Turn curves of STE over position at constant force into levels of a mesh force.

    Level 0 is lift-off: the no-load transmission error with zero stiffness. Every stored load is a level,
    with the inverse of the stored tangent compliance as stiffness; between loads where a further pair comes
    into contact there are more (`refined_levels`). Normal forces become transverse, F_bt = F_bn cos(beta_b).
    Raises `SolveError`: any point of the database failed; `DatabaseError`: the transmission error does not
    increase with load everywhere.
    """
    database.require_complete()
    _, order = _all_loads(database)
    loaded = _merged(database.pairs_in_contact, database.support_pairs_in_contact, order).astype(np.int64)
    pairs = np.concatenate([np.zeros_like(loaded[..., :1]), loaded], axis=-1)
    levels = refined_levels(_stored_levels(database), pairs, smooth_share(database.geometry))
    axis = Axis(database.position, float(database.period))
    deflection = deflection_grid((axis,), levels.deflection, (ordered_slopes(axis, levels.deflection),))
    unlimited = stiffness_grid((axis,), levels.stiffness, (monotone_slopes(axis, levels.stiffness),))
    stiffness = monotone_stiffness(unlimited, deflection, levels.force)
    flat = np.zeros_like(levels.deflection)  # the slopes of a table of one position
    sliding_share, sliding_lever = sliding_sums(database)
    arm = database.load_arm if database.load_arm.size else database.face_centroid
    return ForceTable(
        position=database.position,
        level=levels.force,
        misalignment=database.misalignment,
        center_distance_change=database.center_distance_change,
        # `nodal` is by order of the derivative in the position
        deflection=_position_third(deflection.nodal[(0,)]),
        deflection_slope=_position_third(deflection.nodal.get((1,), flat)),
        stiffness=_position_third(stiffness.nodal[(0,)]),
        stiffness_slope=_position_third(stiffness.nodal.get((1,), flat)),
        period=database.period,
        load_arm=_position_third(_at_levels(database, arm, levels.force)),
        sliding_share=_position_third(_at_levels(database, sliding_share, levels.force)),
        sliding_lever=_position_third(_at_levels(database, sliding_lever, levels.force)),
    )


def _at_levels(database: SteFields, stored: FloatArray, level: FloatArray) -> FloatArray:
    """Return a quantity of the stored loads (P, F, M, D) on all levels (P, M, D, L), linear in the force.

    Below the lowest stored load, down to lift-off, it has the value at that load; above the highest likewise.
    """
    force = level / math.cos(database.geometry.base_helix_angle)  # normal force
    above = np.clip(np.searchsorted(database.force, force), 1, max(database.force.size - 1, 1))
    if database.force.size == 1:
        return np.repeat(np.moveaxis(stored, 1, -1), level.size, axis=-1)
    low, high = database.force[above - 1], database.force[above]
    share = np.clip((force - low) / (high - low), 0.0, 1.0)
    values = np.moveaxis(stored, 1, -1)
    return np.asarray((1.0 - share) * values[..., above - 1] + share * values[..., above])


def _stored_levels(database: SteFields) -> LoadLevels:
    """Return the levels of lift-off, the stored and the support loads, by increasing load.

    Their stiffness is limited at the stored positions, so that the force increases with deflection there.
    """
    to_transverse = math.cos(database.geometry.base_helix_angle)
    force, order = _all_loads(database)
    tangent = _merged(database.tangent_compliance, database.support_tangent_compliance, order)
    loaded = _merged(database.static_transmission_error, database.support_transmission_error, order)
    deflection = np.concatenate([database.no_load_transmission_error[..., None], loaded], axis=-1)
    _require_increasing(database, force, deflection)
    stiffness = np.concatenate([np.zeros_like(tangent[..., :1]), to_transverse / tangent], axis=-1)
    level = np.concatenate([[0.0], force * to_transverse])
    return LoadLevels(level, deflection, np.minimum(stiffness, _knot_limit(deflection, level)))


def _all_loads(database: SteFields) -> tuple[FloatArray, IntArray]:
    """Return stored and support loads in increasing order, N, and the indices that sort them (F + S,)."""
    force = np.concatenate([database.force, database.support_force])
    order = np.argsort(force)
    return force[order], order


def _merged(stored: NDArray[Any], support: NDArray[Any], order: IntArray) -> NDArray[Any]:
    """Merge stored (P, F, M, D) and support values in order of load, (P, M, D, F + S)."""
    return np.moveaxis(np.concatenate([stored, support], axis=1)[:, order], 1, -1)


def _require_increasing(database: SteFields, force: FloatArray, deflection: FloatArray) -> None:
    """Raise `DatabaseError` where the deflection falls with load, with the point where it falls most."""
    gaps = np.diff(deflection, axis=-1)
    if np.all(gaps > 0.0):
        return
    i, m, c, k = np.unravel_index(np.argmin(gaps), gaps.shape)
    lower = f"force {force[k - 1]:g} N" if k else "no load"
    falling = np.count_nonzero(gaps <= 0.0)
    raise DatabaseError(
        f"the transmission error falls with load at {falling} of {gaps.size} steps, worst from "
        f"{lower} to {force[k]:g} N at position {database.position[i]:.6g}, misalignment "
        f"{database.misalignment[m]:g} m, center-distance change {database.center_distance_change[c]:g} m: "
        f"{gaps[i, m, c, k]:.3g} m. "
        "monotone_repaired() repairs it by isotonic regression and reports the change."
    )


def _knot_limit(deflection: FloatArray, level: FloatArray) -> FloatArray:
    """Return three times the smaller of the secants below and above each level, at the stored positions.

    A larger stiffness would make the cubic between two levels fall (`monotone_stiffness`).
    """
    secant = np.diff(level) / np.diff(deflection, axis=-1)
    beyond = np.full_like(secant[..., :1], np.inf)
    return np.asarray(
        3.0 * np.minimum(np.concatenate([beyond, secant], -1), np.concatenate([secant, beyond], -1))
    )


def _position_third(entry: FloatArray) -> FloatArray:
    """Reorder the axes of an array from (P, M, D, L) to (M, D, P, L)."""
    return np.moveaxis(entry, 0, 2)
