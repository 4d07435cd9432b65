"""How well the compliance between the candidates is conditioned."""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray


def condition_numbers(compliance: FloatArray) -> FloatArray:
    """Return the condition numbers (Q,) of compliances (Q, n, n), infinite where one is not definite.

    Candidates that do not exist at a position have no compliance there and are left out.
    """
    diagonal = np.einsum("qii->qi", compliance)
    real = diagonal != 0.0
    filler = np.where(real, 0.0, np.abs(diagonal).max(axis=1)[:, None])
    eigenvalues = np.linalg.eigvalsh(compliance + filler[:, :, None] * np.eye(diagonal.shape[1]))
    least, largest = eigenvalues[:, 0], eigenvalues[:, -1]
    return np.asarray(np.divide(largest, least, out=np.full(least.size, np.inf), where=least > 0.0))
