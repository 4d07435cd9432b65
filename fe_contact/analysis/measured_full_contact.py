"""Full finite-element contact of a case at a few positions under one load, measured beside the ladder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.request import Checked
from fe_contact.full_contact import (
    FullContactPoint,
    find_calculix,
    full_contact_mesh,
    refusal,
    solve_position,
    version_of,
)
from fe_contact.stage_clock import StageClock
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

NAME = "full_contact"
SECONDS_PER_UNKNOWN = 2e-5
"""CPU seconds of one iteration, measured on 30 to 130 thousand unknowns in the plane."""
USUAL_ITERATIONS = 14
LIMIT_OVER_PREDICTED, LEAST_LIMIT = 12.0, 60.0
"""CPU limit of a position: so many times what is predicted, at least so many seconds."""


@dataclass(frozen=True)
class MeasuredFullContact:
    """What CalculiX gave on the case itself.

    Attributes
    ----------
    program : str
        With its version.
    unknowns : int
    torque : float
        N m on gear 1: the case's largest.
    points : tuple of FullContactPoint
        Equally spaced by the driven gear; those without a solution say why.
    cpu_seconds, mesh_cpu_seconds : float
        Of the positions, and of meshing, one thread.
    predicted_cpu_seconds : float
        Of the positions, before they ran.
    mean_error, peak_to_peak_error : float
        Of the solved positions against the reference at these positions and this load, relative; NaN where
        there is nothing to compare.
    plane_strain_mean, plane_strain_peak_to_peak : float
        The same of our own plane strain against them: what two independent contact solvers differ by. NaN if
        that rung was not run.
    """

    program: str
    unknowns: int
    torque: float
    points: tuple[FullContactPoint, ...]
    cpu_seconds: float
    mesh_cpu_seconds: float
    predicted_cpu_seconds: float
    mean_error: float = float("nan")
    peak_to_peak_error: float = float("nan")
    plane_strain_mean: float = float("nan")
    plane_strain_peak_to_peak: float = float("nan")

    @property
    def solved(self) -> tuple[FullContactPoint, ...]:
        """The points that converged."""
        return tuple(point for point in self.points if point.status.usable)

    def seconds(self, solves: int) -> float:
        """CPU seconds of a table of so many positions x loads, at the mean cost of those that were run."""
        return self.mesh_cpu_seconds + self.cpu_seconds / len(self.points) * solves

    def compared(self, reference: SteDatabase, plane_strain: SteDatabase | None) -> MeasuredFullContact:
        """Return it with its errors against a table, and those of plane strain against it."""
        errors = _errors(self._lag, self._of(reference))
        if plane_strain is None:
            return replace(self, mean_error=errors[0], peak_to_peak_error=errors[1])
        own = _errors(self._of(plane_strain), self._lag)
        return replace(
            self,
            mean_error=errors[0],
            peak_to_peak_error=errors[1],
            plane_strain_mean=own[0],
            plane_strain_peak_to_peak=own[1],
        )

    @property
    def _lag(self) -> FloatArray:
        """Transmission errors that were found, m."""
        return np.array([point.transmission_error for point in self.solved])

    def _of(self, table: SteDatabase) -> FloatArray:
        """Return those of a table at the same positions and load, m."""
        at = np.array([point.position for point in self.solved])
        return np.asarray(table.curve(torque=self.torque, at=at).ste, dtype=float)

    def to_json(self, solves: int) -> Json:
        """Return plain JSON; errors that are not known are left out."""
        errors = {
            "mean_error": self.mean_error,
            "peak_to_peak_error": self.peak_to_peak_error,
            "plane_strain_mean_difference": self.plane_strain_mean,
            "plane_strain_peak_to_peak_difference": self.plane_strain_peak_to_peak,
        }
        return {name: error for name, error in errors.items() if np.isfinite(error)} | {
            "program": self.program,
            "unknowns": self.unknowns,
            "torque_n_m": self.torque,
            "positions_run": len(self.points),
            "positions_solved": len(self.solved),
            "cpu_seconds_measured": self.cpu_seconds + self.mesh_cpu_seconds,
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
    return None if find_calculix() is not None else "CalculiX (ccx) is not installed"


def measure_full_contact(
    checked: Checked, positions: int, report: Callable[[str, float], None]
) -> MeasuredFullContact:
    """Run CalculiX on the case at its largest load; positions that fail are kept with their reasons.

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
    MeshError
        There is no mesh.
    """
    program, pair, load = find_calculix(), checked.request.pair, float(checked.request.load[-1])
    assert program is not None
    clock = StageClock()
    with clock.stage("mesh"):
        mesh = full_contact_mesh(pair, load)
    predicted = SECONDS_PER_UNKNOWN * USUAL_ITERATIONS * mesh.unknowns
    limit = max(LEAST_LIMIT, LIMIT_OVER_PREDICTED * predicted)
    points = []
    with clock.stage("contact"):
        for count in range(positions):
            report(f"full contact ({positions} x {predicted:.0f} CPU s)", count / positions)
            points.append(solve_position(program, pair, mesh, load, count / positions, limit))
    return MeasuredFullContact(
        program=version_of(program),
        unknowns=mesh.unknowns,
        torque=float(checked.request.torque[-1]),
        points=tuple(points),
        cpu_seconds=clock.seconds["contact"],
        mesh_cpu_seconds=clock.seconds["mesh"],
        predicted_cpu_seconds=predicted * positions,
    )


def _errors(found: FloatArray, reference: FloatArray) -> tuple[float, float]:
    """Relative errors of mean and peak-to-peak over the same positions, as magnitudes; NaN if too few."""
    mean = abs(float(np.mean(found) / np.mean(reference)) - 1.0) if found.size else float("nan")
    swing = abs(float(np.ptp(found) / np.ptp(reference)) - 1.0) if found.size > 1 else float("nan")
    return mean, swing
