"""An elastic housing under several bearings, as one stiffness matrix over their seats."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynamics.checks import distinct
from dynamics.errors import InputError
from dynamics.joints.matrix import Matrix, check_matrix
from dynamics.joints.seat import SEAT
from dynamics.types import FloatArray

PER_SEAT = (3, SEAT, SEAT + 1)
PRECISION = 1e-6  # relative; a finite-element program writes its matrices with that many digits


@dataclass(frozen=True)
class Housing:
    """A massless elastic housing, which couples its bearings.

    Attributes
    ----------
    name : str
        Unique among the housings.
    bushings : tuple of str
        The bushings it carries, in the order of the matrix.
    stiffness : square matrix
        Forces (and moments) on the seats per their displacements (and rotations), N, m, rad; symmetric,
        positive semidefinite. Per seat 3 rows x, y, z, or 5 with tilt_x, tilt_y, or 6 with the rotation about
        z, which is condensed out free of moment. Directions without rows are rigid.
    damping : matrix of the same size or None
        N s/m ...; None: no damping in the housing.
    """

    name: str
    bushings: tuple[str, ...]
    stiffness: Matrix
    damping: Matrix | None = None

    def __post_init__(self) -> None:
        if not self.bushings:
            raise InputError("bushings", self.bushings, "at least one bushing")
        distinct("bushings", self.bushings)
        sizes = tuple(per * len(self.bushings) for per in PER_SEAT)
        rows = len(check_matrix("stiffness", self.stiffness, sizes, PRECISION))
        if self.damping is not None:
            check_matrix("damping", self.damping, (rows,), PRECISION)

    @property
    def columns(self) -> tuple[int, ...]:
        """Rows of the matrix among the five directions of all seats, without rotations about z."""
        per = len(self.stiffness) // len(self.bushings)
        kept = min(per, SEAT)
        return tuple(SEAT * seat + kind for seat in range(len(self.bushings)) for kind in range(kept))

    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and damping over `columns`, symmetric, rotations about z condensed out."""
        rows, per = len(self.stiffness), len(self.stiffness) // len(self.bushings)
        stiffness = np.array(self.stiffness, dtype=float)
        damping = np.zeros_like(stiffness) if self.damping is None else np.array(self.damping, dtype=float)
        stiffness, damping = 0.5 * (stiffness + stiffness.T), 0.5 * (damping + damping.T)
        rotational = np.arange(rows) % per == SEAT
        kept, out = np.flatnonzero(~rotational), np.flatnonzero(rotational)
        follow = np.zeros((rows, kept.size))
        follow[kept] = np.eye(kept.size)
        follow[out] = -np.linalg.pinv(stiffness[np.ix_(out, out)]) @ stiffness[np.ix_(out, kept)]
        return follow.T @ stiffness @ follow, follow.T @ damping @ follow


def read_housing(path: str | Path, name: str, bushings: tuple[str, ...]) -> Housing:
    """Read a housing's matrix from a file, SI units.

    Parameters
    ----------
    path : str or Path
        ``.csv``: the rows of the stiffness matrix, numbers with commas between, ``#`` before remarks.
        ``.npz``: an array ``stiffness`` and, if given, ``damping``.
    name : str
    bushings : tuple of str
        In the order of the matrix.

    Raises
    ------
    InputError
        Naming ``stiffness_file``, or the matrix's fault.
    """
    stiffness, damping = read_housing_matrices(path)
    return Housing(name, bushings, _rows(stiffness), None if damping is None else _rows(damping))


def read_housing_matrices(path: str | Path) -> tuple[FloatArray, FloatArray | None]:
    """Return stiffness and damping of a file as `read_housing` takes it, unchecked; raises as it does."""
    file, field = Path(path), "stiffness_file"
    if file.suffix.lower() not in (".csv", ".npz"):
        raise InputError(field, str(path), "a .csv or .npz file")
    if not file.is_file():
        raise InputError(field, str(path), "a file that exists")
    try:
        if file.suffix.lower() == ".csv":
            arrays = {"stiffness": np.loadtxt(file, delimiter=",", comments="#", ndmin=2)}
        else:
            with np.load(file, allow_pickle=False) as archive:
                arrays = {key: np.asarray(archive[key], dtype=float) for key in archive.files}
    except (ValueError, OSError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise InputError(field, str(path), f"a readable matrix ({error})") from error
    if "stiffness" not in arrays:
        raise InputError(field, str(path), 'an archive with the array "stiffness"', f"It has {list(arrays)}.")
    return arrays["stiffness"], arrays.get("damping")


def _rows(matrix: FloatArray) -> Matrix:
    """Return an array's rows as tuples."""
    return tuple(tuple(float(value) for value in np.ravel(row)) for row in np.atleast_2d(matrix))
