"""The transmission error of a loaded pair at one position, by full finite-element contact."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from fe_contact.full_contact.calculix import Run, run_calculix
from fe_contact.full_contact.condensation.placed_mesh import placed_bodies
from fe_contact.full_contact.condensation.resolution import Resolution
from fe_contact.full_contact.condensation.sites import Range, contact_sites
from fe_contact.full_contact.input_deck import Loading, input_deck, numbered_bodies
from fe_contact.full_contact.placed_pair import PlacedPair, no_load_gap, placed_pair
from fe_contact.full_contact.point import FullContactPoint
from fe_contact.full_contact.result_file import read_printed
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz.line_contact import contact_modulus, peak_pressure
from fe_contact.types import Status

OVERLAP_PART = 1e-4
"""Of the deflection that the overlap of the penalty may take: 1 nm in 10 um."""
START_PART = 0.01
"""Of the deflection by which teeth overlap at the start: more costs iterations, none leaves gear 1 loose."""
REACHED = 2.0
"""Deflections by which teeth off the path of contact may come to touch."""
MESH_MODULUS = 20e9 / 210e9
"""Deflection of steel teeth, about 20 N/(mm um), over the modulus of elasticity: a first guess."""


def solve_position(
    program: str,
    pair: ParallelAxes,
    normal_force: float,
    position: float,
    cpu_limit: float,
    resolution: Resolution | None = None,
) -> FullContactPoint:
    """Solve one position on a mesh of its own: that of the condensed peer.

    Parameters
    ----------
    program : str
        CalculiX.
    pair : GearPair or InternalGearPair
        Without `refusal`.
    normal_force : float
        N; its torque is that of gear 1.
    position : float
        By the driven gear, base pitches; any.
    cpu_limit : float
        CPU seconds.
    resolution : Resolution, optional

    Raises
    ------
    MeshError
        There is no mesh.
    """
    phase = position - round(position)
    line_load = normal_force / pair.face_width
    guess = line_load / (MESH_MODULUS * pair.pinion.material.youngs_modulus)
    gap = no_load_gap(pair, phase)
    held = Range((line_load, line_load), gap + REACHED * guess)
    fineness = resolution or Resolution()
    bodies = placed_bodies(pair, phase, contact_sites(pair, phase, held, fineness), fineness)
    placed = placed_pair(pair, bodies, gap + START_PART * guess)
    loading = _loading(pair, normal_force, guess)
    with TemporaryDirectory(prefix="full_contact_") as folder:
        run = run_calculix(program, input_deck(placed, loading), Path(folder), cpu_limit)
    if not run.status.usable:
        return _failed(run)
    return _point(pair, placed, loading, position, run)


def _loading(pair: ParallelAxes, normal_force: float, deflection: float) -> Loading:
    """Return the load, with a penalty that the peak pressure of Hertz makes yield a given part."""
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    radius = 1.0 / float(pair.relative_curvature(pair.path_of_contact.pitch_point))
    pressure = float(peak_pressure(normal_force / pair.face_width, radius, modulus))
    return Loading(
        materials=(pair.pinion.material, pair.wheel.material),
        base_radius=pair.pinion.base_radius,
        face_width=pair.face_width,
        transverse_force=float(pair.transverse_force(normal_force)),
        penalty=pressure / (OVERLAP_PART * deflection),
    )


def _point(
    pair: ParallelAxes, placed: PlacedPair, loading: Loading, position: float, run: Run
) -> FullContactPoint:
    """Read what was printed."""
    try:
        printed = read_printed(run.printed)
    except ValueError as error:
        return _failed(Run(Status.ITERATION_LIMIT, str(error), run.iterations, ""))
    driving, driven = placed.gears
    points = driven.points[printed.nodes - numbered_bodies(placed.gears)[1].first_node]
    torque = loading.transverse_force * loading.base_radius
    lag = placed.approach + printed.turning
    return FullContactPoint(
        position=position + lag / pair.base_pitch,
        transmission_error=lag,
        status=Status.CONVERGED,
        reason="",
        iterations=run.iterations,
        residual=printed.moment(points, driving.center) / torque - 1.0,
        torque_ratio=abs(printed.moment(points, driven.center)) / torque,
    )


def _failed(run: Run) -> FullContactPoint:
    """Return a point without a solution."""
    return FullContactPoint.failed(run.status, run.reason, run.iterations)
