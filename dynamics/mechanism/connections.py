"""Connections of a mechanism: couplings of six strains, bearings of three, or five with matrix or housing.

A strain is a relative displacement or rotation of two parts. A seat (`Seats`) is a bearing that is more than
three springs: it has tilt stiffness or a matrix, or sits in a housing without mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.bearings import PlanetBearing
from dynamics.bearings.seat import SEAT
from dynamics.joints import Housing
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, elastic_terms
from dynamics.mechanism.coupling_rows import QUARTER, CouplingRows, gather_couplings
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.supports import Supports, gather_supports, seat_axes, seat_error, seat_motion
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray, IntArray


@dataclass(frozen=True)
class Seats:
    """s bearings whose forces on ground or pin are K d + C d' - preload, d their 5 s strains."""

    name: tuple[str, ...]
    support: IntArray
    """Index of each bearing among the supports. Shape (s,)."""
    frame: tuple[int | None, ...]
    """Rotor of the carrier in whose rotating frame the ground is seen from each; None in the fixed frame and
    on planet bearings, whose pins stay in the carrier's.
    """
    group: tuple[tuple[str, slice], ...]
    """Parts of the matrix that nothing couples: a bushing or a housing, and its rows."""
    motion: FloatArray
    """Strain per freedom: x, y, z, tilt_x, tilt_y of the shaft's section there, less those of a pin. Shape (5
    s, N).
    """
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: Stiffness and damping of bearing and housing in series. Shape (5 s, 5 s) each.
    """
    preload: FloatArray
    """Preload on the shaft at d = 0, N and N m. On a planet it includes the force of a pin off its nominal
    position. Shape (5 s,).
    """

    @property
    def turned_damping(self) -> FloatArray:
        """Force per strain and unit speed of the frame a seat is seen from: C (z x d), (5 s, 5 s)."""
        quarter = np.kron(np.diag([0.0 if frame is None else 1.0 for frame in self.frame]), QUARTER)
        return np.asarray(self.damping @ quarter)


def general_bearings(scene: Scene, rotors: Bodies) -> frozenset[str]:
    """Return the names of the bearings that are more than three springs to what holds them.

    Bearings in a housing without mass, or with neglected mass, have the housing's matrix in series.
    """
    housed = {name for housing in condensed_housings(scene, rotors) for name in housing.bushings}
    full = {part.name for part in (*scene.ground_bearings, *scene.planet_bearings) if part.is_general}
    return frozenset(housed | full)


def condensed_housings(scene: Scene, rotors: Bodies) -> list[Housing]:
    """Return the housings that are no freedoms."""
    return [part for part in scene.housings if part.name not in {housing.name for housing in rotors.housings}]


def _gather_seats(scene: Scene, rotors: Bodies, names: Sequence[str]) -> Seats:
    """Lay out the bearings of `scene` that are seats; `names` are those of all supports."""
    chosen, condensed = general_bearings(scene, rotors), condensed_housings(scene, rotors)
    # the seats of a housing lie next to each other: they share a block of the matrices
    housed = [name for housing in condensed for name in housing.bushings]
    order = [*housed, *(name for name in names if name in chosen and name not in housed)]
    supports = {part.name: (i, part) for i, rotor in enumerate(rotors) for part in rotor.supports}
    size = SEAT * len(order)
    motion, preload = np.zeros((size, column_count(rotors))), np.zeros(size)
    stiffness, damping = np.zeros((size, size)), np.zeros((size, size))
    for seat, name in enumerate(order):
        index, part = supports[name]
        rows = slice(SEAT * seat, SEAT * seat + SEAT)
        motion[rows], axes = seat_motion(rotors, index, part), seat_axes(rotors, index, part)
        stiffness[rows, rows] = axes.T @ part.seat_stiffness @ axes
        damping[rows, rows] = axes.T @ part.seat_damping @ axes
        seat_preload = np.zeros(SEAT) if part.preload is None else np.array(part.preload)
        preload[rows] = axes.T @ seat_preload + stiffness[rows, rows] @ seat_error(rotors, index, part)
    first, groups = 0, []
    for housing in condensed:
        rows = slice(first, first + SEAT * len(housing.bushings))
        yielding = condense_housing(housing, stiffness[rows, rows], damping[rows, rows], preload[rows])
        stiffness[rows, rows], damping[rows, rows], preload[rows] = yielding
        groups.append((housing.name, rows))
        first = rows.stop
    groups += [(name, slice(SEAT * k, SEAT * k + SEAT)) for k, name in enumerate(order) if SEAT * k >= first]
    return Seats(
        name=tuple(order),
        support=np.array([list(names).index(name) for name in order], dtype=np.int64),
        frame=tuple(
            None if isinstance(part, PlanetBearing) else rotors[index].frame
            for index, part in (supports[name] for name in order)
        ),
        group=tuple(groups),
        motion=motion,
        stiffness=stiffness,
        damping=damping,
        preload=preload,
    )


def condense_housing(
    housing: Housing, stiffness: FloatArray, damping: FloatArray, preload: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return stiffness, damping and preload of bearings in series with a housing, its mass neglected.

    The seats follow the shaft by S = (K_b + K_h)^-1 K_b and leave T = 1 - S to the bearings:

        K = K_b T,    C = T^T C_b T + S^T C_h S,    preload = T^T preload,

    the exact stiffness, and the exact damping at frequencies at which damping is small against stiffness.
    """
    _, loss = housing.matrices()
    follow = seat_compliance(housing, stiffness) @ stiffness
    left = np.eye(stiffness.shape[0]) - follow
    series = stiffness @ left
    amplitudes = follow[list(housing.columns)]
    return (
        0.5 * (series + series.T),
        left.T @ damping @ left + amplitudes.T @ loss @ amplitudes,
        left.T @ preload,
    )


def seat_compliance(housing: Housing, stiffness: FloatArray) -> FloatArray:
    """Return (K_b + K_h)^-1 over the five directions of all seats, zero where the housing is rigid.

    `stiffness` (5 s, 5 s) is K_b of the bearings alone. Under the shaft's motion d the seats move by this
    times K_b d - preload.
    """
    followed, (of_housing, _) = list(housing.columns), housing.matrices()
    both = stiffness[np.ix_(followed, followed)] + of_housing
    scale = 1.0 / np.sqrt(np.maximum(np.diag(both), 1e-300))
    inverse = np.linalg.pinv(scale[:, None] * both * scale, hermitian=True)
    compliance = np.zeros_like(stiffness)
    compliance[np.ix_(followed, followed)] = scale[:, None] * inverse * scale
    return compliance


@dataclass(frozen=True)
class Connections:
    """Linear connections of rotors to the ground and to each other."""

    supports: Supports
    """Bushings, then planet bearings."""
    seats: Seats
    """The bearings that are more than three springs to rigid ground or pin."""
    couplings: CouplingRows

    def matrices(self, freedoms: Freedoms) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return stiffness and damping (n, n), and the constant force (n,) of pin errors and preload.

        Bearings in housings that move are force elements instead; their preload is in the constant force.
        """
        supports, seats, couplings = self.supports, self.seats, self.couplings
        moves, grounded = freedoms.keep(supports.motion), ~supports.carried
        stiffness = supports.matrix(supports.stiffness * grounded[:, None], moves, moves)
        damping = supports.matrix(supports.damping * grounded[:, None], moves, moves)
        if couplings.name:
            strains = freedoms.keep(couplings.motion)
            stiffness += couplings.matrix(couplings.stiffness, strains, strains)
            damping += couplings.matrix(couplings.damping, strains, strains)
        constant = np.einsum("bki,bk,bk->i", moves, supports.stiffness, supports.error)
        if seats.name:
            strains, grounded = freedoms.keep(seats.motion), np.repeat(grounded[seats.support], SEAT)
            stiffness += strains.T @ (seats.stiffness * grounded) @ strains
            damping += strains.T @ (seats.damping * grounded) @ strains
            constant += seats.preload @ strains
        return stiffness, damping, constant

    def on_ground(self, freedoms: Freedoms, tilted: bool) -> tuple[FloatArray, FloatArray]:
        """Return the force on the ground at each support per freedom and per its rate, (b, 3, n) each.

        With moments (`tilted`) both, (b, 6, n). Bearings in housings that move are force elements: 0 here.
        """
        supports, seats = self.supports, self.seats
        grounded = (~supports.carried)[:, None]
        rows = np.repeat(grounded[seats.support, 0], SEAT)
        return (
            self._ground_force(freedoms, supports.stiffness * grounded, seats.stiffness * rows, tilted),
            self._ground_force(freedoms, supports.damping * grounded, seats.damping * rows, tilted),
        )

    def _ground_force(
        self, freedoms: Freedoms, springs: FloatArray, matrix: FloatArray, tilted: bool
    ) -> FloatArray:
        """Return the force on the ground by plain `springs` (b, 3) and by the seats' `matrix` (5 s, 5 s)."""
        supports, seats = self.supports, self.seats
        plain = springs[:, :, None] * freedoms.keep(supports.motion)
        if not tilted:
            return plain
        full = np.concatenate([plain, np.zeros_like(plain)], axis=1)
        full[seats.support, :SEAT] += (matrix @ freedoms.keep(seats.motion)).reshape(-1, SEAT, plain.shape[2])
        return full


def gather_connections(scene: Scene, rotors: Bodies) -> Connections:
    """Lay out what joins the rotors of `scene`."""
    supports = gather_supports(rotors, general_bearings(scene, rotors))
    couplings = gather_couplings(scene, rotors)
    return Connections(supports, _gather_seats(scene, rotors, supports.name), couplings)


def elastic_matrices(rotors: Bodies, freedoms: Freedoms) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and damping (n, n) of shafts and housings themselves."""
    springs, dampers = elastic_terms(rotors)
    motion = freedoms.motion
    return motion.T @ (springs[:, None] * motion), motion.T @ (dampers @ motion)
