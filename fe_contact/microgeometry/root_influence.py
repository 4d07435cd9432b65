"""Stress of the tension roots of both gears as other flanks change the forces of the contact.

Load patches lie where plain involutes touch, whatever the flanks' modifications. So the stress of the roots
by a unit force on each slice, on the same tooth and its neighbors, is computed once; the stress under load is
its product with the forces of a solved contact.

Shapes: P positions of the contact in all pitches, Q positions of the patches (repeated along P), L loads, T
tooth pairs, Z slices of the face, K nodes of the profile, D distances between teeth, R stations along the
root (in `rows`: stresses), d changes of the flanks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fe_contact.analysis.flanks.root_meshes import root_meshes
from fe_contact.analysis.flanks.root_stress import unit_stresses
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.compliance import UnitRootStress
from fe_contact.contact import Candidates, ContactProblem
from fe_contact.contact.patch import Patches
from fe_contact.types import FloatArray, IntArray

NEAR = 0.8
"""Least stress over the largest that is followed as flanks change: another one may become the largest."""
FEWEST = 3
"""Least number of stations along the root that count, however low the patches reach."""


@dataclass(frozen=True)
class RootInfluence:
    """Unit-load stress of both gears, driving gear first."""

    units: tuple[UnitRootStress, UnitRootStress]
    offset: float
    """Distance of the driven gear's mid-face from the driving gear's, m."""
    rough: RootInfluence | None = None
    """Root influence on coarser meshes; None for the coarser meshes themselves."""
    remaining: float = math.nan
    """Error of the stress over its difference to that on the coarser meshes."""

    @classmethod
    def of(cls, contact: PairContact, cache: Path | None = None) -> RootInfluence:
        """Compute or fetch the unit-load stress of the gears of a contact."""
        offset = contact.pair.axial_offset
        units, rough = (unit_stresses(contact, coarse, cache) for coarse in (False, True))
        remaining = root_meshes(contact.plan.discretization).remaining
        return cls(units, offset, cls(rough, offset), remaining)

    def stress(self, problem: ContactProblem, force: FloatArray) -> FloatArray:
        """Return the largest principal stress of the tension roots of the teeth in contact, (2, P, L) Pa.

        Stations that load patches reach do not count; between stations it is up to 1 % more. `force`: of the
        candidates, N.
        """
        pressed = problem.candidates.on_slices(force)
        crests = (gear.crests(pressed) for gear in self._gears(problem.candidates))
        return np.stack([largest.max(axis=2) for largest, _, _ in crests])

    def rows(
        self, problem: ContactProblem, force: FloatArray, changes: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the stresses (R,) near the largest, and their changes (R, d) with changes of the forces.

        Parameters
        ----------
        force : ndarray, shape (P, L, m)
        changes : ndarray, shape (d, P, L, m)
        """
        candidates = problem.candidates
        pressed, changed = candidates.on_slices(force), candidates.on_slices(changes)
        parts = [gear.near_rows(pressed, changed) for gear in self._gears(candidates)]
        values, by = zip(*parts, strict=True)
        return np.concatenate(values), np.concatenate(by)

    def _gears(self, candidates: Candidates) -> Iterator[_GearRoots]:
        slices = candidates.slices
        patches, levers = (slices.patch_1, slices.patch_2), (slices.touch.lever_1, slices.touch.lever_2)
        sides = zip(self.units, patches, levers, (-1, 1), (0.0, self.offset), strict=True)
        yield from (_GearRoots.of(candidates, *side) for side in sides)


@dataclass(frozen=True)
class _GearRoots:
    """Stress of the tension roots of one gear by forces on the slices of T pairs."""

    on_nodes: FloatArray
    """Force at each node of the profile per force on a slice. Shape (Q, T, Z, K)."""
    influence: FloatArray
    """Stress at the stations by a force at a node under a slice, by distance of the loaded tooth, Pa/N.

    Its 3 components are along the profile, across it, and shear. Shape (D, Z, K, 3, R).
    """
    row: IntArray
    """Index of the distance from tooth pair i (stress) to pair j (force); -1: too far to count. Shape (T, T).
    """

    @classmethod
    def of(
        cls,
        candidates: Candidates,
        unit: UnitRootStress,
        patches: Patches,
        lever: FloatArray,
        direction: int,
        offset: float,
    ) -> _GearRoots:
        """Return the roots of a gear.

        `direction`: 1 if tooth numbers grow with those of the pairs, -1 if they fall. `offset`: mid-face of
        the gear from that of the driving gear, m.
        """
        slices = candidates.slices
        teeth = np.unique(slices.pair)
        shape = len(slices.present), teeth.size, -1
        present = slices.present.reshape(shape)
        center, half = (values.reshape(*present.shape, -1) for values in (patches.center, patches.half_width))
        lowest = np.where(present[..., None], center - 2.0 * half, np.inf).min()
        below = max(int(np.searchsorted(unit.station_s, lowest)), FEWEST)
        factor = lever.reshape(shape) * present / (1.0 if unit.across_face else slices.width)
        along = slices.face_position.reshape(teeth.size, -1)[0] - offset
        ahead = direction * (teeth[:, None] - teeth) - unit.distance[0]
        known = (ahead >= 0) & (ahead < len(unit.distance))
        # two points with the second moment of the patch
        patch = np.concatenate([center - 0.5 * half, center + 0.5 * half], axis=-1)
        on_nodes = _on_profile(unit.s, patch) * factor[..., None]
        # two points with the second moment of a uniform force on the slice
        ends = (along + end * slices.slice_width / math.sqrt(12.0) for end in (-1.0, 1.0))
        below_contact = [_under_slices(unit, end, below) for end in ends]
        return cls(on_nodes, 0.5 * (below_contact[0] + below_contact[1]), np.where(known, ahead, -1))

    def crests(self, pressed: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """Return the largest principal stress of each tooth (P, L, T), its components, and its station."""
        on_nodes = self._at_rows(pressed)
        rows, (_, slices, nodes, _, stations) = pressed.shape[:2], self.influence.shape
        flat = on_nodes.reshape(-1, len(self.row), slices * nodes)
        by_distance = self.influence.reshape(len(self.influence), slices * nodes, -1)
        stress = np.zeros((len(self.row), len(flat), by_distance.shape[-1]))
        for tooth, loaded in np.argwhere(self.row >= 0):
            stress[tooth] += flat[:, loaded] @ by_distance[self.row[tooth, loaded]]
        parts = stress.reshape(len(self.row), *rows, 3, stations)
        components = np.moveaxis(parts, (3, 0), (0, 3))  # (3, P, L, T, R)
        along, across, shear = components
        principal = 0.5 * (along + across) + np.hypot(0.5 * (along - across), shear)
        station = principal.argmax(axis=-1)
        at_station = np.take_along_axis(components, station[None, ..., None], axis=-1)[..., 0]
        return principal.max(axis=-1), at_station, station

    def near_rows(self, pressed: FloatArray, changed: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the largest stresses of teeth near the largest of all (R,), and their changes (R, d)."""
        crest, components, station = self.crests(pressed)
        p, load, tooth = np.nonzero(crest >= NEAR * crest.max())
        along, across, shear = components[:, p, load, tooth]
        half_difference = 0.5 * (along - across)
        radius = np.maximum(np.hypot(half_difference, shear), 1e-300)  # above 0 for the quotients
        # derivatives of the principal stress by its components along, across and shear
        turn = 0.5 * half_difference / radius
        weight = np.stack([0.5 + turn, 0.5 - turn, shear / radius], axis=-1)
        row = self.row[tooth]
        unit = self.influence[np.maximum(row, 0), :, :, :, station[p, load, tooth][:, None]]  # R, T, Z, K, 3
        by_force = np.einsum("rtzkc,rc,rtzk->rtz", unit, weight, self.on_nodes[p % len(self.on_nodes)])
        by_force *= (row >= 0)[..., None]
        force_change = changed[:, p, load].reshape(len(changed), p.size, -1)
        return crest[p, load, tooth], np.einsum("rn,arn->ra", by_force.reshape(p.size, -1), force_change)

    def _at_rows(self, pressed: FloatArray) -> FloatArray:
        """Return the forces at the nodes, (P, L, T, Z, K), N."""
        _, teeth, slices, _ = self.on_nodes.shape
        by_slice = pressed.reshape(*pressed.shape[:2], teeth, slices, 1)
        return by_slice * self.on_nodes[np.arange(len(pressed)) % len(self.on_nodes)][:, None]


def _on_profile(s: FloatArray, center: FloatArray) -> FloatArray:
    """Return the parts (..., K) at nodes `s` (K,) of a force that acts equally at c centers (..., c).

    The force at a center is divided linearly between the two nodes around it.
    """
    low = np.clip(np.searchsorted(s, center) - 1, 0, s.size - 2)
    part = np.clip((center - s[low]) / (s[low + 1] - s[low]), 0.0, 1.0)
    part, unit = part[..., None], np.eye(s.size)
    hats = (1.0 - part) * unit[low] + part * unit[low + 1]
    return np.asarray(hats.mean(axis=-2))


def _under_slices(unit: UnitRootStress, along: FloatArray, below: int) -> FloatArray:
    """Return the stress (D, Z, K, 3, R) of the `below` lowest stations by forces at z = `along` (Z,), m."""
    stress = np.moveaxis(unit.stress[:, 0][:, :, :below], -1, 1)
    stress = stress.reshape(*stress.shape[:3], -1)  # D, freedoms, 3, R
    if not unit.across_face:
        return np.asarray(stress[:, unit.index[:1]])
    layer = np.clip(np.searchsorted(unit.z, along) - 1, 0, unit.z.size - 2)
    part = np.clip((along - unit.z[layer]) / (unit.z[layer + 1] - unit.z[layer]), 0.0, 1.0)
    low, high = stress[:, unit.index[2 * layer]], stress[:, unit.index[2 * (layer + 1)]]
    part = part[:, None, None, None]
    return np.asarray(low * (1.0 - part) + high * part)
