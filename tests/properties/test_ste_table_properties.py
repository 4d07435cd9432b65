"""Laws of the mesh-force extraction over random tables: any knots, loads and shapes that rise with load."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fe_contact.ste import Metadata, PairGeometry, SteDatabase

SETTINGS = settings(suppress_health_check=[HealthCheck.too_slow])
QUERIES = np.random.default_rng(0).uniform(-3.0, 3.0, 400)


@st.composite
def tables(draw, alignments=((1, 1), (3, 1), (2, 3))):
    """A database with 1 to 40 positions, 1 to 6 loads, steps of any ratio, tangents of any size."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    positions, loads = draw(st.integers(1, 40)), draw(st.integers(1, 6))
    across, apart = draw(st.sampled_from(alignments))
    spread = draw(st.floats(0.0, 3.0))  # decades between the smallest and the largest step
    shape = (positions, loads, across, apart)
    force = np.cumsum(rng.uniform(10.0, 3000.0, loads))
    step = 10.0 ** rng.uniform(-6.0 - spread, -6.0, shape)
    lift_off = draw(st.sampled_from([0.0, 1e-7, 3e-5])) * rng.uniform(0.0, 1.0, (positions, across, apart))
    share = rng.dirichlet([0.5, 0.5, 0.5], shape)
    helix = draw(st.sampled_from([0.0, 0.4]))
    return SteDatabase(
        position=spaced(rng, positions),
        force=force,
        torque=force * 0.04 * np.cos(helix),
        misalignment=np.linspace(0.0, 5e-5, across),
        center_distance_change=np.linspace(-1e-4, 1e-4, apart),
        pair=[-1, 0, 1],
        static_transmission_error=lift_off[:, None] + np.cumsum(step, axis=1),
        tangent_compliance=10.0 ** rng.uniform(-10.0, -8.0, shape),
        no_load_transmission_error=lift_off,
        load_share=share,
        face_centroid=np.zeros(shape),
        max_pressure=np.full(shape, 1e9),
        pairs_in_contact=np.ones(shape),
        status=np.zeros(shape),
        error_estimate=np.full(shape, 1e-9),
        residuals=np.zeros((*shape, 4)),
        geometry=PairGeometry((20, 30), (0.04, 0.06), 0.0118, helix, 0.1, 0.35, 0.025, 0),
        metadata=Metadata(),
    )


def spaced(rng, count):
    """Knots in [0, 1) with gaps that differ up to a hundredfold."""
    gaps = 10.0 ** rng.uniform(-2.0, 0.0, count + 1)
    return np.cumsum(gaps)[:-1] / gaps.sum()


def alignment(database, seed=1):
    """Random misalignments and center distances inside the table, one per query."""
    rng = np.random.default_rng(seed)
    axes = (database.misalignment, database.center_distance_change)
    return [rng.uniform(axis[0], axis[-1], QUERIES.size) for axis in axes]


def loads(database, seed=2):
    """Normal forces from lift-off to beyond the top, one per query."""
    return np.random.default_rng(seed).uniform(0.0, 1.3 * database.force[-1], QUERIES.size)


@SETTINGS
@given(tables())
def test_force_of_the_inverse(database):
    force, at = loads(database), alignment(database)
    deflection = database.ste(QUERIES, force, *at)
    sample = database.force_at(QUERIES, deflection, *at)
    rounding = 8.0 * np.spacing(np.abs(deflection)) * sample.stiffness
    expected = force * np.cos(database.geometry.base_helix_angle)
    # the tangent at one point can be far below the slope a few roundings away: allow the secant's share too
    steepest = np.diff(database.force_table().level).max() / np.diff(database.force_table().deflection).min()
    allowed = 1e-10 * expected + rounding + 24.0 * np.spacing(np.abs(deflection)) * steepest
    assert np.all(np.abs(sample.force - expected) <= allowed)


@SETTINGS
@given(tables())
def test_stored_points_are_returned(database):
    grid = np.meshgrid(
        database.position,
        database.force,
        database.misalignment,
        database.center_distance_change,
        indexing="ij",
    )
    assert np.array_equal(database.ste(*grid), database.static_transmission_error)


@SETTINGS
@given(tables())
def test_levels_keep_their_order_everywhere(database):
    at = [values[:, None] for values in alignment(database)]
    levels = database.ste(QUERIES[:, None], np.r_[0.0, database.force], *at)
    assert np.all(np.diff(levels, axis=1) > 0.0)


@pytest.mark.law
@SETTINGS
@given(tables())
def test_force_is_monotone_in_deflection(database):
    at = [values[:40, None] for values in alignment(database)]
    x = QUERIES[:40, None]
    bottom, top = database.ste(x, 0.0, *at), database.ste(x, 1.2 * database.force[-1], *at)
    sample = database.force_at(x, bottom + np.linspace(-0.1, 1.0, 500) * (top - bottom), *at)
    assert np.all(np.diff(sample.force, axis=1) >= -1e-11 * database.force[-1])
    assert np.all(sample.stiffness >= 0.0)
    assert np.all(sample.force[:, 0] == 0.0)


@SETTINGS
@given(tables(alignments=((1, 1),)))
def test_curves_stay_between_neighboring_knots(database):
    """No overshoot in position, whatever the steps."""
    levels = database.ste(QUERIES[:, None], database.force)
    stored = database.static_transmission_error[:, :, 0, 0]
    right = np.searchsorted(database.position, QUERIES % 1.0, side="right") % database.position.size
    low, high = np.minimum(stored[right - 1], stored[right]), np.maximum(stored[right - 1], stored[right])
    assert np.all(levels >= low * (1.0 - 1e-13))
    assert np.all(levels <= high * (1.0 + 1e-13))


@SETTINGS
@given(tables(), st.integers(-5, 5))
def test_position_has_period_one(database, turns):
    force, at = loads(database), alignment(database)
    here, there = database.ste(QUERIES, force, *at), database.ste(QUERIES + turns, force, *at)
    assert np.allclose(here, there, rtol=1e-9, atol=1e-15)


@SETTINGS
@given(tables())
def test_c1_in_position_and_deflection(database):
    """The stated derivatives are those of the force: central differences close up with the step.

    At random points: no knot is within the smallest step of a query.
    """
    at = alignment(database)
    deflection = database.ste(QUERIES, loads(database), *at)
    sample = database.force_at(QUERIES, deflection, *at)
    for slope, by in ((sample.stiffness, (0.0, 1.0)), (sample.position_slope, (1.0, 0.0))):
        scale = np.abs(slope).max()
        errors = []
        for step in (1e-3, 1e-6):
            dx = by[0] * step * np.diff(database.position, append=1.0 + database.position[0]).min()
            dd = by[1] * step * np.diff(database.force_table().deflection, axis=-1).min()
            after = database.force_at(QUERIES + dx, deflection + dd, *at).force
            before = database.force_at(QUERIES - dx, deflection - dd, *at).force
            moved = 2.0 * dx if by[0] else (deflection + dd) - (deflection - dd)
            errors.append(np.abs((after - before) / moved - slope).max())
        assert min(errors) <= 2e-2 * scale + 1e-300


@SETTINGS
@given(tables(), st.floats(0.05, 1.0))
def test_shares_are_a_partition(database, part):
    curve = database.curve(
        force=part * database.force[-1],
        at=QUERIES,
        misalignment=float(database.misalignment.mean()),
        center_distance_change=float(database.center_distance_change.mean()),
    )
    assert np.all(curve.load_share >= 0.0)
    assert curve.load_share.sum(axis=1) == pytest.approx(np.ones(QUERIES.size), abs=1e-12)


@SETTINGS
@given(tables(alignments=((1, 1),)), st.floats(0.1, 10.0), st.floats(0.1, 10.0))
def test_scaling_of_lengths_and_forces(database, length, strength):
    """Deflections times s and forces times q give the same table in other units."""
    scaled = SteDatabase(
        **{
            name: getattr(database, name)
            for name in [
                "position",
                "misalignment",
                "center_distance_change",
                "pair",
                "load_share",
                "face_centroid",
                "max_pressure",
                "pairs_in_contact",
                "status",
                "residuals",
                "geometry",
                "metadata",
            ]
        },
        force=database.force * strength,
        torque=database.torque * strength,
        static_transmission_error=database.static_transmission_error * length,
        no_load_transmission_error=database.no_load_transmission_error * length,
        tangent_compliance=database.tangent_compliance * length / strength,
        error_estimate=database.error_estimate * length,
    )
    force = loads(database)
    assert np.allclose(
        scaled.ste(QUERIES, force * strength), database.ste(QUERIES, force) * length, rtol=1e-7
    )
