"""The stored arrays of an STE database, and the checks of their shapes and values.

Axes: P positions of all base pitches, F requested loads, M misalignments, D changes of the center distance, N
pairs of teeth, S support loads. A support load carries the interpolation between requested loads.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fe_contact.errors import DatabaseError, SolveError
from fe_contact.ste.metadata import Metadata, PairGeometry
from fe_contact.types import BoolArray, FloatArray, Status

GRID = ("position", "force", "misalignment", "center_distance_change")
SUPPORT = ("position", "support_force", "misalignment", "center_distance_change")
RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")

# dimensions of every stored array, in order
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "position": ("position",),
    "force": ("force",),
    "torque": ("force",),
    "misalignment": ("misalignment",),
    "center_distance_change": ("center_distance_change",),
    "pair": ("pair",),
    "static_transmission_error": GRID,
    "tangent_compliance": GRID,
    "no_load_transmission_error": ("position", "misalignment", "center_distance_change"),
    "load_share": (*GRID, "pair"),
    "face_centroid": GRID,
    "max_pressure": GRID,
    "pairs_in_contact": GRID,
    "status": GRID,
    "error_estimate": GRID,
    "residuals": (*GRID, "residual"),
    "support_force": ("support_force",),
    "support_transmission_error": SUPPORT,
    "support_tangent_compliance": SUPPORT,
    "support_pairs_in_contact": SUPPORT,
}
CURVE_ERROR = ("source", "quantity", "force", "misalignment", "center_distance_change")
"""Dimensions of the errors of mean, peak-to-peak and harmonics."""
OPTIONAL: dict[str, tuple[str, ...]] = {
    "edge_pressure": GRID,
    "load_arm": GRID,
    "curve_error": CURVE_ERROR,
    "load_arm_error": ("load_arm_source", *CURVE_ERROR[1:]),
    "pair_pressure": (*GRID, "pair"),
    "interval_error": ("axis", *CURVE_ERROR[2:]),
    "misalignment_inserted": ("misalignment",),
    "center_distance_inserted": ("center_distance_change",),
}
"""Dimensions of the arrays that some tables do not have: they are empty there."""
MISALIGNMENT, CENTER_DISTANCE = GRID[2:]
INSERTED = {MISALIGNMENT: "misalignment_inserted", CENTER_DISTANCE: "center_distance_inserted"}
"""Names of the marks of inserted nodes by axis. Inserted loads are support loads between two of the axis."""
INTEGER_TYPES: dict[str, type[np.signedinteger[Any]]] = {
    "pair": np.int64,
    "pairs_in_contact": np.int16,
    "support_pairs_in_contact": np.int16,
    "status": np.int8,
    "misalignment_inserted": np.int8,
    "center_distance_inserted": np.int8,
}


@dataclass(frozen=True, eq=False)
class SteFields:
    """Arrays on the grid position P x force F x misalignment M x center-distance change D; all read-only.

    Raises `DatabaseError`: shapes, order, signs or magnitudes contradict what follows.
    """

    position: FloatArray
    """Phase of the driving gear in transverse base pitches, increasing in [0, period). Shape (P,)."""
    force: FloatArray
    """Total normal tooth force F_bn in N, increasing, > 0. Shape (F,)."""
    torque: FloatArray
    """Torque on gear 1 of the loads, N m. Shape (F,)."""
    misalignment: FloatArray
    """Tilt of the axes in the plane of action as growth of the gap over the common face width, m; zero at the
    pitch point in mid-face. In tables without `load_arm` a helix slope, zero at mid-face. Shape (M,).
    """
    center_distance_change: FloatArray
    """Deviation from the nominal center distance, m. Shape (D,)."""
    pair: NDArray[np.int64]
    """Consecutive indices of the tooth pairs, counted anew at every whole pitch: pair j touches at phase
    `position` - floor(`position`) + j. Shape (N,).
    """
    static_transmission_error: FloatArray
    """Transmission error, m, > 0: the driven gear lags; NaN where the solve failed. Shape (P, F, M, D)."""
    tangent_compliance: FloatArray
    """d STE / d F_bn in m/N, > 0. Shape (P, F, M, D)."""
    no_load_transmission_error: FloatArray
    """Transmission error at first contact, m. Shape (P, M, D)."""
    load_share: FloatArray
    """Part of the load on each pair, >= 0, sums to 1. Shape (P, F, M, D, N)."""
    face_centroid: FloatArray
    """Offset of the load's centroid from mid-face, m. Shape (P, F, M, D)."""
    max_pressure: FloatArray
    """Largest contact pressure, Pa, away from edges, 0 where these alone carry; of tables without
    `edge_pressure` that of edges, too. Shape (P, F, M, D).
    """
    pairs_in_contact: NDArray[np.int16]
    status: NDArray[np.int8]
    """`pairs_in_contact`, `status`: Pairs that carry load; `fe_contact.types.Status`. Shape (P, F, M, D)."""
    error_estimate: FloatArray
    """Half-width of the error band of the STE, m, >= 0; NaN: not estimated. Shape (P, F, M, D)."""
    residuals: FloatArray
    """Equilibrium, penetration, tension, complementarity of the contact solution; NaN in base pitches that
    were not solved but follow from derivatives. Shape (P, F, M, D, 4).
    """
    geometry: PairGeometry
    metadata: Metadata
    support_force: FloatArray = field(default_factory=lambda: np.empty(0))
    """Further loads in N, not among `force`, solved only to carry the force extraction down to lift-off and
    beyond the highest load; S may be 0. Shape (S,).
    """
    support_transmission_error: FloatArray = field(default_factory=lambda: np.empty(0))
    support_tangent_compliance: FloatArray = field(default_factory=lambda: np.empty(0))
    support_pairs_in_contact: NDArray[np.int16] = field(default_factory=lambda: np.empty(0, np.int16))
    """`support_transmission_error`, `support_tangent_compliance`, `support_pairs_in_contact`: Arrays at the
    support loads, as the arrays of these names without `support`. Shape (P, S, M, D) each.
    """
    period: int = 1
    """Whole base pitches after which everything repeats: 1 where all teeth of a gear are alike."""
    curve_error: FloatArray = field(default_factory=lambda: np.empty((0,) * len(CURVE_ERROR)))
    """Errors of mean, peak-to-peak, any order that is no mesh order, and 20 harmonics in m, >= 0, by source
    (`ste.curve.SOURCES`, and `DERIVATIVES` where base pitches were not solved); NaN: not estimated. Empty for
    tables without, whose errors follow from the bands. Shape (9 or 10, 23, F, M, D).
    """
    edge_pressure: FloatArray = field(default_factory=lambda: np.empty((0,) * len(GRID)))
    """Largest pressure of the contacts that reach an edge of a flank, Pa: Hertz's as if the flank went on,
    where the true one is singular; 0 where none does. Empty for tables without. Shape (P, F, M, D).
    """
    load_arm: FloatArray = field(default_factory=lambda: np.empty((0,) * len(GRID)))
    """Arm of the load about the axis of a misalignment, m: over all points of the contact lines the mean of
    the offset from mid-face less tan(beta_b) times the way from the pitch point along the line of action. On
    spur gears `face_centroid`. Empty for tables without. Shape (P, F, M, D).
    """
    load_arm_error: FloatArray = field(default_factory=lambda: np.empty((0,) * len(CURVE_ERROR)))
    """Errors of the same quantities of it in m, >= 0, by source (`ste.curve.OF_LOAD_ARM`, and as above); NaN:
    not estimated. Empty for tables without. Shape (3 or 4, 23, F, M, D).
    """
    pair_pressure: FloatArray = field(default_factory=lambda: np.empty((0,) * (len(GRID) + 1)))
    """Largest contact pressure of each pair away from edges, Pa; `max_pressure` is that of all. Empty where
    the period is 1, and for older tables. Shape (P, F, M, D, N).
    """
    interval_error: FloatArray = field(default_factory=lambda: np.empty((0,) * len(GRID)))
    """Largest error of the transmission error between each node and the next of an axis, m, >= 0: of loads,
    misalignments, center distances; 0 after the last node, NaN: not estimated. Empty for older tables. Shape
    (3, F, M, D).
    """
    misalignment_inserted: NDArray[np.int8] = field(default_factory=lambda: np.empty(0, np.int8))
    center_distance_inserted: NDArray[np.int8] = field(default_factory=lambda: np.empty(0, np.int8))
    """`misalignment_inserted`, `center_distance_inserted`: 1 at nodes that were inserted to meet a tolerance
    between those requested, else 0. Empty where none was inserted. (M,), (D,) integer arrays.
    """

    def __post_init__(self) -> None:
        if np.size(self.support_force) == 0:
            shape = tuple(np.size(getattr(self, name)) for name in SUPPORT)
            for name in ("transmission_error", "tangent_compliance", "pairs_in_contact"):
                object.__setattr__(self, f"support_{name}", np.empty(shape))
        for name in (*DIMENSIONS, *OPTIONAL):
            values = getattr(self, name)
            try:
                array = np.array(values, dtype=INTEGER_TYPES.get(name, np.float64), order="C")
            except (TypeError, ValueError) as error:
                raise DatabaseError(f"{name} is no array of numbers") from error
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        _check_shapes(self)
        _check_axes(self)
        _check_values(self)

    @property
    def failed(self) -> BoolArray:
        """Grid points (P, F, M, D) without a usable solution."""
        return np.asarray(self.status != Status.CONVERGED)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about an implausible case or result, in words; empty where there are none."""
        return tuple(finding["message"] for finding in self.metadata.warnings)

    @property
    def stored(self) -> dict[str, tuple[str, ...]]:
        """Dimensions of the arrays that the table has, by name and in the order of its file."""
        return DIMENSIONS | {name: axes for name, axes in OPTIONAL.items() if getattr(self, name).size}

    @property
    def inserted_force(self) -> FloatArray:
        """Support loads between the loads of the table, N: with them interpolation meets a tolerance."""
        inside = (self.support_force > self.force[0]) & (self.support_force < self.force[-1])
        return np.asarray(self.support_force[inside])

    @property
    def inserted_misalignment(self) -> FloatArray:
        """Misalignments that nobody requested, m: with them interpolation meets a tolerance."""
        return self.misalignment[~self.requested_rows(MISALIGNMENT)]

    @property
    def inserted_center_distance_change(self) -> FloatArray:
        """Changes of the center distance that were inserted, not requested, m."""
        return self.center_distance_change[~self.requested_rows(CENTER_DISTANCE)]

    def requested_nodes(self, axis: str) -> FloatArray:
        """Return the nodes of an axis of alignments that were requested, m; `axis` is its name."""
        nodes: FloatArray = getattr(self, axis)[self.requested_rows(axis)]
        return nodes

    def requested_rows(self, axis: str) -> BoolArray:
        """Return whether each node of an axis of alignments was requested; `axis` is its name."""
        inserted = getattr(self, INSERTED[axis])
        return np.asarray(inserted == 0) if inserted.size else np.ones(getattr(self, axis).size, bool)

    @property
    def n_failed(self) -> int:
        """Number of grid points without a usable solution."""
        return int(np.count_nonzero(self.failed))

    def summary(self) -> str:
        """Return the extent of the table and what failed in it, in one or two lines."""
        extent = " x ".join(f"{getattr(self, name).size} {name}" for name in GRID)
        if self.period > 1:
            extent += f" over {self.period} base pitches"
        text = f"STE database: {extent}; force {self.force[0]:g} to {self.force[-1]:g} N"
        inserted = {
            "loads": self.inserted_force,
            "misalignments": self.inserted_misalignment,
            "center distances": self.inserted_center_distance_change,
        }
        text += "".join(f", {nodes.size} {name} inserted" for name, nodes in inserted.items() if nodes.size)
        if self.n_failed:
            return f"{text}\nWARNING: {self.failure_message()}"
        return f"{text}; all points converged"

    def failure_message(self, limit: int = 5) -> str:
        """Return number, reasons and positions of the points that failed (the first `limit`)."""
        points = np.argwhere(self.failed)
        listed = "; ".join(self._describe(tuple(point)) for point in points[:limit])
        more = f"; and {len(points) - limit} more" if len(points) > limit else ""
        return f"{len(points)} of {self.status.size} points FAILED ({listed}{more})"

    def _describe(self, point: tuple[int, ...]) -> str:
        units = ("", " N", " m", " m")
        coordinates = [
            f"{name} {getattr(self, name)[i]:.6g}{unit}"
            for name, i, unit in zip(GRID, point, units, strict=True)
        ]
        code = int(self.status[point])
        status = Status(code).name if code in set(Status) else f"status {code}"
        return f"{', '.join(coordinates)}: {status}"

    def require_complete(self) -> None:
        """Raise `SolveError`, with the table as its partial result, if any point failed."""
        if self.n_failed:
            remedy = "A finer mesh may solve them; allow_failed=True omits their rows."
            raise SolveError(f"{self.failure_message()}. {remedy}", self)

    def identical(self, other: SteFields) -> bool:
        """Whether every stored bit (NaN payloads included), fact and metadata entry agrees."""
        facts = ("geometry", "metadata", "period")
        return all(getattr(self, name) == getattr(other, name) for name in facts) and all(
            _same_bits(getattr(self, name), getattr(other, name)) for name in (*DIMENSIONS, *OPTIONAL)
        )


def _check_shapes(table: SteFields) -> None:
    sizes = {name: getattr(table, name).size for name in (*GRID, "pair", "support_force")}
    sizes["residual"] = len(RESIDUALS)
    for name, dimensions in DIMENSIONS.items():
        expected = tuple(sizes[dimension] for dimension in dimensions)
        actual = getattr(table, name).shape
        if actual != expected:
            raise DatabaseError(f"{name} has shape {actual}; ({', '.join(dimensions)}) needs {expected}")
    # arrays of `OPTIONAL` are empty, or have the shape of another array
    models = {"edge_pressure": "max_pressure", "load_arm": "max_pressure", "pair_pressure": "load_share"}
    for name, model in models.items():
        values = getattr(table, name)
        differs = values.size > 0 and values.shape != getattr(table, model).shape
        _refuse(differs, name, f"have the dimensions of {model}")
    nodes = table.static_transmission_error.shape[1:]
    for name in ("curve_error", "load_arm_error"):
        errors = getattr(table, name)
        differs = errors.size > 0 and errors.shape[2:] != nodes
        _refuse(differs, name, f"have the dimensions {', '.join(OPTIONAL[name])}")
    for axis, name in INSERTED.items():
        marks = getattr(table, name)
        _refuse(marks.size > 0 and marks.shape != (sizes[axis],), name, f"have the dimension {axis}")
    differs = table.interval_error.size > 0 and table.interval_error.shape != (3, *nodes)
    _refuse(differs, "interval_error", "have the dimensions 3, force, misalignment, center_distance_change")


def _check_axes(table: SteFields) -> None:
    """Check that axes are finite, increasing and inside their domain, and that loads are the torques."""
    for name in (*GRID, "pair"):
        axis = getattr(table, name)
        _refuse(axis.size == 0 or not np.all(np.isfinite(axis)), name, "be non-empty and finite")
        _refuse(bool(np.any(np.diff(axis) <= 0)), name, "be strictly increasing")
    repeated = np.intersect1d(table.force, table.support_force)
    _refuse(repeated.size > 0, "support_force", "repeat no stored load")
    _refuse(bool(np.any(np.diff(table.support_force) <= 0.0)), "support_force", "be strictly increasing")
    _refuse(not np.all(table.support_force > 0.0), "support_force", "be above 0 N")
    is_integer = isinstance(table.period, int) and not isinstance(table.period, bool)
    _refuse(not is_integer or table.period < 1, "period", "be a whole number of base pitches, 1 or more")
    beyond = table.position[0] < 0.0 or table.position[-1] >= table.period
    _refuse(beyond, "position", f"lie in [0, {table.period})")
    _refuse(table.force[0] <= 0.0, "force", "be above 0 N")
    _refuse(bool(np.any(np.diff(table.pair) != 1)), "pair", "be consecutive")
    carried = table.force * (table.geometry.base_radius[0] * math.cos(table.geometry.base_helix_angle))
    differs = not np.allclose(table.torque, carried, rtol=1e-9, atol=0.0)
    _refuse(differs, "torque", "equal F_bn cos(beta_b) r_b1 in N m")


def _check_values(table: SteFields) -> None:
    """Check that converged points hold numbers of plausible size and sign, and failed points NaN."""
    good = ~table.failed
    finite, compliance = np.isfinite(table.static_transmission_error), table.tangent_compliance
    _refuse(not np.all(finite == good), "static_transmission_error", "be finite exactly where converged")
    for name in ("static_transmission_error", "no_load_transmission_error"):
        # micrometers passed as meters are larger than the gear
        too_large = np.abs(getattr(table, name)) > table.geometry.base_radius[0]
        _refuse(bool(np.any(too_large)), name, "be in m (it exceeds the base radius)")
    not_finite = not np.all(np.isfinite(table.no_load_transmission_error))
    _refuse(not_finite, "no_load_transmission_error", "be finite")
    _refuse(not np.all(compliance[good] > 0.0), "tangent_compliance", "be above 0 m/N where converged")
    _refuse(not np.all(np.isfinite(compliance[good])), "tangent_compliance", "be finite where converged")
    for name in ("support_transmission_error", "support_tangent_compliance"):
        _refuse(not np.all(np.isfinite(getattr(table, name))), name, "be finite")
    share = table.load_share[good]
    _refuse(not np.all(share >= 0.0), "load_share", "be >= 0 where converged")
    sums_to_1 = np.allclose(share.sum(axis=-1), 1.0, rtol=0.0, atol=1e-6)
    _refuse(not sums_to_1, "load_share", "sum to 1 where converged")
    curves = {name: getattr(table, name) for name in ("curve_error", "load_arm_error", "interval_error")}
    for name, errors in {"error_estimate": table.error_estimate[good], **curves}.items():
        _refuse(bool(np.any(errors < 0.0)), name, "be >= 0 m, or NaN where not estimated")


def _refuse(wrong: bool, name: str, demand: str) -> None:
    if wrong:
        raise DatabaseError(f"{name} must {demand}")


def _same_bits(first: NDArray[Any], second: NDArray[Any]) -> bool:
    return first.dtype == second.dtype and first.shape == second.shape and first.tobytes() == second.tobytes()
