"""Solution of the loaded contact over positions and loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import BoolArray, FloatArray, IntArray, Status


@dataclass(frozen=True)
class ContactSolution:
    """Forces, deflection and residuals for P positions, L loads and n contact candidates.

    Attributes
    ----------
    load : ndarray, shape (L,)
        Right-hand side of the equilibrium, T_1/(r_b1 cos beta_b) in N.
    deflection : ndarray, shape (P, L)
        Transmission error in m, positive = the driven gear lags; NaN where `status` is not usable.
    tangent : ndarray, shape (P, L)
        d(deflection)/d(load) in m/N.
    force : ndarray, shape (P, L, n)
        Normal force of each candidate in N.
    status, iterations : ndarray of int, shape (P, L)
        `Status` and Newton iterations.
    residuals : ndarray, shape (P, L, 4)
        Equilibrium, penetration, tension and complementarity, each relative (to load or deflection).
    beyond : ndarray of bool, shape (P, L)
        A contact strip outgrew the load patch of the finite-element model.
    no_load : ndarray, shape (P,)
        Deflection at which the first candidate touches, m.
    """

    load: FloatArray
    deflection: FloatArray
    tangent: FloatArray
    force: FloatArray
    status: IntArray
    iterations: IntArray
    residuals: FloatArray
    beyond: BoolArray
    no_load: FloatArray

    @property
    def converged(self) -> bool:
        """Whether every point is a solution."""
        return bool(np.all(self.status == Status.CONVERGED))
