"""Plausibility checks of results: contact pressure, root stress, transmission error."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import Finding, engineering
from fe_contact.plausibility.check import assessed
from fe_contact.types import FloatArray


def table_findings(
    static_transmission_error: FloatArray, max_pressure: FloatArray, normal_module: float
) -> tuple[Finding, ...]:
    """Return the implausible results of a table.

    Parameters
    ----------
    static_transmission_error, max_pressure : ndarray, shape (P, F, M, D)
        Arrays of the table, m and Pa; NaN where there is no solution.
    normal_module : float
        Normal module of the pair, m.
    """
    return (*_transmission_error(static_transmission_error, normal_module), *_pressure(max_pressure))


def flank_findings(max_pressure: float) -> tuple[Finding, ...]:
    """Return the finding of an implausible pressure (Pa) on the flanks at one load."""
    return tuple(_pressure(np.array([max_pressure])))


def root_findings(gear: str, stress: float) -> tuple[Finding, ...]:
    """Return the finding of an implausible peak stress (Pa) of a gear's roots ("pinion", "wheel")."""
    reason = f"a tooth-root stress of {stress / 1e9:.3g} GPa is beyond the strength of any steel"
    return tuple(assessed("root_stress", f"{gear}.root_stress", stress, "Pa", reason=reason))


def _transmission_error(values: FloatArray, module: float) -> Iterator[Finding]:
    solved = np.where(np.isfinite(values), values, 0.0)
    largest = float(np.max(np.mean(solved, axis=0), initial=0.0))
    reason = f"tooth deflections of {engineering(largest / module, 2)} modules are beyond linear elasticity"
    yield from assessed("transmission_error", "transmission_error", largest, "m", scale=module, reason=reason)


def _pressure(values: FloatArray) -> Iterator[Finding]:
    largest = float(np.max(values[np.isfinite(values)], initial=0.0))
    reason = f"a contact pressure of {largest / 1e9:.3g} GPa is beyond the strength of any steel"
    yield from assessed("hertz_pressure", "max_pressure", largest, "Pa", reason=reason)
