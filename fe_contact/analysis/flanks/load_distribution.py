"""Line load, pressure and gap along the contact lines at an operating point, and how even the load is.

A stretch is the part of the common face that one candidate of the contact problem represents. A slice of the
face has several stretches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from bounds.brief import brief
from bounds.plottable import Plottable
from fe_contact.analysis.flanks.flank_scene import FlankScene, flank_scene
from fe_contact.contact import ContactProblem, ContactSolution, contact_pressure
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Metadata
from fe_contact.types import BoolArray, Estimate, FloatArray, IntArray

if TYPE_CHECKING:
    import xarray


EDGE_STRETCHES = 6
"""Number of stretches over which a line load at an edge is averaged: that of a slice by default."""
Stretches = TypeVar("Stretches", FloatArray, BoolArray)

_PER_POSITION = ("position", "deflection", "roll_length_1", "roll_length_2", "on_path", "force", "lever",
                 "pressure", "gap")  # fmt: skip


@dataclass(frozen=True)
class FlankErrors:
    """Errors of figures of flank results over their values, or why there are none."""

    line_load: float | None = None
    """`line_load`, `pressure`: Relative errors of the largest values away from edges. None: not estimated."""
    face_load_factor: float | None = None
    largest_face_load_factor: float | None = None
    """`face_load_factor`, `largest_face_load_factor`: Relative errors of K_Hbeta over the cycle, and of the
    largest K_Hbeta at a position.
    """
    pressure: float | None = None
    edge_line_load: float | None = None
    """Relative error of the largest line load at edges, as a mean over a slice."""
    reason: str = "one solution tells no error"
    """Reason why errors that are None are not estimated."""
    kink_length: float = 0.0
    """Width of the contact strip with the largest pressure, m, where a relief begins with a kink inside it;
    else 0. The true pressure is infinite at the kink; the stated one is 4/pi times the mean over this width.
    """


@brief
@dataclass(frozen=True)
class LoadDistribution(Plottable):
    """One load on P positions, N tooth pairs and K stretches of the common face, several a slice."""

    position: FloatArray
    """Position of the driving gear, base pitches. Shape (P,)."""
    pair: IntArray
    """Pair indices; +1 is ahead. Shape (N,)."""
    face_position: FloatArray
    """Middles of the stretches, as distances from the pinion's mid-face, m. Shape (K,)."""
    deflection: FloatArray
    """Static transmission error, m. Shape (P,)."""
    roll_length_1: FloatArray
    roll_length_2: FloatArray
    """`roll_length_1`, `roll_length_2`: Roll lengths on either gear at which the flanks touch or come
    closest, m. Shape (P, N, K) each.
    """
    on_path: BoolArray
    """Whether any part of the stretch lies between A and E, where plain involutes touch. Shape (P, N, K)."""
    force: FloatArray
    """Normal force of each stretch, N. Shape (P, N, K)."""
    lever: FloatArray
    """Lever arm of that force about gear 1 over the base radius: 1, and about 1 at a tip edge. Shape (P, N,
    K).
    """
    pressure: FloatArray
    """Hertz's peak pressure of the line load in Pa; at a tip edge the true pressure is singular. Shape (P, N,
    K).
    """
    gap: FloatArray
    """Remaining gap between the loaded flanks along their normal, m: 0 in contact, infinite where they cannot
    touch. Shape (P, N, K).
    """
    slice_width: float
    """Width of a stretch along the face, m."""
    base_helix_angle: float
    """beta_b of gear 1, rad."""
    scene: FlankScene
    """The load, the alignment, and the marks on both flanks."""
    metadata: Metadata = field(default_factory=Metadata)
    """Case, effects, cost and versions."""
    at_edge: BoolArray | bool = False
    """Whether the strip reaches an edge of either flank; False in files without it. Shape (P, N, K)."""
    errors: FlankErrors = field(default_factory=FlankErrors)
    """Relative errors of the largest line load, of K_Hbeta and of the largest pressure."""

    @property
    def clear_pressure(self) -> FloatArray:
        """Pressure (P, N, K) where no edge is reached, Pa; 0 elsewhere."""
        return np.where(self.at_edge, 0.0, self.pressure)

    @property
    def edge_pressure(self) -> float:
        """Largest pressure at an edge, Pa, as if the flank went on: the true one is singular; 0 for none."""
        return float(np.max(np.where(self.at_edge, self.pressure, 0.0), initial=0.0))

    @property
    def line_load(self) -> FloatArray:
        """Force per length of contact line (P, N, K), N/m.

        Where a contact line ends inside a stretch, the length is still that of the whole stretch.
        """
        return self.force * (math.cos(self.base_helix_angle) / self.slice_width)

    @property
    def face_load(self) -> FloatArray:
        """Force of all pairs per unit of face width (P, K), N/m."""
        return np.asarray(self.force.sum(axis=1) / self.slice_width)

    @property
    def largest_line_load(self) -> Estimate:
        """Largest line load of all positions clear of edges, N/m: the mean over `slice_width` of the face."""
        clear = np.where(self.at_edge, 0.0, self.line_load)
        return _estimate(float(np.max(clear, initial=0.0)), self.errors.line_load, "N/m")

    @property
    def edge_length(self) -> float:
        """Length of the face over which a line load at an edge is averaged, m: that of a usual slice."""
        return self.slice_width * min(EDGE_STRETCHES, self.face_position.size)

    @property
    def edge_line_load(self) -> Estimate:
        """Largest line load at an edge, N/m: the mean over `edge_length` about it; 0 for none.

        It peaks over less than a slice where a line ends at a tip edge, by up to a third.
        """
        stretches = min(EDGE_STRETCHES, self.face_position.size)
        at_edge = np.broadcast_to(self.at_edge, self.force.shape) & (self.force > 0.0)
        edges = _windows(at_edge, stretches).any(axis=-1)
        means = _windows(self.line_load, stretches).mean(axis=-1)
        largest = np.max(np.where(edges, means, 0.0), initial=0.0)
        return _estimate(float(largest), self.errors.edge_line_load, "N/m")

    @property
    def largest_pressure(self) -> Estimate:
        """Largest pressure of all positions clear of edges, Pa."""
        return _estimate(float(np.max(self.clear_pressure, initial=0.0)), self.errors.pressure, "Pa")

    @property
    def cycle_face_load_factor(self) -> Estimate:
        """`mean_face_load_factor` with its error."""
        return _estimate(self.mean_face_load_factor, self.errors.face_load_factor, "1")

    @property
    def largest_face_load_factor(self) -> Estimate:
        """Largest `face_load_factor` of all positions."""
        largest = float(self.face_load_factor.max())
        return _estimate(largest, self.errors.largest_face_load_factor, "1")

    def at(self, positions: BoolArray) -> LoadDistribution:
        """Return the load distribution at some of the positions (P,), without errors."""
        per_position = {name: getattr(self, name)[positions] for name in _PER_POSITION}
        edge = np.broadcast_to(self.at_edge, self.force.shape)[positions]
        return replace(self, **per_position, at_edge=edge, errors=FlankErrors())

    @property
    def load_centroid(self) -> FloatArray:
        """Position along the face where the load of all pairs acts (P,), m; `face_centroid` of databases."""
        loaded = (self.force * self.lever).sum(axis=1)
        return np.asarray((loaded @ self.face_position) / loaded.sum(axis=1))

    @property
    def face_load_factor(self) -> FloatArray:
        """K_Hbeta of the mesh (P,): largest over mean load per unit of face width (ISO 6336-1, clause 7).

        On helical gears single positions exceed 1 even if aligned, because the number of touching pairs
        varies along the face; `mean_face_load_factor` is that of the cycle.
        """
        return _largest_over_mean(self.face_load)

    @property
    def mean_face_load_factor(self) -> float:
        """K_Hbeta of the face load averaged over all positions of a mesh cycle."""
        return float(_largest_over_mean(self.face_load.mean(axis=0)))

    @property
    def line_load_factor(self) -> FloatArray:
        """Largest over mean line load of all contact lines (P,); ends that carry nothing count as zeros."""
        positions = self.position.size
        return _over_mean_of(self.line_load.reshape(positions, -1), self._meshing.reshape(positions, -1))

    @property
    def pair_line_load_factor(self) -> FloatArray:
        """The same for each pair's own contact line (P, N); NaN for a pair that carries nothing."""
        return _over_mean_of(self.line_load, self._meshing)

    def to_xarray(self) -> xarray.Dataset:
        """Return all fields with units, and derived ones: line load, factors, contact patterns."""
        from fe_contact.analysis.flanks.flank_file import content  # noqa: PLC0415

        return content(self).to_xarray()

    def to_netcdf(self, path: Path) -> None:
        """Write a netCDF-4 file atomically."""
        from fe_contact.analysis.flanks.flank_file import content  # noqa: PLC0415

        content(self).write(Path(path))

    @classmethod
    def from_netcdf(cls, path: Path) -> LoadDistribution:
        """Read a file of `to_netcdf`; equal to the last bit.

        Raises `DatabaseError`: the file is missing, damaged, newer than this release, or of another kind.
        """
        from fe_contact.analysis.flanks.flank_file import read  # noqa: PLC0415

        return cls(**read(Path(path)))

    @property
    def _meshing(self) -> BoolArray:
        """Stretches that belong to a contact line: on the path of contact, or loaded at a tip edge."""
        return np.asarray(self.on_path | (self.force > 0.0))


def load_distribution(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    load: int = 0,
    *,
    misalignment: float = 0.0,
    center_distance_change: float = 0.0,
    metadata: Metadata | None = None,
) -> LoadDistribution:
    """Lay out a contact solution by pair and place along the face.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        At its center distance.
    solution : ContactSolution
        Converged at all positions.
    load : int
        Index of the load.
    misalignment, center_distance_change : float
        Alignment of the solution, m; it is stored in the scene.
    metadata : Metadata, optional
        Stored unchanged.
    """
    candidates = problem.candidates
    face = candidates.face_position[candidates.pair == candidates.pair[0]]
    shape = (candidates.position.size, -1, face.size)
    force = solution.force[:, load]
    pressure, edge = contact_pressure(problem, force[:, None])
    gap = _loaded_gap(problem, force, solution.deflection[:, load])
    phase = candidates.position - np.floor(candidates.position)
    # roll lengths of gear 1 on the line of action: off mid-face they are displaced by the helix
    nominal, _ = pair.roll_lengths(phase[:, None], candidates.pair)
    nominal = nominal - candidates.face_position * math.tan(candidates.base_helix_angle)
    path = pair.path_of_contact
    # half of the roll lengths that a contact line covers within a stretch
    reach = 0.5 * candidates.point_width * abs(math.tan(candidates.base_helix_angle))
    roll_1, roll_2 = rolls_at(pair, candidates.touch.s_1, candidates.touch.s_2)
    return LoadDistribution(
        position=candidates.position,
        pair=candidates.pair[:: face.size],
        face_position=face,
        deflection=solution.deflection[:, load],
        roll_length_1=roll_1.reshape(shape),
        roll_length_2=roll_2.reshape(shape),
        on_path=((nominal + reach >= path.start) & (nominal - reach <= path.end)).reshape(shape),
        force=force.reshape(shape),
        lever=candidates.torque_share.reshape(shape),
        pressure=pressure.reshape(shape),
        at_edge=edge.reshape(shape),
        gap=gap.reshape(shape),
        slice_width=candidates.point_width,
        base_helix_angle=candidates.base_helix_angle,
        scene=flank_scene(pair, solution.load[load], misalignment, center_distance_change),
        metadata=metadata or Metadata(),
    )


def _loaded_gap(problem: ContactProblem, force: FloatArray, deflection: FloatArray) -> FloatArray:
    """Return the gap of the candidates under load (P, m) along the normal, m; 0 where they carry force.

    Elastic displacements open the gap, and the rigid approach closes it.
    """
    candidates = problem.candidates
    bent = problem.displacement(force[:, None])[:, 0]
    approach = candidates.motion_arm * (deflection[:, None] - candidates.gap)
    return np.where(force > 0.0, 0.0, bent - approach)


def _estimate(value: float, relative: float | None, unit: str) -> Estimate:
    """Return a figure with its error; NaN where none is estimated."""
    return Estimate(value, math.nan if relative is None else relative * abs(value), unit)


def _windows(values: Stretches, count: int) -> Stretches:
    """Return windows of `count` neighboring stretches of values (..., K), (..., K + 1 - count, count)."""
    return np.lib.stride_tricks.sliding_window_view(values, count, axis=-1)


def _largest_over_mean(values: FloatArray) -> FloatArray:
    return np.asarray(values.max(axis=-1) / values.mean(axis=-1))


def _over_mean_of(values: FloatArray, among: BoolArray) -> FloatArray:
    """Return the largest over the mean of the last axis; the mean is over the entries `among` alone.

    NaN where all values are zero.
    """
    total = values.sum(axis=-1)
    scale = np.where(total > 0.0, total, np.nan)
    return np.asarray(values.max(axis=-1) * among.sum(axis=-1) / scale)
