"""Full finite-element contact of a case at a few positions under all loads, beside the accuracy study."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.request.request import Checked
from fe_contact.errors import SolveError
from fe_contact.full_contact import (
    FullContactPoint,
    FullContactTable,
    refusal,
    refusal_over_face,
    solve_full_contact,
    solve_full_contact_over_face,
)
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

NAME = "full_contact"
PROGRAM = "full contact by condensation"
POSITION_SECONDS, LOAD_SECONDS = 2.2, 0.1
"""CPU seconds of a position with its coarser mesh, and of each load; measured on 17 to 60 k unknowns."""
FACE_SECONDS, FACE_LOAD_SECONDS = 70.0, 2.0
"""The same over the face, and of each load and misalignment; measured on 0.4 to 0.5 M unknowns."""
PLANE, FACE = "plane strain", "three dimensions"


@dataclass(frozen=True)
class MeasuredFullContact:
    """The result of the condensed peer on the case itself."""

    tables: tuple[FullContactTable, ...]
    """For each misalignment, of equally spaced positions by the driving gear x all loads; points without a
    solution say why.
    """
    misalignments: tuple[float, ...]
    """m."""
    solved_in: str
    """Plane strain or three dimensions."""
    predicted_cpu_seconds: float
    """Before they ran."""
    mean_error: float = float("nan")
    peak_to_peak_error: float = float("nan")
    """`mean_error`, `peak_to_peak_error`: Of the solved positions against the reference there, relative, the
    worst of all loads and misalignments; NaN where there is nothing to compare.
    """
    plane_strain_mean: float = float("nan")
    plane_strain_peak_to_peak: float = float("nan")
    """`plane_strain_mean`, `plane_strain_peak_to_peak`: The same of our own plane strain against them: what
    two independent contact solvers differ by. NaN if that fidelity was not run.
    """

    @property
    def points(self) -> tuple[FullContactPoint, ...]:
        """All points, misalignment by misalignment, position by position."""
        return tuple(point for table in self.tables for row in table.points for point in row)

    @property
    def solved(self) -> tuple[FullContactPoint, ...]:
        """The points that converged."""
        return tuple(point for point in self.points if point.status.usable)

    @property
    def positions(self) -> int:
        """The number of positions that were run."""
        return len(self.tables[0].position)

    @property
    def unknowns(self) -> int:
        """Displacements of all nodes of both gears, at most."""
        return int(self.tables[0].unknowns.max(initial=0))

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds of all positions, each with its coarser mesh."""
        return float(sum(table.cpu_seconds.sum() for table in self.tables))

    @property
    def own_error(self) -> float:
        """Largest relative error that the peer states of its own discretization; NaN without a solution."""
        stated = np.array([table.error_estimate / np.abs(table.transmission_error) for table in self.tables])
        return float(np.nanmax(stated)) if np.isfinite(stated).any() else float("nan")

    def seconds(self, solves: int) -> float:
        """CPU seconds of a table of so many positions x loads, at the mean cost of those that were run."""
        return self.cpu_seconds / len(self.points) * solves

    def compared(self, reference: SteDatabase, plane_strain: SteDatabase | None) -> MeasuredFullContact:
        """Return it with its errors against a table, and those of plane strain against it."""
        mean, swing = self._errors(reference)
        if plane_strain is None or self.solved_in == FACE:
            return replace(self, mean_error=mean, peak_to_peak_error=swing)
        own = self._errors(plane_strain, reference_is_peer=True)
        return replace(
            self,
            mean_error=mean,
            peak_to_peak_error=swing,
            plane_strain_mean=own[0],
            plane_strain_peak_to_peak=own[1],
        )

    def _errors(self, table: SteDatabase, *, reference_is_peer: bool = False) -> tuple[float, float]:
        """Return the worst errors of mean and peak-to-peak over the loads and misalignments."""
        errors = []
        for misalignment, torque, position, lag in self._curves():
            solved = np.isfinite(lag)
            if not solved.any():
                continue
            curve = table.curve(torque=torque, misalignment=misalignment, at=position[solved])
            ours = np.asarray(curve.ste, dtype=float)
            pairs = (ours, lag[solved]) if reference_is_peer else (lag[solved], ours)
            errors.append(_errors(*pairs))
        means, swings = np.array(errors).reshape(-1, 2).T
        return _worst(means), _worst(swings)

    def _curves(self) -> Iterator[tuple[float, float, FloatArray, FloatArray]]:
        for misalignment, table in zip(self.misalignments, self.tables, strict=True):
            for torque, lag in zip(table.torque, table.transmission_error.T, strict=True):
                yield misalignment, float(torque), table.position, lag

    def to_json(self, solves: int) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        errors = {
            "mean_error": self.mean_error,
            "peak_to_peak_error": self.peak_to_peak_error,
            "plane_strain_mean_difference": self.plane_strain_mean,
            "plane_strain_peak_to_peak_difference": self.plane_strain_peak_to_peak,
            "own_error_estimate": self.own_error,
        }
        rows = zip(*(table.points for table in self.tables), strict=True)
        return {name: error for name, error in errors.items() if np.isfinite(error)} | {
            "program": PROGRAM,
            "unknowns": self.unknowns,
            "solved_in": self.solved_in,
            "misalignments_m": list(self.misalignments),
            "torque_n_m": float(self.tables[0].torque[-1]),
            "torques_n_m": self.tables[0].torque.tolist(),
            "positions_run": self.positions,
            "positions_solved": sum(all(point.status.usable for row in own for point in row) for own in rows),
            "cpu_seconds_measured": self.cpu_seconds,
            "cpu_seconds_predicted": self.predicted_cpu_seconds,
            "cpu_seconds_of_table": self.seconds(solves),
            "points": [point.to_json() for point in self.points],
        }


def needs_the_face(checked: Checked) -> bool:
    """Say whether a request needs the face: it is in three dimensions, or gears or flanks are inclined."""
    request = checked.request
    gears = (request.pair.pinion, request.pair.wheel)
    varies = any(gear.modification.varies_along_face for gear in gears)
    return varies or request.options.model == "3d" or bool(np.any(request.misalignment != 0.0))


def full_contact_refusal(checked: Checked) -> str | None:
    """Say why the full contact cannot be run on a request; None if it can."""
    request = checked.request
    if (reason := (refusal_over_face if needs_the_face(checked) else refusal)(request.pair)) is not None:
        return reason
    if request.center_distance_change.size > 1 or request.center_distance_change[0] != 0.0:
        return "changes of the center distance: it runs at the nominal one"
    return None


def measure_full_contact(
    checked: Checked, positions: int, report: Callable[[str, float], None]
) -> MeasuredFullContact:
    """Run the condensed peer on the case under all its loads; points that fail are kept with their reasons.

    Raises `SolveError`: no point has a solution.

    Parameters
    ----------
    checked : Checked
        Without `full_contact_refusal`.
    positions : int
        Equally spaced over one base pitch, the first at the pitch point.
    report : callable
        Called as report("full contact", fraction).
    """
    request, fractions = checked.request, [count / positions for count in range(positions)]
    torques = [float(torque) for torque in request.torque]
    misalignments = tuple(float(misalignment) for misalignment in request.misalignment)
    inclined = needs_the_face(checked)
    predicted = position_seconds(checked)
    stage = f"full contact ({positions} x {predicted:.0f} CPU s)"

    def reported(fraction: float) -> None:
        report(stage, fraction)

    if inclined:
        tables = solve_full_contact_over_face(
            request.pair, torques, fractions, misalignments, estimate_error=True, report=reported
        )
    else:
        tables = (solve_full_contact(request.pair, torques, fractions, estimate_error=True, report=reported),)
    measured = MeasuredFullContact(tables, misalignments, FACE if inclined else PLANE, predicted * positions)
    if not measured.solved:
        raise SolveError("; ".join(dict.fromkeys(point.reason for point in measured.points)))
    return measured


def position_seconds(checked: Checked) -> float:
    """Return the predicted CPU seconds of full contact at one position, under all loads and misalignments."""
    solves = checked.request.torque.size * checked.request.misalignment.size
    if needs_the_face(checked):
        return FACE_SECONDS + FACE_LOAD_SECONDS * solves
    return POSITION_SECONDS + LOAD_SECONDS * solves


def _errors(curve: FloatArray, reference: FloatArray) -> tuple[float, float]:
    """Relative errors of mean and peak-to-peak over the same positions, as magnitudes; NaN if too few."""
    mean = abs(float(np.mean(curve) / np.mean(reference)) - 1.0) if curve.size else float("nan")
    swing = abs(float(np.ptp(curve) / np.ptp(reference)) - 1.0) if curve.size > 1 else float("nan")
    return mean, swing


def _worst(errors: FloatArray) -> float:
    known = errors[np.isfinite(errors)]
    return float(known.max()) if known.size else float("nan")
