"""A gear train: the ratios of its stages, and the statics that follow from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import GearStage
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.problems import BadInput

EQUAL = 1e-9
"""Relative tolerance of ratios: they are ratios of whole numbers, solved in floating point."""

_MAX_ROTORS = 300
"""Number of rotors from which a train is not solved: 300 rotors take 0.1 s."""


@dataclass(frozen=True)
class Train:
    """The rotors of a train, and the equations between their speeds."""

    rotors: tuple[int, ...]
    """Ids of the rotors, in the sequence of the columns of `rows`."""
    stages: tuple[GearStage, ...]
    """Stages of the train, in the sequence of the first rows of `rows`."""
    rows: FloatArray
    """Kinematic equations of stages, then of couplings. Shape (n, m)."""
    grounded: tuple[int, ...]
    """Columns of rotors at rest."""

    @classmethod
    def of(cls, layout: Layout) -> Train:
        """Return the train of stages and couplings; all speeds and torques are about z.

        Speeds and torques of a shaft that is not parallel to z are about its own u. The file leaves open in
        which sense a bevel stage turns the shafts behind it, but not their power.
        """
        stages, rotors = layout.stages, layout.rotors
        ids = tuple(sorted(set(rotors.of.values())))
        if len(ids) > _MAX_ROTORS:
            raise BadInput.of("model", f"{len(ids)} shafts and side plates", f"at most {_MAX_ROTORS}")
        rows = np.zeros((len(stages) + len(rotors.couplings), len(ids)))
        for row, stage in zip(rows, stages, strict=False):
            first, second = (ids.index(rotors.of[shaft.id]) for shaft in stage.shafts)
            sign = -1.0 if stage.internal else 1.0
            row[first] += stage.teeth[0]
            row[second] += sign * stage.teeth[1]
            carrier = layout.carrier(stage)
            if carrier is not None:
                row[ids.index(carrier)] -= stage.teeth[0] + sign * stage.teeth[1]
        for row, entry in zip(rows[len(stages) :], rotors.couplings, strict=True):
            row[ids.index(rotors.of[entry.inner.id])] += 1.0
            row[ids.index(rotors.of[entry.outer.id])] -= 1.0
        return cls(ids, stages, rows, tuple(ids.index(rotor) for rotor in sorted(rotors.grounded)))

    def speeds(self, known: Mapping[int, float]) -> FloatArray | None:
        """Return the speeds of all rotors, rad/s, None where the known ones do not fit or leave some open.

        Rotors that nothing joins to the known ones are at rest. `known`: speeds by rotor.
        """
        free = self._free(set(self.rotors) - self.joined_to(known))
        columns = [self.rotors.index(rotor) for rotor in known]
        values = np.array(list(known.values()))
        if free.shape[1] == 0 or np.linalg.matrix_rank(free[columns], tol=EQUAL) < free.shape[1]:
            return None
        shares, *_ = np.linalg.lstsq(free[columns], values, rcond=None)
        scale = float(np.max(np.abs(values), initial=0.0))
        if np.any(np.abs(free[columns] @ shares - values) > 1e3 * EQUAL * scale):
            return None
        return np.asarray(free @ shares)

    def joined_to(self, rotors: Iterable[int]) -> set[int]:
        """Return these rotors and all that stages and couplings join to them."""
        joined = np.isin(self.rotors, list(rotors))
        count = 0
        while count < joined.sum():
            count = joined.sum()
            joining = np.any(self.rows[:, joined], axis=1)
            joined |= np.any(self.rows[joining], axis=0)
        return {rotor for rotor, is_joined in zip(self.rotors, joined, strict=True) if is_joined}

    def _free(self, resting: set[int]) -> FloatArray:
        """Return an orthonormal base (rotors, freedoms) of the speeds that ratios and resting ones permit."""
        columns = [*self.grounded, *map(self.rotors.index, resting)]
        fixed = np.zeros((len(columns), len(self.rotors)))
        fixed[range(len(columns)), columns] = 1.0
        scale = np.linalg.norm(self.rows, axis=1, keepdims=True)
        return _null_space(np.vstack([self.rows / scale, fixed]))

    def forces(self, known: Mapping[int, float], open_rotors: Sequence[int]) -> Flow | None:
        """Return the torques of stages and open rotors that balance the known ones.

        Parameters
        ----------
        known : mapping of int to float
            Torques on rotors from outside, N m.
        open_rotors : sequence of int
            Rotors on which a torque from outside is unknown. Held rotors are such, too.

        Returns
        -------
        Flow or None
            None where no torque balances the known ones, or some open torque is not determined by them.
            Stages whose shares statics leaves open (planets, power splits) share by least squares.
        """
        outside = [*(self.rotors.index(rotor) for rotor in open_rotors), *self.grounded]
        load = np.zeros(len(self.rotors))
        for rotor, torque in known.items():
            load[self.rotors.index(rotor)] += torque
        columns = np.zeros((len(self.rotors), len(outside)))
        columns[outside, range(len(outside))] = 1.0
        matrix = np.hstack([self.rows.T, columns])
        solution, *_ = np.linalg.lstsq(matrix, -load, rcond=None)
        left = matrix @ solution + load
        if np.any(np.abs(left) > 1e3 * EQUAL * float(np.max(np.abs(load), initial=0.0))):
            return None
        loose = _null_space(matrix)[len(self.rows) :]
        if np.any(np.abs(loose) > 1e3 * EQUAL):
            return None
        count = len(self.rows)
        return Flow(
            self.rows * solution[:count, None],
            dict(zip(open_rotors, map(float, solution[count:]), strict=False)),
            bool(_null_space(self.rows.T).shape[1]),
        )


@dataclass(frozen=True)
class Flow:
    """Torques through a train."""

    on_rotor: FloatArray
    """Torque of each stage and coupling on each rotor, N m. Shape (rows, rotors)."""
    outside: Mapping[int, float]
    """Torque on each open rotor from outside, N m."""
    is_shared: bool
    """Statics leaves open how parallel stages share the load."""


def _null_space(matrix: FloatArray) -> FloatArray:
    """Return an orthonormal base of the null space, by columns."""
    if matrix.size == 0:
        return np.eye(matrix.shape[1])
    _, values, base = np.linalg.svd(matrix)
    rank = int(np.sum(values > EQUAL * max(1.0, float(values[0]))))
    return np.asarray(base[rank:].T)
