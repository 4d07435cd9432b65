"""All weak gaps of a pair in plane strain, undeformed or deformed, as one contact system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.full_contact.condensation.active_set import ContactSystem
from fe_contact.full_contact.condensation.condensed_body import CondensedBody, freedoms
from fe_contact.full_contact.condensation.equilibrium import bore_checks
from fe_contact.full_contact.condensation.flank_curve import FlankCurve
from fe_contact.full_contact.condensation.linearized_contact import (
    LEAST_FACING,
    Configuration,
    LinearizedContact,
    Solution,
    rotation,
    turned_back,
)
from fe_contact.full_contact.condensation.sites import ContactSite
from fe_contact.full_contact.condensation.weak_gap import WeakGap, weak_gap
from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.types import BoolArray, FloatArray


@dataclass(frozen=True)
class PairGeometry:
    """Two condensed bodies that may touch at sites.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    sites : tuple of ContactSite
    bodies : (CondensedBody, CondensedBody)
    """

    pair: ParallelAxes
    sites: tuple[ContactSite, ...]
    bodies: tuple[CondensedBody, CondensedBody]

    @property
    def undeformed(self) -> Configuration:
        """Rigid gears in the conjugate position."""
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

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return breach of the laws and ratio of the torques, as `bore_checks`."""
        return bore_checks(self.bodies, solutions)

    def linearized(self, at: Configuration) -> LinearizedContact:
        """Return the contact with the geometry and the forces of a configuration."""
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
        facing = [_full_weights(self, site) * LEAST_FACING for site in self.sites]
        kept = np.concatenate([gap.weight > least for gap, least in zip(gaps, facing, strict=True)])
        first, second = self._forces(gaps, 0)[:, kept], turned_back(self._forces(gaps, 1)[:, kept], turn)
        moved = self.bodies[0].compliance @ first, self.bodies[1].compliance @ second
        compliance = first.T @ moved[0] + second.T @ moved[1]
        closing = np.concatenate([gap.closing for gap in gaps])[kept]
        points, deformed = self.bodies[0].points, at.displacements
        system = ContactSystem(
            gap=np.concatenate([gap.gap for gap in gaps])[kept]
            + closing * at.lag
            - first.T @ deformed[0]
            - second.T @ deformed[1],
            compliance=0.5 * (compliance + compliance.T),
            closing=closing,
            lever=points[:, 0] @ first[1::2] - points[:, 1] @ first[0::2],
            weight=np.concatenate([gap.weight for gap in gaps])[kept],
        )
        site = np.repeat(np.arange(len(gaps)), [len(gap.gap) for gap in gaps])[kept]
        at_end = np.concatenate([_at_end(self, site) for site in self.sites])[kept]
        return LinearizedContact(system, (first, second), moved, site, site, at_end)

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


def _at_end(geometry: PairGeometry, site: ContactSite) -> BoolArray:
    """Say which hats of a site are at an end of its strip that is no tip edge."""
    s = geometry.bodies[site.slave].body.strips[site.ahead].s
    gear = (geometry.pair.pinion, geometry.pair.wheel)[site.slave]
    ends = np.zeros(len(s), dtype=bool)
    ends[0], ends[-1] = True, s[-1] < tooth_profile(gear).s_tip
    return ends
