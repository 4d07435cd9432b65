"""Records of full finite-element contact: the truth that the accuracy study compares its fidelities with.

`full_contact_records.json` holds the curves of a few pairs; `python -m benchmarks.full_contact_records`
writes it, and names there the version of the solver and the pairs. Arrays run along M misalignments, P
positions and T torques.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from bounds import written
from fe_contact.analysis.request.request import Checked
from fe_contact.ste import SteDatabase
from fe_contact.types import BoolArray, FloatArray, Json

NAME = "full_contact"
PROGRAM = "full contact by condensation"
PLANE, FACE = "plane strain", "three dimensions"
RECORDS = Path(__file__).with_name("full_contact_records.json")
NO_RECORD = (
    "no curves of this pair in this model and under these loads are recorded; a clone of the project "
    "computes them: python -m benchmarks.full_contact_records CASE"
)
SAME = 1e-9
"""Relative difference up to which two dimensions of a gear are the same number in other units."""


@dataclass(frozen=True)
class FullContactRecord:
    """The transmission error of a pair by full contact at a few positions, as it was solved once."""

    pair: Json
    """Gears and shafts in SI, as `bounds.written` writes them."""
    version: str
    """Version of the solver."""
    solved_in: str
    """Plane strain or three dimensions."""
    misalignment: FloatArray
    """Misalignment, m. Shape (M,)."""
    position: FloatArray
    """Position of the driving gear, base pitches. Shape (P,)."""
    torque: FloatArray
    """Torque on the driving gear, N m. Shape (T,)."""
    transmission_error: FloatArray
    """Transmission error, m; NaN where there is no solution. Shape (M, P, T)."""
    error_estimate: FloatArray
    """Error by the mesh of the record, m. Shape (M, P, T)."""
    unknowns: int
    """Displacement unknowns of all nodes of both gears, upper bound."""
    seconds_per_solve: float
    """CPU seconds of a position and load, with its coarser mesh."""

    @property
    def mesh_error(self) -> float:
        """The largest relative error by the mesh of the record; NaN without a solution."""
        errors = self.error_estimate / np.abs(self.transmission_error)
        return float(np.nanmax(errors)) if np.isfinite(errors).any() else float("nan")

    def at_positions(self, count: int) -> FullContactRecord:
        """Return the record at equally spaced positions, as nearly as it has them, or at all it has."""
        size = self.position.size
        rows = np.unique(np.round(np.arange(min(count, size)) * size / min(count, size)).astype(int))
        return replace(
            self,
            position=self.position[rows],
            transmission_error=self.transmission_error[:, rows],
            error_estimate=self.error_estimate[:, rows],
        )

    def within(self, misalignment: FloatArray, torque: FloatArray) -> FullContactRecord:
        """Return the record at the misalignments and torques that lie between those of a table."""
        sides, loads = _between(self.misalignment, misalignment), _between(self.torque, torque)
        return replace(
            self,
            misalignment=self.misalignment[sides],
            torque=self.torque[loads],
            transmission_error=self.transmission_error[sides][..., loads],
            error_estimate=self.error_estimate[sides][..., loads],
        )

    def curves(self) -> Iterator[tuple[float, float, FloatArray]]:
        """Yield misalignment, torque and transmission error over the positions, of each curve."""
        for misalignment, errors in zip(self.misalignment, self.transmission_error, strict=True):
            for torque, error in zip(self.torque, errors.T, strict=True):
                yield float(misalignment), float(torque), error

    def to_json(self) -> Json:
        """Return plain JSON; a point without a solution is None."""
        return {
            "pair": self.pair,
            "version": self.version,
            "solved_in": self.solved_in,
            "misalignment": self.misalignment.tolist(),
            "position": self.position.tolist(),
            "torque": self.torque.tolist(),
            "transmission_error": _with_none(self.transmission_error),
            "error_estimate": _with_none(self.error_estimate),
            "unknowns": self.unknowns,
            "seconds_per_solve": self.seconds_per_solve,
        }

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> FullContactRecord:
        """Read a record that `to_json` wrote."""
        arrays = ("misalignment", "position", "torque", "transmission_error", "error_estimate")
        return cls(**{**content, **{name: np.array(content[name], dtype=float) for name in arrays}})


@dataclass(frozen=True)
class FullContactComparison:
    """A record at some of its positions, and its differences from the fidelities of an accuracy study.

    Errors are relative, the worst of all curves; NaN where there is nothing to compare.
    """

    record: FullContactRecord
    mean_error: float = float("nan")
    peak_to_peak_error: float = float("nan")
    """`mean_error`, `peak_to_peak_error`: Relative errors of the record against the finest fidelity."""
    plane_strain_mean: float = float("nan")
    plane_strain_peak_to_peak: float = float("nan")
    """`plane_strain_mean`, `plane_strain_peak_to_peak`: Relative differences of the fidelity in plane strain
    from the record: the distance of two independent contact solvers.
    """

    @property
    def solves(self) -> int:
        """The number of positions x loads x misalignments."""
        return self.record.transmission_error.size

    @property
    def solved(self) -> int:
        """The number of those that have a solution."""
        return int(np.isfinite(self.record.transmission_error).sum())

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds that these positions and loads took."""
        return self.seconds(self.solves)

    def seconds(self, solves: int) -> float:
        """CPU seconds of a table of so many positions x loads, at the mean cost of those recorded."""
        return self.record.seconds_per_solve * solves

    def to_json(self, solves: int) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        record = self.record
        errors = {
            "mean_error": self.mean_error,
            "peak_to_peak_error": self.peak_to_peak_error,
            "plane_strain_mean_difference": self.plane_strain_mean,
            "plane_strain_peak_to_peak_difference": self.plane_strain_peak_to_peak,
            "own_error_estimate": record.mesh_error,
        }
        return {name: error for name, error in errors.items() if np.isfinite(error)} | {
            "program": PROGRAM,
            "version": record.version,
            "unknowns": record.unknowns,
            "solved_in": record.solved_in,
            "misalignments_m": record.misalignment.tolist(),
            "torque_n_m": float(record.torque[-1]),
            "torques_n_m": record.torque.tolist(),
            "positions_run": record.position.size,
            "positions_solved": int(np.isfinite(record.transmission_error).all(axis=(0, 2)).sum()),
            "cpu_seconds_measured": self.cpu_seconds,
            "cpu_seconds_of_table": self.seconds(solves),
            "points": [*self._points()],
        }

    def _points(self) -> Iterator[Json]:
        """Yield the points, misalignment by misalignment, position by position."""
        record = self.record
        for m, p, t in np.ndindex(record.transmission_error.shape):
            point = {"position": float(record.position[p]), "torque_n_m": float(record.torque[t])}
            if np.isfinite(lag := record.transmission_error[m, p, t]):
                point["transmission_error_m"] = float(lag)
                point["error_estimate_m"] = float(record.error_estimate[m, p, t])
            yield point


@lru_cache(maxsize=1)
def full_contact_records() -> tuple[FullContactRecord, ...]:
    """Read the records that come with the accuracy study."""
    return tuple(FullContactRecord.from_json(record) for record in json.loads(RECORDS.read_text("utf-8")))


def solved_in(checked: Checked) -> str:
    """Return the model that full contact of a request needs: the face where gears or flanks vary along it."""
    request = checked.request
    varies = any(gear.modification.varies_along_face for gear in (request.pair.pinion, request.pair.wheel))
    inclined = varies or request.options.model == "3d" or bool(np.any(request.misalignment != 0.0))
    return FACE if inclined else PLANE


def record_of(checked: Checked, records: Sequence[FullContactRecord]) -> FullContactRecord | None:
    """Return the record of the pair of a request, at loads between those of the request."""
    request = checked.request
    if np.any(request.center_distance_change != 0.0):
        return None
    pair, model = written(request.pair), solved_in(checked)
    for record in records:
        if record.solved_in == model and _same(record.pair, pair):
            within = record.within(request.misalignment, request.torque)
            return within if within.transmission_error.size else None
    return None


def compare_full_contact(
    record: FullContactRecord, reference: SteDatabase, plane_strain: SteDatabase | None
) -> FullContactComparison:
    """Compare a record with the table of the finest fidelity, and with that of plane strain."""
    mean, swing = _worst_errors(record, reference)
    compared = FullContactComparison(record, mean, swing)
    if plane_strain is None or record.solved_in == FACE:
        return compared
    mean, swing = _worst_errors(record, plane_strain, record_is_reference=True)
    return replace(compared, plane_strain_mean=mean, plane_strain_peak_to_peak=swing)


def _worst_errors(
    record: FullContactRecord, table: SteDatabase, *, record_is_reference: bool = False
) -> tuple[float, float]:
    """Return the worst errors of mean and peak-to-peak over the curves."""
    errors = []
    for misalignment, torque, lag in record.curves():
        solved = np.isfinite(lag)
        if not solved.any():
            continue
        curve = table.curve(torque=torque, misalignment=misalignment, at=record.position[solved])
        ours = np.asarray(curve.ste, dtype=float)
        errors.append(_errors(ours, lag[solved]) if record_is_reference else _errors(lag[solved], ours))
    means, swings = np.array(errors).reshape(-1, 2).T
    return _worst(means), _worst(swings)


def _errors(curve: FloatArray, reference: FloatArray) -> tuple[float, float]:
    """Relative errors of mean and peak-to-peak over the same positions, as magnitudes; NaN if too few."""
    mean = abs(float(np.mean(curve) / np.mean(reference)) - 1.0) if curve.size else float("nan")
    swing = abs(float(np.ptp(curve) / np.ptp(reference)) - 1.0) if curve.size > 1 else float("nan")
    return mean, swing


def _worst(errors: FloatArray) -> float:
    known = errors[np.isfinite(errors)]
    return float(known.max()) if known.size else float("nan")


def _with_none(values: FloatArray) -> list[Any]:
    """Return nested lists with None in place of NaN, which JSON does not have."""
    plain: list[Any] = np.where(np.isfinite(values), values.astype(object), np.array(None)).tolist()
    return plain


def _between(values: FloatArray, axis: FloatArray) -> BoolArray:
    """Return which values lie between the ends of an axis, up to rounding."""
    room = SAME * np.abs(axis).max()
    between: BoolArray = (values >= axis.min() - room) & (values <= axis.max() + room)
    return between


def _same(one: Any, other: Any) -> bool:
    """Whether two written things are the same, numbers up to rounding."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=SAME)
    return bool(one == other)
