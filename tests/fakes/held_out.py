"""Error of a table's interpolation, measured at points it does not hold."""

from dataclasses import dataclass

import numpy as np

from bounds import from_to
from fe_contact.errors import InputError
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class HeldOutError:
    """Difference between a table's interpolant and solves at other points, m, and where the maximum is.

    Relative ones: the largest over the loads and alignments, each by its own held-out peak-to-peak.
    """

    maximum: float
    rms: float
    relative_maximum: float
    relative_rms: float
    position: float
    force: float
    misalignment: float
    center_distance_change: float


def held_out_error(database: SteDatabase, other: SteDatabase) -> HeldOutError:
    """Compare the interpolant of `database` with what `other` stores at its own positions and loads."""
    other.require_complete()
    _require_inside(database, other)
    grid = np.meshgrid(
        other.position, other.force, other.misalignment, other.center_distance_change, indexing="ij"
    )
    truth = other.static_transmission_error
    error = np.abs(database.ste(*grid) - truth)
    swing = np.ptp(truth, axis=0)
    worst = np.unravel_index(int(np.argmax(error)), error.shape)
    return HeldOutError(
        float(error.max()),
        _rms(error.ravel()),
        _relative(error.max(axis=0), swing),
        _relative(np.sqrt(np.mean(error**2, axis=0)), swing),
        *(float(axis[worst]) for axis in grid),
    )


def _require_inside(database: SteDatabase, other: SteDatabase) -> None:
    """Refuse held-out points that the table does not answer for."""
    for name in ("force", "misalignment", "center_distance_change"):
        inner, outer = getattr(other, name), getattr(database, name)
        if inner[0] < outer[0] or inner[-1] > outer[-1]:
            raise InputError(f"other.{name}", inner.tolist(), from_to(float(outer[0]), float(outer[-1])))
    if other.position.size < 2:
        raise InputError("other.position", other.position.tolist(), "two or more positions")


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _relative(error: FloatArray, swing: FloatArray) -> float:
    """Largest ratio; no error is zero also of a curve without ripple."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.max(np.where(error == 0.0, 0.0, error / swing)))
