"""An elastic housing under several bearings, by matrices over their seats."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from bounds import Declared, Kind, between, declared, described, integers
from dynamics.bearings.matrix import Matrix, check_matrix, least_share
from dynamics.bearings.seat import SEAT
from dynamics.checks import declared_fields, distinct, finite
from dynamics.errors import InputError
from dynamics.types import FloatArray

_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
LARGEST = 2**27
"""Bytes of a CSV file, or of an archive unpacked: three matrices of 2300 rows."""

PER_SEAT = (3, SEAT, SEAT + 1)  # possible numbers of rows per seat
MATRICES = ("stiffness", "damping", "mass")
PRECISION = 1e-6  # relative; a finite-element program writes its matrices with that many digits
DEFINITE = 1e-13
"""Least eigenvalue of a positive definite matrix whose diagonal is scaled to 1; a smaller one is rounding."""
DAMPING_RATIO = Declared(
    Kind.RATIO,
    "",
    between(0.0, 1.0),
    "Damping ratio of every mode of a housing with mass that has no damping matrix",
    0.005,
    omit_default=True,
)
MODAL_COORDINATES = Declared(
    Kind.COUNT,
    "",
    integers(0, 2000),
    "Modal coordinates of a housing with mass: the last rows of its matrices, behind those of the seats",
    0,
    omit_default=True,
)


def _read_csv(file: Path, field: str) -> FloatArray:
    """Return the rows of a CSV file, ``#`` before remarks; raises as `read_archive`."""
    _check_size(file.stat().st_size, file, field)
    try:
        with file.open(encoding="utf-8") as stream:
            return np.asarray(np.loadtxt(stream, delimiter=",", comments="#", ndmin=2))
    except (ValueError, OSError) as error:
        bound = "rows of as many numbers, with commas between"
        raise InputError(field, file.name, bound, "Begin remarks with #.") from error


def read_archive(file: Path, field: str) -> dict[str, FloatArray]:
    """Return the arrays of an archive by their names.

    Raises `InputError`: it is none, is too large unpacked, or holds something else than numbers.

    Parameters
    ----------
    file : Path
        A file of `numpy.savez`.
    field : str
        Name of the field, for errors.
    """
    try:
        with ZipFile(file) as archive:
            members = archive.infolist()
            _check_size(sum(member.file_size for member in members), file, field)
            return {member.filename.removesuffix(".npy"): _array(archive, member) for member in members}
    except InputError:
        raise
    # what zipfile, its decompressors and numpy raise on foreign bytes is not one class
    except Exception as error:
        bound = "a NumPy archive of arrays of numbers"
        raise InputError(field, file.name, bound, "Write it by numpy.savez, without objects.") from error


def _array(archive: ZipFile, member: Any) -> FloatArray:
    """Return an array of numbers, whose header must agree with the size of the member.

    `numpy.load` would allocate whatever size a forged header states.
    """
    with archive.open(member) as stream:
        shape, by_columns, kind = _HEADERS[np.lib.format.read_magic(stream)](stream)
        if kind.kind not in "iuf" or math.prod(shape) * kind.itemsize != member.file_size - stream.tell():
            raise ValueError(kind, shape)
        values = np.frombuffer(stream.read(), kind)
    return values.astype(float).reshape(shape, order="F" if by_columns else "C")


def _check_size(size: int, file: Path, field: str) -> None:
    """Refuse more bytes than matrices have."""
    if size > LARGEST:
        raise InputError(field, file.name, f"of at most {LARGEST} bytes", "Reduce it to fewer coordinates.")


@described
@dataclass(frozen=True)
class Housing:
    """An elastic housing, which couples its bearings; with or without mass.

    Without mass it follows its bearings, which are linear, without delay. With mass it has natural modes, and
    any bearing sits in it: `bushings` are the names of bushings and rolling bearings, in the order of the
    matrices.

    The matrices are square, symmetric and positive semidefinite, in N, m, rad, kg, s: forces (and moments) on
    the seats per their displacements (and rotations). Per seat 3 rows x, y, z, or 5 with tilt_x, tilt_y, or 6
    with the rotation about z, which is free of moment. Directions without rows are rigid. Without `damping`
    a housing without mass has none, and the modes of one with mass have `damping_ratio`: of cast iron with
    bolted joints 0.002 to 0.01, a guess.

    `mass`, of as many rows as `stiffness`, is positive definite, and so is then `stiffness`: the housing is
    held at its feet. Behind the rows of the seats there may be those of modal coordinates, as in the form of
    Craig and Bampton. `seat_positions` are (x, y, z) of each seat in the fixed frame, m; None: where the
    bearings are. The weight of the housing itself is left out: seat positions are those under its weight.
    """

    name: str
    bushings: tuple[str, ...]
    stiffness: Matrix
    damping: Matrix | None = None
    mass: Matrix | None = None
    damping_ratio: float = declared(0.005, DAMPING_RATIO)
    modal_coordinates: int = declared(0, MODAL_COORDINATES)
    seat_positions: tuple[tuple[float, float, float], ...] | None = None

    def __post_init__(self) -> None:
        declared_fields(self)
        if not self.bushings:
            raise InputError("bushings", self.bushings, "at least one bushing")
        distinct("bushings", self.bushings)
        if self.mass is None and self.modal_coordinates:
            remedy = "Give mass: modal coordinates are those of a housing with mass."
            raise InputError("modal_coordinates", self.modal_coordinates, "0 without mass", remedy)
        sizes = tuple(per * len(self.bushings) + self.modal_coordinates for per in PER_SEAT)
        rows = len(check_matrix("stiffness", self.stiffness, sizes, PRECISION))
        for name in ("damping", "mass"):
            if getattr(self, name) is not None:
                check_matrix(name, getattr(self, name), (rows,), PRECISION)
        if self.mass is not None:
            _require_definite("mass", self.mass, "Give every direction of every seat some mass or inertia.")
            _require_definite("stiffness", self.stiffness, "Hold the housing at its feet, or on mounts.")
        self._check_seat_positions()

    def _check_seat_positions(self) -> None:
        if self.seat_positions is None:
            return
        count = len(self.bushings)
        if len(self.seat_positions) != count or any(len(point) != 3 for point in self.seat_positions):
            raise InputError("seat_positions", self.seat_positions, f"{count} times x, y, z: one per seat")
        for seat, point in enumerate(self.seat_positions):
            for axis, value in zip("xyz", point, strict=True):
                finite(f"seat_positions[{seat}].{axis}", value)

    @property
    def per_seat(self) -> int:
        """Rows per seat: 3, 5 or 6."""
        return (len(self.stiffness) - self.modal_coordinates) // len(self.bushings)

    @property
    def columns(self) -> tuple[int, ...]:
        """Rows of the matrix among the five directions of all seats, without rotations about z."""
        amplitudes = min(self.per_seat, SEAT)
        return tuple(SEAT * seat + kind for seat in range(len(self.bushings)) for kind in range(amplitudes))

    @property
    def matrix_columns(self) -> tuple[int, ...]:
        """Indices of these `columns` among the rows of the matrices."""
        per = self.per_seat
        return tuple(
            per * seat + kind for seat in range(len(self.bushings)) for kind in range(min(per, SEAT))
        )

    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and damping over `columns`, symmetric.

        Rotations about z and modal coordinates are condensed out, free of moment and of force.
        """
        rows = len(self.stiffness)
        stiffness = np.array(self.stiffness, dtype=float)
        damping = np.zeros_like(stiffness) if self.damping is None else np.array(self.damping, dtype=float)
        stiffness, damping = 0.5 * (stiffness + stiffness.T), 0.5 * (damping + damping.T)
        columns = np.array(self.matrix_columns, dtype=np.int64)
        out = np.setdiff1d(np.arange(rows), columns)
        follow = np.zeros((rows, columns.size))
        follow[columns] = np.eye(columns.size)
        follow[out] = -np.linalg.pinv(stiffness[np.ix_(out, out)]) @ stiffness[np.ix_(out, columns)]
        return follow.T @ stiffness @ follow, follow.T @ damping @ follow


def _require_definite(field: str, rows: Matrix, remedy: str) -> None:
    """Refuse a matrix that some motion makes zero."""
    minimum = least_share(np.asarray(rows, dtype=float))
    if minimum <= DEFINITE:
        bound = "positive definite on a housing with mass"
        raise InputError(field, f"singular: least eigenvalue {minimum:.1e} of the diagonal", bound, remedy)


def read_housing(path: str | Path, name: str, bushings: tuple[str, ...]) -> Housing:
    """Read a housing's matrix from a file, SI units.

    Raises `InputError` naming ``stiffness_file``, or the matrix's fault.

    Parameters
    ----------
    path : str or Path
        ``.csv``: the rows of the stiffness matrix, numbers with commas between, ``#`` before remarks.
        ``.npz``: an array ``stiffness`` and, if given, ``damping`` and ``mass``.
    bushings : tuple of str
        Names of the bushings, in the order of the matrix.
    """
    matrices = {
        part: tuple(tuple(float(value) for value in np.ravel(row)) for row in np.atleast_2d(matrix))
        for part, matrix in read_housing_matrices(path).items()
    }
    return Housing(name, bushings, matrices["stiffness"], matrices.get("damping"), matrices.get("mass"))


def read_housing_matrices(path: str | Path) -> dict[str, FloatArray]:
    """Return the matrices of a file as `read_housing` takes it by field, unchecked; raises as it does."""
    file, field = Path(path), "stiffness_file"
    if file.suffix.lower() not in (".csv", ".npz"):
        raise InputError(field, file.name, "a .csv or .npz file")
    if not file.is_file():
        raise InputError(field, file.name, "a file that exists")
    is_text = file.suffix.lower() == ".csv"
    arrays = {"stiffness": _read_csv(file, field)} if is_text else read_archive(file, field)
    if "stiffness" not in arrays:
        remedy = f"It has {', '.join(sorted(arrays)[:5]) or 'none'}."
        raise InputError(field, file.name, 'an archive with the array "stiffness"', remedy)
    return {part: arrays[part] for part in MATRICES if part in arrays}
