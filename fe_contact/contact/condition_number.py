"""Condition of the compliance between the candidates."""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray


def condition_numbers(compliance: FloatArray) -> FloatArray:
    """Return the condition numbers (Q,) of compliances (Q, n, n), infinite where one is not definite.

    Candidates that do not exist at a position have no compliance there and are left out.
    """
    real = np.einsum("qii->qi", compliance) != 0.0
    number = np.full(len(compliance), np.inf)
    for members in {mask.tobytes(): mask for mask in real}.values():
        alike = np.flatnonzero((real == members).all(axis=1))
        columns = np.flatnonzero(members)
        eigenvalues = np.linalg.eigvalsh(compliance[np.ix_(alike, columns, columns)])
        minimum, largest = eigenvalues[:, 0], eigenvalues[:, -1]
        number[alike] = np.divide(largest, minimum, out=number[alike], where=minimum > 0.0)
    return number
