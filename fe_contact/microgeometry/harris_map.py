"""Harris map of a design: transmission error over position at several loads, and its ripple over load.

Harris, S. L.: "Dynamic loads on the teeth of spur gears", Proceedings of the Institution of Mechanical
Engineers 172 (1958), 87-112.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fe_contact.types import FloatArray, IntArray, Json
from model_studies import in_unit


@dataclass(frozen=True)
class HarrisMap:
    """Curves of one design at T torques, and their ripple at S nodes of the scatter.

    Attributes
    ----------
    torque : ndarray, shape (T,)
        On the driving gear, N m, increasing.
    position : ndarray, shape (P,)
        Base pitches.
    ste : ndarray, shape (P, T)
        Without scatter, m.
    nominal, nominal_error : ndarray, shape (T,)
        Peak-to-peak without scatter and its error, m.
    peak_to_peak, error : ndarray, shape (S, T)
        At the nodes, m. The error is that of the table at the node's misalignment: deviations of the
        modification change the ripple, not the discretization.
    weight : ndarray, shape (S,)
        Of the nodes.
    """

    torque: FloatArray = field(metadata=in_unit("n_m", "torque"))
    position: FloatArray
    ste: FloatArray = field(metadata=in_unit("m", "position", "torque"))
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    nominal_error: FloatArray = field(metadata=in_unit("m", "torque"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    error: FloatArray = field(metadata=in_unit("m", "node", "torque"))
    weight: FloatArray

    @property
    def expected(self) -> FloatArray:
        """Expectation over the scatter (T,), m."""
        return np.asarray(self.weight @ self.peak_to_peak)

    @property
    def expected_error(self) -> FloatArray:
        """Its error (T,) in m: errors of the nodes may all have the same sign."""
        return np.asarray(self.weight @ self.error)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "torque_n_m": self.torque.tolist(),
            "position": self.position.tolist(),
            "ste_m": self.ste.T.tolist(),
            "nominal_peak_to_peak_m": self.nominal.tolist(),
            "nominal_error_m": self.nominal_error.tolist(),
            "expected_peak_to_peak_m": self.expected.tolist(),
            "expected_error_m": self.expected_error.tolist(),
            "peak_to_peak_m": self.peak_to_peak.tolist(),
            "error_m": self.error.tolist(),
        }


def rising(before: HarrisMap, after: HarrisMap) -> IntArray:
    """Return the indices of torques at which the expected ripple rises by more than the errors of both."""
    change = after.expected - before.expected
    return np.flatnonzero(change > before.expected_error + after.expected_error)
