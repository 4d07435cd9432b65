"""Full contact of helical pairs over the face: positions x torques x misalignments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.errors import InputError, integer, within
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus, half_width
from fe_contact.types import Status
from model_studies.progress import Report
from model_studies.stage_clock import StageClock
from verification.full_contact.condensation.active_set import ActiveSetSolution, solve_active_set
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.helical.flank_bodies import BodyMesh, HelicalGear, helical_gear
from verification.full_contact.helical.line_contact import LineContact, line_contact
from verification.full_contact.line_load import line_loads
from verification.full_contact.solved_position import SolvedPosition, tables_of
from verification.full_contact.table import FullContactPoint, FullContactTable
from verification.full_contact.validity import check_axes, refusal_helical

COARSER = 1.4
STRIP = 1.5
"""Half-width of the strips over Hertz' half-width of the whole load on one pair, in the first attempt."""
WIDER, ATTEMPTS = 1.5, 3
_CORNER = 0.15
"""Distance beyond the path of contact within which tip edges may touch, base pitches."""
LARGEST_RESIDUAL = 1e-8


@dataclass(frozen=True)
class HelicalMesh:
    """Sizes of a resolved helical contact; Hertz' half-width sizes elements and nothing else."""

    flank: float = 0.15
    """Elements on the flanks over the face, modules, 0.05 to 0.4."""
    layers: int = 8
    """Number of layers over the face, 2 to 24."""
    across: int = 15
    along: int = 49
    """`across`, `along`: Hats of pressure across a contact line and along one that runs over the whole face.
    """
    per_half_width: float = 5.0
    """Elements of the fine sections in Hertz' half-width."""
    spread: float = 1.5
    """Elements to either side of a load over which it is spread on the body, 0.5 to 6."""

    def __post_init__(self) -> None:
        within("flank", self.flank, 0.05, 0.4, "0.15 is usual.")
        within("spread", self.spread, 0.5, 6.0, "1.5 is usual.")
        within("per_half_width", self.per_half_width, 1.5, 16.0, "5 is usual.")
        for name, minimum, maximum in (("layers", 2, 24), ("across", 5, 101), ("along", 5, 201)):
            integer(name, getattr(self, name), minimum, maximum)

    @property
    def coarser(self) -> HelicalMesh:
        """Return the mesh with all sizes larger by COARSER."""
        counts = {name: round(getattr(self, name) / COARSER) for name in ("layers", "across", "along")}
        sizes = COARSER * self.flank, self.per_half_width / COARSER
        return HelicalMesh(sizes[0], per_half_width=sizes[1], spread=self.spread, **counts)


@dataclass(frozen=True)
class _CondensedPair:
    """Both gears, Hertz' half-width of the largest load on one pair in m, and their unknowns."""

    pair: ParallelAxes
    gears: tuple[HelicalGear, HelicalGear]
    half: float
    mesh: HelicalMesh

    @property
    def unknowns(self) -> int:
        return sum(gear.body.unknowns for gear in self.gears)


def _condensed(pair: ParallelAxes, torque: float, mesh: HelicalMesh) -> _CondensedPair:
    """Condense both gears for a largest torque, N m."""
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    radius = 1.0 / float(pair.relative_curvature(pair.path_of_contact.pitch_point))
    half = float(half_width(float(pair.normal_force(torque)) / pair.face_width, radius, modulus))
    overlap = abs(math.tan(pair.base_helix_angle)) * pair.face_width / pair.base_pitch
    path = pair.path_of_contact
    reach = max(path.end - path.pitch_point, path.pitch_point - path.start) / pair.base_pitch
    ahead = math.floor(reach + 0.5 * overlap + _CORNER + 0.5)
    sizes = BodyMesh(
        mesh.flank * pair.pinion.normal_module,
        half / mesh.per_half_width,
        mesh.layers,
        Resolution(max(1.5, 0.33 / mesh.flank), 1.0, 1),
        Resolution(min(16.0, 0.8 / mesh.flank), 1.0, 1),
        mesh.spread,
    )
    teeth = range(-ahead, ahead + 1)
    first, second = (helical_gear(gear, pair.face_width, teeth, sizes) for gear in (pair.pinion, pair.wheel))
    return _CondensedPair(pair, (first, second), half, mesh)


def _solved(
    condensed: _CondensedPair, position: float, torques: Sequence[float], misalignment: float
) -> tuple[FullContactPoint, ...]:
    """Solve one position under all torques; repeat with wider strips where strips cut the pressure off."""
    half = STRIP * condensed.half
    for _ in range(ATTEMPTS):
        mesh, phase = condensed.mesh, position - round(position)
        contact = line_contact(
            condensed.pair, condensed.gears, phase, mesh.across, mesh.along, half, misalignment
        )
        points = tuple(
            _point(contact, solve_active_set(contact.system, torque), condensed.pair, position, torque)
            for torque in torques
        )
        if all(point.status is not Status.OUT_OF_MODEL for point in points):
            break
        half *= WIDER
    return points


def _point(
    contact: LineContact,
    solution: ActiveSetSolution,
    pair: ParallelAxes,
    position: float,
    torque: float,
) -> FullContactPoint:
    if not solution.status.usable or not solution.residual < LARGEST_RESIDUAL:
        reason = f"the active set did not settle: residual {solution.residual:.1e}"
        return FullContactPoint.failed(Status.ITERATION_LIMIT, reason, solution.iterations, torque)
    if np.any(solution.pressure[contact.at_side] > 0.0):
        reason = "the contact reaches the side of the strip that is resolved for it"
        return FullContactPoint.failed(Status.OUT_OF_MODEL, reason, solution.iterations, torque)
    moments = contact.system.lever * solution.pressure
    driven = pair.wheel.base_radius * float(contact.system.closing @ solution.pressure)
    return FullContactPoint(
        position=position,
        transmission_error=solution.lag,
        status=solution.status,
        reason="",
        iterations=solution.iterations,
        residual=solution.residual,
        torque_ratio=driven / torque,
        torque=torque,
        load_share={
            int(ahead): float(moments[contact.ahead == ahead].sum() / torque)
            for ahead in np.unique(contact.ahead)
        },
        max_pressure=float(solution.pressure.max()),
        line_loads=line_loads(contact.ahead, contact.face, solution.pressure * contact.system.weight),
    )


def solve_full_contact_helical(
    pair: ParallelAxes,
    torques: Sequence[float],
    positions: Sequence[float],
    misalignments: Sequence[float] = (0.0,),
    mesh: HelicalMesh | None = None,
    *,
    estimate_error: bool = False,
    report: Report | None = None,
) -> tuple[FullContactTable, ...]:
    """Solve the contact of a helical pair with bodies in three dimensions and the contact resolved.

    Each gear is condensed once, in a frame that turns with its helix, to the flanks of the teeth that may
    touch. Pressure follows the contact lines on hats of its own; what the mesh over the face gives way too
    little under them is that of a fine section in which nothing varies along the line. No penalty, no law of
    Hertz, no law of tip edges. Displacements are small: gaps are those of the undeformed gears. Raises
    `InputError`: a pair that it does not hold, a torque that is not positive, a misalignment that is no
    number; `MeshError`, `SolveError`: a section cannot be meshed or condensed.

    Parameters
    ----------
    pair : GearPair
        External, helical or spur, clamped, solid, of equal faces, with sharp tips (`refusal_helical`).
    torques, positions : sequence of float
        On gear 1, N m, > 0; by the driving gear, base pitches.
    misalignments : sequence of float
        Tilt of the axes in the plane of action as growth of the gap over the face, m; zero at the pitch point
        in mid-face.
    estimate_error : bool
        Solve on a coarser mesh too and state the difference as error.
    report : callable, optional
        Called with the fraction done before each position.

    Returns
    -------
    tuple of FullContactTable
        One for each misalignment, which share CPU seconds evenly.
    """
    if (reason := refusal_helical(pair)) is not None:
        raise InputError("pair", "this pair", f"one that helical full contact holds; {reason}")
    check_axes(torques, positions, misalignments)
    usual, clock = mesh or HelicalMesh(), StageClock()
    with clock.stage("bodies"):
        meshes = [usual, usual.coarser] if estimate_error else [usual]
        bodies = [_condensed(pair, max(torques), sizes) for sizes in meshes]
    solved = []
    for count, position in enumerate(positions):
        if report is not None:
            report(count / len(positions))
        with clock.stage(f"position {count}"):
            by_body = [_solved_position(body, position, torques, misalignments) for body in bodies]
        with_error = by_body[0].with_error(by_body[1]) if estimate_error else by_body[0]
        seconds = clock.seconds[f"position {count}"] + clock.seconds["bodies"] / len(positions)
        solved.append(replace(with_error, cpu_seconds=seconds))
    return tables_of(positions, torques, solved)


def _solved_position(
    body: _CondensedPair, position: float, torques: Sequence[float], misalignments: Sequence[float]
) -> SolvedPosition:
    """Solve one position under all misalignments and torques."""
    contacts = tuple(_solved(body, position, torques, misalignment) for misalignment in misalignments)
    return SolvedPosition(contacts, body.unknowns)
