"""Compiled force of a flank in contact: the table's elastic force and damping that never pulls."""

from __future__ import annotations

from typing import NamedTuple

from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.meshes.packed_tables import PackedTables
from dynamics.meshes.table_energy import table_energy
from dynamics.meshes.table_lookup import table_force
from dynamics.types import FloatArray


class FlankLaws(NamedTuple):
    """Force laws of m flanks."""

    table: PackedTables
    """Tables of the elastic forces."""
    damping: FloatArray
    """Damping in full contact, N s/m. Shape (m,)."""
    reach: FloatArray
    """Elastic force in N from which the damping acts in full; below, it fades smoothly to zero at lift-off.
    Shape (m,).
    """


@compiled
def flank_force(
    law: FlankLaws, flank: int, position: float, deflection: float, rate: float, hint: int
) -> tuple[float, float, float, float, int]:
    """Return force, elastic force (N), derivatives in deflection and in rate, and the next call's hint.

    force = max(0, F + c s(F/reach) rate), s(r) = r^2 (3 - 2 r) up to 1: C1 through lift-off, and no tension.
    """
    elastic, stiffness, k = table_force(law.table, flank, position, deflection, hint)
    fade, fade_slope = 1.0, 0.0
    if elastic < law.reach[flank]:
        ratio = elastic / law.reach[flank]
        fade = ratio * ratio * (3.0 - 2.0 * ratio)
        fade_slope = 6.0 * ratio * (1.0 - ratio) / law.reach[flank]
    force = elastic + law.damping[flank] * fade * rate
    if force < 0.0:
        return 0.0, elastic, 0.0, 0.0, k
    tangent = stiffness * (1.0 + law.damping[flank] * fade_slope * rate)
    return force, elastic, tangent, law.damping[flank] * fade, k


@inner
def flank(laws: FlankLaws, entry: int, local: LocalState, row: int, e: int, mesh: int) -> None:
    """Write force and derivatives of element `e` into its `row`, and its next hint."""
    force, elastic, tangent, viscous, hint = flank_force(
        laws, entry, local.position[mesh], local.coordinate[row], local.rate[row], local.hint[e]
    )
    local.force[row], local.elastic[row], local.hint[e] = force, elastic, hint
    local.tangent[row, 0], local.viscous[row, 0] = tangent, viscous


@inner
def flank_energy(
    laws: FlankLaws, entry: int, local: LocalState, row: int, e: int, mesh: int
) -> tuple[float, float]:
    """Return the energy stored, J, and its derivative, J per base pitch."""
    return table_energy(laws.table, entry, local.position[mesh], local.coordinate[row], local.hint[e])
