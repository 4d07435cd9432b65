"""The mesh-force table: all that dynamics knows of a gear contact."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from dynamics.checks import increasing, integer
from dynamics.errors import InputError
from dynamics.identity_cache import identity_cached
from dynamics.types import FloatArray

DERIVATIVES = ("deflection_derivative", "stiffness_derivative")
"""Optional fields of shape (2, 2, 2, M, D, P, L)."""
LEVERS = ("load_arm", "sliding_share", "sliding_lever")
"""Optional fields of shape (M, D, P, L)."""
FIELDS = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
"""Fields that every table has, of shape (M, D, P, L)."""
LARGEST_PERIOD = 1_000_000  # most base pitches after which a table repeats


@runtime_checkable
class MeshTable(Protocol):
    """Mesh force against position and deflection, as plain arrays (docs/reference/contracts.md).

    Attributes
    ----------
    position : (P,) array
        Knots in transverse base pitches of the driving gear, increasing in [0, period).
    period : int
        Whole base pitches after which the table repeats: 1 if all teeth are equal.
    level : (L,) array
        Transverse mesh force in N at the levels, increasing, ``level[0] = 0`` (lift-off).
    misalignment, center_distance_change : (M,), (D,) arrays
        Knots in m; length 1 = no such axis.
    deflection : (M, D, P, L) array
        Transmission error in m at each level, strictly increasing along the levels.
    deflection_slope : (M, D, P, L) array
        Derivative of the deflection in position, m per base pitch.
    stiffness, stiffness_slope : (M, D, P, L) arrays
        Tangent stiffness dF/d(deflection) in N/m at the knots and its derivative in position.

    Optional, for effects that need them (None or left out: absent):

    deflection_derivative, stiffness_derivative : (2, 2, 2, M, D, P, L) arrays
        Derivatives of deflection and stiffness. Each of the first three indices is 1 where the field is
        differentiated once in misalignment, center-distance change and position, and else 0.
    load_arm : (M, D, P, L) array
        Arm of the load about the axis of a misalignment, m: mean distance from mid-face of the driving gear
        along z, less tan(beta_b) times the distance from the pitch point along the line of action. Seen from
        positive z the driving gear turns clockwise.
    sliding_share, sliding_lever : (M, D, P, L) arrays
        Sums over the pairs of load share times the sign of y, and times `abs(y)` (m), y the position of a
        pair's contact from the pitch point, > 0 in recess.
    """

    @property
    def position(self) -> FloatArray: ...  # noqa: D102
    @property
    def period(self) -> int: ...  # noqa: D102
    @property
    def level(self) -> FloatArray: ...  # noqa: D102
    @property
    def misalignment(self) -> FloatArray: ...  # noqa: D102
    @property
    def center_distance_change(self) -> FloatArray: ...  # noqa: D102
    @property
    def deflection(self) -> FloatArray: ...  # noqa: D102
    @property
    def deflection_slope(self) -> FloatArray: ...  # noqa: D102
    @property
    def stiffness(self) -> FloatArray: ...  # noqa: D102
    @property
    def stiffness_slope(self) -> FloatArray: ...  # noqa: D102


@identity_cached
def check_table(table: MeshTable, field: str) -> None:
    """Raise `InputError` if `table` breaks the protocol's shapes, orders or signs; `field` names it."""
    if not isinstance(table, MeshTable):
        raise InputError(field, type(table).__name__, "a mesh-force table", "Use SteDatabase.force_table().")
    period = integer(f"{field}.period", table.period, 1, LARGEST_PERIOD)
    position = increasing(f"{field}.position", table.position)
    level = increasing(f"{field}.level", table.level)
    if position[0] < 0.0 or position[-1] >= period:
        bound = f"in [0, {period}), the table's period"
        raise InputError(f"{field}.position", (position[0], position[-1]), bound)
    if level[0] != 0.0 or level.size < 2:
        raise InputError(f"{field}.level", level.tolist(), "at least two forces, the first 0")
    shape = (np.size(table.misalignment), np.size(table.center_distance_change), position.size, level.size)
    of_derivatives = (2, 2, 2, *shape)
    for names, expected in ((FIELDS, shape), (DERIVATIVES, of_derivatives), (LEVERS, shape)):
        for name in names:
            if names is not FIELDS and getattr(table, name, None) is None:
                continue
            values = np.asarray(getattr(table, name))
            if values.shape != expected or not np.all(np.isfinite(values)):
                raise InputError(f"{field}.{name}", f"shape {values.shape}", f"finite, of shape {expected}")
    if np.any(np.diff(table.deflection, axis=-1) <= 0.0):
        raise InputError(f"{field}.deflection", "not increasing", "strictly increasing along the levels")
    if np.any(np.asarray(table.stiffness) < 0.0) or np.any(np.asarray(table.stiffness)[..., -1] == 0.0):
        raise InputError(f"{field}.stiffness", "negative", "0 or above, and above 0 at the last level")
