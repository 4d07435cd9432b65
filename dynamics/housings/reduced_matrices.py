"""Reduced matrices of other programs: NumPy archives, Matrix Market, Nastran OP4 and DMIG."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.bearings.matrix import check_matrix
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.housings.meshed_housing import USUAL_DAMPING, _Damping
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.housings.supports import SeatFrame
from dynamics.joints.housing import read_archive
from dynamics.types import FloatArray
from host import MissingExtra

PRECISION = 1e-6
"""Relative; what a finite-element program writes."""
FIELD = "matrix_file"
NAMES = {
    "stiffness": ("stiffness", "k", "kaa", "kaax"),
    "mass": ("mass", "m", "maa", "maax"),
    "damping": ("damping", "b", "baa", "baax"),
}
"""Names of the matrices in files, in small letters; Nastran writes KAA, or KAAX by EXTSEOUT."""


@dataclass(frozen=True)
class ReducedMatrices:
    """Matrices over the motions of seats, one seat after the other, then over any modal coordinates."""

    stiffness: FloatArray
    """SI: N, m, rad, kg. Symmetric, positive semidefinite. Shape (r, r)."""
    mass: FloatArray | None = None
    damping: FloatArray | None = None
    """`mass`, `damping`: None: none, as of a static model. Shape (r, r) each."""

    def __post_init__(self) -> None:
        rows = np.shape(self.stiffness)[:1]
        for name in ("stiffness", "mass", "damping"):
            if getattr(self, name) is not None:
                check_matrix(name, getattr(self, name), rows, PRECISION)


def read_reduced_matrices(path: str | Path) -> ReducedMatrices:
    """Read matrices from one file.

    `path`: ``.npz`` (arrays ``stiffness``, ``mass``, ``damping``), ``.op4``, or DMIG in ``.pch``, ``.bdf``,
    ``.dat`` (``KAA`` or ``KAAX``, ``MAA`` ...; the extra ``nastran``). Raises `InputError`: no such file, not
    readable, no stiffness, or a matrix that is not symmetric or has a negative eigenvalue; `MissingExtra`: a
    Nastran file, and pyyeti is not installed.
    """
    file = Path(path)
    archive = partial(read_archive, field=FIELD)
    readers = {".npz": archive, ".op4": _op4, ".pch": _dmig, ".bdf": _dmig, ".dat": _dmig}
    one_of(f"{FIELD}.suffix", file.suffix.lower(), list(readers))
    matrices = _read(file, readers[file.suffix.lower()])
    small = {name.lower(): matrix for name, matrix in matrices.items()}
    chosen = {
        part: next((small[name] for name in names if name in small), None) for part, names in NAMES.items()
    }
    if chosen["stiffness"] is None:
        bound = f"a file with a matrix named {' or '.join(NAMES['stiffness'])}"
        remedy = f"It has {', '.join(sorted(matrices)[:5]) or 'none'}."
        raise InputError(FIELD, file.name, bound, remedy)
    return ReducedMatrices(chosen["stiffness"], chosen["mass"], chosen["damping"])


def read_matrix_market(
    stiffness: str | Path, mass: str | Path | None = None, damping: str | Path | None = None
) -> ReducedMatrices:
    """Read matrices from Matrix Market files, one each; raises as `read_reduced_matrices`."""
    others = (None if file is None else _read(Path(file), _market) for file in (mass, damping))
    return ReducedMatrices(_read(Path(stiffness), _market), *others)


def housing_of_matrices(
    matrices: ReducedMatrices, seats: tuple[SeatFrame, ...], damping: _Damping | None = None
) -> ReducedHousing:
    """Return a housing by its matrices.

    Raises `InputError`: the matrices have fewer rows than the seats' motions.

    Parameters
    ----------
    seats : tuple of SeatFrame
        Seats in the order of the matrices' first rows.
    damping : Damping, optional
        Damping by mode, where the matrices have none and there is mass. Default: `USUAL_DAMPING`.
    """
    rows, motions = len(matrices.stiffness), sum(len(seat.motions) for seat in seats)
    if not 0 < motions <= rows:
        bound = "as many motions as the matrices have rows, or fewer"
        raise InputError("seats", f"{motions} motions", bound, f"They have {rows}.")
    zero = np.zeros((rows, rows))
    mass = zero if matrices.mass is None else _symmetric(matrices.mass)
    stiffness = _symmetric(matrices.stiffness)
    bare = ReducedHousing(mass, stiffness, zero, seats, np.zeros(0), np.zeros(0))
    circular, shape = bare.modes
    ratio = (damping or USUAL_DAMPING).ratios(np.where(circular > 0.0, 1.0, 0.0))
    impulse = mass @ shape
    loss = impulse @ np.diag(2.0 * ratio * circular) @ impulse.T
    if matrices.damping is not None:
        loss = _symmetric(matrices.damping)
        ratio = np.einsum("rm,rs,sm->m", shape, loss, shape) / np.where(
            circular > 0.0, 2.0 * circular, np.inf
        )
    return ReducedHousing(mass, stiffness, loss, seats, circular / (2.0 * np.pi), ratio)


def _read(file: Path, reader: Any) -> Any:
    if not file.is_file():
        raise InputError(FIELD, file.name, "a file that exists")
    try:
        return reader(file)
    except ModuleNotFoundError as error:
        raise MissingExtra("pyyeti", "nastran") from error
    except InputError:
        raise
    # what the readers raise on damaged or foreign files is not one class
    except Exception as error:
        raise InputError(FIELD, file.name, f"matrices as a {file.suffix} file has them") from error


def _market(file: Path) -> FloatArray:
    from scipy.io import mmread  # noqa: PLC0415 (start-up time)

    matrix = mmread(file)
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)


def _op4(file: Path) -> Mapping[str, FloatArray]:
    from pyyeti.nastran import op4  # noqa: PLC0415 (extra)

    return {name: np.asarray(matrix, dtype=float) for name, matrix in op4.read(str(file)).items()}


def _dmig(file: Path) -> Mapping[str, FloatArray]:
    from pyyeti.nastran import bulk  # noqa: PLC0415 (extra)

    frames = bulk.rddmig(str(file), square=True)
    return {name: np.asarray(frame.to_numpy(), dtype=float) for name, frame in frames.items()}


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)
