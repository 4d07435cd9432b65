"""Effect of candidates' gaps on the transmission error and on means over the load, by one adjoint."""

from __future__ import annotations

import numpy as np

from fe_contact.contact.adjoint import weigh
from fe_contact.contact.point_problem import point_problems
from fe_contact.contact.problem import ContactProblem
from fe_contact.contact.sweep import ContactSolution
from fe_contact.types import FloatArray


def load_sums(problem: ContactProblem, solution: ContactSolution, rows: FloatArray) -> FloatArray:
    """Return the means of quantities of the candidates over the load, (P, L, Q).

    Parameters
    ----------
    problem, solution
        Contact at P positions, L loads and m candidates.
    rows : ndarray, shape (Q, P, m)
        Quantities of the candidates.
    """
    loaded = solution.force * problem.candidates.torque_share[:, None]
    return np.asarray(np.einsum("plm,qpm->plq", loaded, rows) / solution.load[:, None])


def load_weights(
    problem: ContactProblem, solution: ContactSolution, rows: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives of the transmission error and of `load_sums` by the candidates' normal approach.

    Parameters are those of `load_sums`. Forces change by dF = S (a dSTE - dg), n'dF = 0: S is the stiffness
    of the contact, a the `motion_arm` of `Candidates` (normal approach per unit STE), dg the approach taken
    away and n the `torque_share`.

    Returns
    -------
    weight : ndarray, shape (P, L, m)
        Change of the transmission error per normal approach taken away, 1.
    weights : ndarray, shape (Q, P, L, m)
        Change of the means per normal approach taken away, in their unit per m.
    """
    c = problem.candidates
    # the torque share n, and its products with the quantities; `pushed` is S times each of them
    shares = c.torque_share * np.concatenate([np.ones((1, *c.gap.shape)), rows])
    pushed = np.zeros((len(shares), *solution.force.shape))
    middle, half = np.zeros((2, *solution.force.shape))  # further results of `weigh`, not used here
    weigh(point_problems(problem), solution.force, shares, pushed, middle, half)
    stiffness, *row_slopes = np.einsum("rplm,pm->rpl", pushed, c.motion_arm)  # by the transmission error
    weight = pushed[0] / stiffness[..., None]
    weights = [
        (slope[..., None] * weight - at_constant_ste) / solution.load[:, None]
        for slope, at_constant_ste in zip(row_slopes, pushed[1:], strict=True)
    ]
    return weight, np.stack(weights) if weights else pushed[1:]
