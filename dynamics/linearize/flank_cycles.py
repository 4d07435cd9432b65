"""The driving flanks over the positions of their tables, each with its static force held.

A flank's rows are its local coordinates: the deflection first, then misalignment, center distance, sliding
and rolling as far as it has them. The blocked force is the force with the transmission error fixed at its
mean.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.elements import Elements, evaluate
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.linearize.linear_system import LinearSystem
from dynamics.motion.observation import local_state, static_deflections
from dynamics.types import FloatArray

SAMPLES, MIN_SAMPLES, MAX_POSITIONS = 512, 64, 8192
"""Positions per base pitch: usual, least; most positions over the period of a table."""
ITERATIONS = 60  # most iterations to a deflection
SOLVED = 1e-12  # error over the force, at which the search for a deflection ends
MIN_FORCE = 1e-3  # over the first level: force with which an unloaded flank just touches


@dataclass(frozen=True)
class FlankCycle:
    """A driving flank of p rows at T positions, uniform over one period of its table."""

    rows: slice
    """Rows of the flank's local coordinates."""
    coordinate: FloatArray
    force: FloatArray
    """`coordinate`, `force`: Local coordinates in m: the transmission error that carries the static mesh
    force, and the others as the bodies rest; local forces, N. The first force is the static one everywhere.
    Shape (T, p) each.
    """
    tangents: FloatArray
    """Derivatives of the forces in the coordinates, N/m. Shape (T, p, p)."""
    blocked: FloatArray
    """Forces while the transmission error is held at its mean, N. Shape (T, p)."""

    @property
    def static_error(self) -> FloatArray:
        """Static transmission error at the static mesh force, (T,) m."""
        return np.asarray(self.coordinate[:, 0])

    @cached_property
    def tangent(self) -> FloatArray:
        """Mean of the tangents over the positions, (p, p) N/m."""
        return np.asarray(np.mean(self.tangents, axis=0))


def resting(system: System, linear: LinearSystem, time: float = 0.0) -> LocalState:
    """Return the elements about the equilibrium of `linear`, loads taken at `time`."""
    displacement = linear.equilibrium.displacement
    return by_address(local_state(system.arrays, time, displacement, np.zeros(displacement.size)))


def flank_cycles(
    system: System, linear: LinearSystem, at_rest: LocalState, orders: int = 1, samples: int = SAMPLES
) -> tuple[FlankCycle, ...]:
    """Return the cycle of every driving flank about the equilibrium of `linear`, elements being `at_rest`.

    The coordinates beside the transmission error (misalignment, center distance, sliding) are those of the
    bodies at rest, so tables are read where these are. `orders` harmonics per base pitch are wanted, at up to
    `samples` positions per base pitch.
    """
    force = linear.equilibrium.mesh_force
    cycles = []
    for index, mesh in enumerate(system.scene.meshes):
        period = mesh.table.period
        count = max(min(samples, MAX_POSITIONS // period), min(samples, MIN_SAMPLES), 4 * orders)
        position = np.arange(count * period) / count
        cycles.append(_cycle(system, at_rest, index, float(force[index]), position))
    return tuple(cycles)


def averaged(
    system: System, linear: LinearSystem, cycles: tuple[FlankCycle, ...], at_rest: LocalState
) -> LinearSystem:
    """Return `linear` with the mean tangents of all driving flanks instead of those `at_rest`."""
    stiffness, spring = linear.stiffness.copy(), linear.spring_stiffness.copy()
    for index, cycle in enumerate(cycles):
        gradient, p = system.arrays.direction[cycle.rows], cycle.tangent.shape[0]
        stiffness += gradient.T @ (cycle.tangent - at_rest.tangent[cycle.rows, :p]) @ gradient
        spring[index] = cycle.tangent[0, 0]
    return replace(linear, stiffness=stiffness, spring_stiffness=spring)


def _cycle(system: System, local: LocalState, index: int, force: float, position: FloatArray) -> FlankCycle:
    """Walk one flank over the positions (T,); `local` is left as it was."""
    elements = by_address(system.arrays.elements)
    rows = slice(*(int(row) for row in elements.first[index : index + 2]))
    level = system.flanks.tables[index].level
    force = max(force, MIN_FORCE * float(level[1] - level[0]))
    guess = np.empty_like(position)
    static_deflections(system.flanks.law.table, index, position, force, guess)
    size = rows.stop - rows.start
    coordinate, reaction, blocked = (np.empty((position.size, size)) for _ in range(3))
    tangent = np.empty((position.size, size, size))
    _hold(elements, local, index, force, position, guess, coordinate, reaction, tangent)
    _block(elements, local, index, float(np.mean(coordinate[:, 0])), position, blocked)
    return FlankCycle(rows, coordinate, reaction, tangent, blocked)


@compiled
def _hold(
    elements: Elements,
    local: LocalState,
    e: int,
    force: float,
    position: FloatArray,
    guess: FloatArray,
    coordinate: FloatArray,
    reaction: FloatArray,
    tangent: FloatArray,
) -> None:
    """Write coordinates (T, p), forces (T, p) and tangents (T, p, p) where the first row carries `force`.

    Newton's method, from `guess` (T,); pressed on where flanks part.
    """
    row, mesh = elements.first[e], elements.mesh[e]
    start, rest = local.position[mesh], local.coordinate[row]
    for t in range(position.size):
        local.position[mesh], local.coordinate[row] = position[t], guess[t]
        for _ in range(ITERATIONS):
            evaluate(elements, local, e)
            left, stiffness = force - local.force[row], local.tangent[row, 0]
            coordinate[t, 0] = local.coordinate[row]
            if abs(left) <= SOLVED * force:
                break
            local.coordinate[row] += left / stiffness if stiffness > 0.0 else abs(guess[t])
        for p in range(reaction.shape[1]):
            reaction[t, p] = local.force[row + p]
            coordinate[t, p] = local.coordinate[row + p] if p > 0 else coordinate[t, 0]
            for s in range(reaction.shape[1]):
                tangent[t, p, s] = local.tangent[row + p, s]
    local.position[mesh], local.coordinate[row] = start, rest


@compiled
def _block(
    elements: Elements, local: LocalState, e: int, error: float, position: FloatArray, blocked: FloatArray
) -> None:
    """Write the forces (T, p) while the transmission error is `error`."""
    row, mesh = elements.first[e], elements.mesh[e]
    start, rest = local.position[mesh], local.coordinate[row]
    for t in range(position.size):
        local.position[mesh], local.coordinate[row] = position[t], error
        evaluate(elements, local, e)
        for p in range(blocked.shape[1]):
            blocked[t, p] = local.force[row + p]
    local.position[mesh], local.coordinate[row] = start, rest
    evaluate(elements, local, e)
