"""The weak gaps of a pair in plane strain, undeformed or deformed, as one contact system, and its checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.types import BoolArray, FloatArray
from verification.full_contact.condensation.active_set import ContactSystem
from verification.full_contact.condensation.condensed_body import CondensedBody, freedoms
from verification.full_contact.condensation.flank_curve import FlankCurve
from verification.full_contact.condensation.linearized_contact import (
    MIN_FACING,
    Configuration,
    LinearizedContact,
    Solution,
    rotation,
    turned_back,
)
from verification.full_contact.condensation.placed_mesh import PlacedBody
from verification.full_contact.condensation.sites import ContactSite
from verification.full_contact.condensation.weak_gap import WeakGap, weak_gap
from verification.full_contact.line_load import LineLoad

Bodies = tuple[CondensedBody, CondensedBody]


def _of_body(bodies: Bodies, number: int, solutions: Sequence[Solution]) -> tuple[FloatArray, FloatArray]:
    """Return the moments of the bore's reactions about the center, and the work of the forces, (T,)."""
    body = bodies[number]
    forces = np.zeros((body.stiffness.shape[0], len(solutions)))
    for i, (contact, pressure, _) in enumerate(solutions):
        forces[body.freedoms, i] = contact.forces[number] @ pressure
    displacement = body.solve(forces)
    bore_nodes = body.body.bore_nodes
    reactions = np.asarray(body.stiffness @ displacement).reshape(-1, 2, len(solutions))[bore_nodes]
    arms = body.body.points[bore_nodes] - body.body.center
    moments = arms[:, 0] @ reactions[:, 1] - arms[:, 1] @ reactions[:, 0]
    return moments, np.sum(displacement * forces, axis=0)


def _moment(body: CondensedBody, forces: FloatArray) -> float:
    """Return the moment of forces (2 k,) on the strips' nodes about the gear's center, counter-clockwise."""
    arms = body.points - body.body.center
    return float(arms[:, 0] @ forces[1::2] - arms[:, 1] @ forces[0::2])


@dataclass(frozen=True)
class PairGeometry:
    """Two condensed bodies that may touch at sites."""

    pair: ParallelAxes
    sites: tuple[ContactSite, ...]
    bodies: tuple[CondensedBody, CondensedBody]

    @property
    def undeformed(self) -> Configuration:
        """The configuration without load."""
        first, second = (np.zeros(2 * len(body.nodes)) for body in self.bodies)
        return Configuration(0.0, (first, second))

    @property
    def lag_rate(self) -> float:
        """Counter-clockwise angle of gear 2 by the lag, rad/m."""
        return -self.pair.wheel.sign / self.pair.wheel.base_radius

    @property
    def thickness(self) -> float:
        """Face width that the plane stands for, m."""
        return self.pair.face_width

    def line_loads(self, _contact: LinearizedContact, _pressure: FloatArray) -> tuple[LineLoad, ...]:
        """Return none: in the plane the load is even."""
        return ()

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return the largest relative breach of the laws, and the torque of gear 2 over that of gear 1.

        The moment of the reactions at gear 1's bore is the torque, at gear 2's bore that of the contact
        forces; the work u f of both gears is p C p. Nothing condensed enters the reactions: all nodes are
        solved for.
        """
        reactions, work = zip(*(_of_body(self.bodies, number, solutions) for number in range(2)), strict=True)
        checks = []
        for i, (contact, pressure, torque) in enumerate(solutions):
            driven = _moment(self.bodies[1], contact.forces[1] @ pressure)
            balance = max(
                abs(float(reactions[0][i]) / torque + 1.0), abs(float(reactions[1][i]) / driven + 1.0)
            )
            elastic = float(pressure @ contact.system.compliance @ pressure)
            energy = abs(float(work[0][i] + work[1][i]) / elastic - 1.0)
            checks.append((max(balance, energy), abs(driven) / torque))
        return checks

    def linearized(self, at: Configuration) -> LinearizedContact:
        """Return the contact linearized about a configuration."""
        turn, center = rotation(self.lag_rate * at.lag), self.bodies[1].body.center
        rigid = (self.bodies[0].points, (self.bodies[1].points - center) @ turn.T + center)
        first, second = (u.reshape(-1, 2) for u in at.displacements)
        deformed = (rigid[0] + first, rigid[1] + second @ turn.T)

        def lag(points: FloatArray) -> FloatArray:
            return np.asarray(self.lag_rate * (points - center)[:, ::-1] * [-1.0, 1.0])

        gaps = []
        for site in self.sites:
            columns = [body.columns[site.ahead] for body in self.bodies]
            curves = FlankCurve(deformed[0][columns[0]]), FlankCurve(deformed[1][columns[1]])
            reference = FlankCurve(rigid[site.slave][columns[site.slave]])
            gaps.append(weak_gap(curves, reference, site.slave, lag))
        return self._gathered(gaps, at, turn)

    def _gathered(self, gaps: Sequence[WeakGap], at: Configuration, turn: FloatArray) -> LinearizedContact:
        """Join the pairs, without hats that hardly face their mate."""
        facing = [_full_weights(self, site) * MIN_FACING for site in self.sites]
        facing_hats = np.concatenate(
            [gap.weight > minimum for gap, minimum in zip(gaps, facing, strict=True)]
        )
        first, second = (
            self._forces(gaps, 0)[:, facing_hats],
            turned_back(self._forces(gaps, 1)[:, facing_hats], turn),
        )
        displacement = self.bodies[0].compliance @ first, self.bodies[1].compliance @ second
        compliance = first.T @ displacement[0] + second.T @ displacement[1]
        closing = np.concatenate([gap.closing for gap in gaps])[facing_hats]
        points, deformed = self.bodies[0].points, at.displacements
        system = ContactSystem(
            gap=np.concatenate([gap.gap for gap in gaps])[facing_hats]
            + closing * at.lag
            - first.T @ deformed[0]
            - second.T @ deformed[1],
            compliance=0.5 * (compliance + compliance.T),
            closing=closing,
            lever=points[:, 0] @ first[1::2] - points[:, 1] @ first[0::2],
            weight=np.concatenate([gap.weight for gap in gaps])[facing_hats],
        )
        site = np.repeat(np.arange(len(gaps)), [len(gap.gap) for gap in gaps])[facing_hats]
        ends = [at_end(self.pair, s, self.bodies[s.slave].body) for s in self.sites]
        return LinearizedContact(
            system, (first, second), displacement, site, site, np.concatenate(ends)[facing_hats]
        )

    def _forces(self, gaps: Sequence[WeakGap], number: int) -> FloatArray:
        """Return the nodal forces (2 k, h) of all pairs on one gear."""
        body = self.bodies[number]
        blocks = []
        for site, gap in zip(self.sites, gaps, strict=True):
            block = np.zeros((2 * len(body.nodes), len(gap.gap)))
            block[freedoms(body.columns[site.ahead])] = gap.forces[number]
            blocks.append(block)
        return np.concatenate(blocks, axis=1)


def _full_weights(geometry: PairGeometry, site: ContactSite) -> FloatArray:
    """Return the lengths of the hats of a site's slave, m."""
    body = geometry.bodies[site.slave]
    nodes = body.points[body.columns[site.ahead]]
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    return np.asarray(0.5 * (np.append(lengths, 0.0) + np.insert(lengths, 0, 0.0)))


def at_end(pair: ParallelAxes, site: ContactSite, slave: PlacedBody) -> BoolArray:
    """Return whether each hat along the profile of a site is at an end of its strip that is no tip edge."""
    s = slave.strips[site.ahead].s
    gear = (pair.pinion, pair.wheel)[site.slave]
    ends = np.zeros(len(s), dtype=bool)
    ends[0], ends[-1] = True, s[-1] < tooth_profile(gear).s_tip
    return ends
