"""The fidelities of the accuracy study of dynamics; the last one is the reference."""

from __future__ import annotations

from dynamics.accuracy.fidelity import Fidelity
from dynamics.accuracy.time_integration import BY_TORSION, IN_PLANE, TimeIntegration
from dynamics.accuracy.without_time import LinearResponse, QuasiStatic

NM = 1e-9

FIDELITIES: tuple[Fidelity, ...] = (
    QuasiStatic(),
    LinearResponse(),
    TimeIntegration("torsion", "torsion only", "model", additions=BY_TORSION),
    TimeIntegration("in_plane", "torsion and lateral motion", "model", additions=IN_PLANE),
    TimeIntegration("table_quarter", "every fourth position node", "table", every=4),
    TimeIntegration("table_half", "every second position node", "table", every=2),
    TimeIntegration("100_nm", "tolerance 100 nm", "steps", tolerance=100 * NM),
    TimeIntegration("10_nm", "tolerance 10 nm", "steps", tolerance=10 * NM),
    TimeIntegration("1_nm", "tolerance 1 nm", "steps", tolerance=NM),
    TimeIntegration("0.1_nm", "tolerance 0.1 nm", "steps", tolerance=0.1 * NM),
    TimeIntegration("0.01_nm", "tolerance 0.01 nm", "steps", tolerance=0.01 * NM),
)
