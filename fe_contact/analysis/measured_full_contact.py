"""Full finite-element contact of a case at a few positions under all loads, measured beside the ladder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.request import Checked
from fe_contact.errors import SolveError
from fe_contact.full_contact import FullContactPoint, FullContactTable, refusal, solve_full_contact
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

NAME = "full_contact"
PROGRAM = "full contact by condensation"
POSITION_SECONDS, LOAD_SECONDS = 2.2, 0.1
"""CPU seconds of a position with its coarser mesh, and of each load; measured on 17 to 60 k unknowns."""


@dataclass(frozen=True)
class MeasuredFullContact:
    """What the condensed peer gave on the case itself.

    Attributes
    ----------
    table : FullContactTable
        Equally spaced positions by the driving gear x all loads; points without a solution say why.
    predicted_cpu_seconds : float
        Before they ran.
    mean_error, peak_to_peak_error : float
        Of the solved positions against the reference there, relative, the worst of all loads; NaN where there
        is nothing to compare.
    plane_strain_mean, plane_strain_peak_to_peak : float
        The same of our own plane strain against them: what two independent contact solvers differ by. NaN if
        that rung was not run.
    """

    table: FullContactTable
    predicted_cpu_seconds: float
    mean_error: float = float("nan")
    peak_to_peak_error: float = float("nan")
    plane_strain_mean: float = float("nan")
    plane_strain_peak_to_peak: float = float("nan")

    @property
    def points(self) -> tuple[FullContactPoint, ...]:
        """All points, position by position."""
        return tuple(point for row in self.table.points for point in row)

    @property
    def solved(self) -> tuple[FullContactPoint, ...]:
        """The points that converged."""
        return tuple(point for point in self.points if point.status.usable)

    @property
    def positions(self) -> int:
        """How many positions were run."""
        return len(self.table.position)

    @property
    def unknowns(self) -> int:
        """Displacements of all nodes of both gears, at most."""
        return int(self.table.unknowns.max(initial=0))

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds of all positions, each with its coarser mesh."""
        return float(self.table.cpu_seconds.sum())

    @property
    def own_error(self) -> float:
        """Largest relative error that the peer states of its own discretisation; NaN without a solution."""
        stated = self.table.error_estimate / self.table.transmission_error
        return float(np.nanmax(stated)) if np.isfinite(stated).any() else float("nan")

    def seconds(self, solves: int) -> float:
        """CPU seconds of a table of so many positions x loads, at the mean cost of those that were run."""
        return self.cpu_seconds / len(self.points) * solves

    def compared(self, reference: SteDatabase, plane_strain: SteDatabase | None) -> MeasuredFullContact:
        """Return it with its errors against a table, and those of plane strain against it."""
        mean, swing = self._errors(reference)
        if plane_strain is None:
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
        """Return the worst errors of mean and peak-to-peak over the loads."""
        errors = []
        for torque, lag in zip(self.table.torque, self.table.transmission_error.T, strict=True):
            solved = np.isfinite(lag)
            if not solved.any():
                continue
            at = self.table.position[solved]
            ours = np.asarray(table.curve(torque=float(torque), at=at).ste, dtype=float)
            pairs = (ours, lag[solved]) if reference_is_peer else (lag[solved], ours)
            errors.append(_errors(*pairs))
        means, swings = np.array(errors).reshape(-1, 2).T
        return _worst(means), _worst(swings)

    def to_json(self, solves: int) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        errors = {
            "mean_error": self.mean_error,
            "peak_to_peak_error": self.peak_to_peak_error,
            "plane_strain_mean_difference": self.plane_strain_mean,
            "plane_strain_peak_to_peak_difference": self.plane_strain_peak_to_peak,
            "own_error_estimate": self.own_error,
        }
        return {name: error for name, error in errors.items() if np.isfinite(error)} | {
            "program": PROGRAM,
            "unknowns": self.unknowns,
            "torque_n_m": float(self.table.torque[-1]),
            "torques_n_m": self.table.torque.tolist(),
            "positions_run": self.positions,
            "positions_solved": sum(all(p.status.usable for p in row) for row in self.table.points),
            "cpu_seconds_measured": self.cpu_seconds,
            "cpu_seconds_predicted": self.predicted_cpu_seconds,
            "cpu_seconds_of_table": self.seconds(solves),
            "points": [point.to_json() for point in self.points],
        }


def full_contact_refusal(checked: Checked) -> str | None:
    """Say why the full contact cannot be run on a request; None if it can."""
    request = checked.request
    if (reason := refusal(request.pair)) is not None:
        return reason
    if request.misalignment.size > 1 or request.misalignment[0] != 0.0:
        return "misalignment: plane strain has nothing across the face"
    if request.center_distance_change.size > 1 or request.center_distance_change[0] != 0.0:
        return "changes of the centre distance: it runs at the nominal one"
    return None


def measure_full_contact(
    checked: Checked, positions: int, report: Callable[[str, float], None]
) -> MeasuredFullContact:
    """Run the condensed peer on the case under all its loads; points that fail are kept with their reasons.

    Parameters
    ----------
    checked : Checked
        Without `full_contact_refusal`.
    positions : int
        Equally spaced over one base pitch, the first at the pitch point.
    report : callable
        Called as report("full contact", fraction).

    Raises
    ------
    SolveError
        No point has a solution.
    """
    torques = [float(torque) for torque in checked.request.torque]
    predicted = POSITION_SECONDS + LOAD_SECONDS * len(torques)
    stage = f"full contact ({positions} x {predicted:.0f} CPU s)"
    table = solve_full_contact(
        checked.request.pair,
        torques,
        [count / positions for count in range(positions)],
        estimate_error=True,
        report=lambda fraction: report(stage, fraction),
    )
    found = MeasuredFullContact(table, predicted * positions)
    if not found.solved:
        raise SolveError("; ".join(dict.fromkeys(point.reason for point in found.points)))
    return found


def _errors(found: FloatArray, reference: FloatArray) -> tuple[float, float]:
    """Relative errors of mean and peak-to-peak over the same positions, as magnitudes; NaN if too few."""
    mean = abs(float(np.mean(found) / np.mean(reference)) - 1.0) if found.size else float("nan")
    swing = abs(float(np.ptp(found) / np.ptp(reference)) - 1.0) if found.size > 1 else float("nan")
    return mean, swing


def _worst(errors: FloatArray) -> float:
    """Return the largest error that is known, NaN if none is."""
    known = errors[np.isfinite(errors)]
    return float(known.max()) if known.size else float("nan")
