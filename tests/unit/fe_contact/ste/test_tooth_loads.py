"""Laws of the loads of each tooth: they sum to the load, follow the deviations, and are alike without."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import Gear, GearPair, PitchDeviation, SteDatabase, analyze
from fe_contact.errors import DatabaseError, SolveError
from fe_contact.ste.tooth_loads import ToothLoads

EARLY, TORQUE = 7, 100.0
TEETH = 17, 23


def helical(pinion: dict[int, float], wheel: dict[int, float]) -> GearPair:
    """Pair of overlap ratio 0.7 with teeth, by their numbers, that much early, m."""
    first, second = (
        Gear(
            teeth,
            3e-3,
            20e-3,
            25e-3,
            helix_angle=sign * math.radians(20.0),
            pitch_deviation=PitchDeviation(tuple(early.get(k, 0.0) for k in range(1, teeth + 1))),
        )
        for teeth, early, sign in zip(TEETH, (pinion, wheel), (1, -1), strict=True)
    )
    return GearPair(first, second)


def table_of(pair: GearPair) -> SteDatabase:
    return analyze(pair, torques=[30.0, TORQUE], level="draft", receipt="minimal", positions=8)


@pytest.fixture(scope="module")
def early():
    return table_of(helical({EARLY: 3e-6}, {}))


@pytest.mark.law
def test_the_loads_of_the_teeth_sum_to_the_load_at_each_position(early):
    """Each tooth of the pinion meets once in a period, so its row is its way through mesh."""
    (pinion,) = early.tooth_loads(torque=TORQUE)
    node = np.arange(early.position.size) % 8
    pitch = early.position.astype(int)
    columns = np.arange(early.pair.size) * 8
    teeth = (pitch[:, None] - early.pair) % TEETH[0]
    force = pinion.force_over_phase[teeth, columns + node[:, None]]
    assert force.sum(axis=1) == pytest.approx(np.full(node.size, early.force[1]), rel=1e-12)
    assert pinion.phase[columns[0] : columns[0] + 8] == pytest.approx(early.pair[0] + early.position[:8])


@pytest.mark.law
@pytest.mark.parametrize("tooth", [1, EARLY, 17])
def test_the_tooth_that_is_early_carries_most(early, tooth):
    """Its neighbors carry less, and those that never share with it as in the nominal pair."""
    table = early if tooth == EARLY else table_of(helical({tooth: 3e-6}, {}))
    (pinion,) = table.tooth_loads(torque=TORQUE)
    nominal = table_of(helical({}, {}))
    expected = float(nominal.force[1] * nominal.load_share[:, 1].max())
    force = np.roll(pinion.force, 1 - tooth)
    assert (pinion.gear, pinion.most_loaded) == (0, (tooth,))
    assert force[0] == pinion.force.max() > 1.03 * expected
    assert force[[1, -1]].max() < expected
    assert force[5:-5] == pytest.approx(np.full(7, expected), rel=1e-9)
    assert pinion.over_mean == pytest.approx(force[0] / force.mean())


@pytest.mark.law
def test_over_a_hunting_cycle_a_tooth_is_largest_over_all_its_mates():
    """Of both gears a tooth is early: each is the worst of its gear, most where the two meet."""
    table = table_of(helical({3: 3e-6}, {20: 2e-6}))
    assert table.period == TEETH[0] * TEETH[1]
    pinion, wheel = table.tooth_loads(torque=TORQUE)
    assert (pinion.gear, pinion.most_loaded, wheel.gear, wheel.most_loaded) == (0, (3,), 1, (20,))
    maximum = table.force[1] * table.load_share[:, 1].max()
    assert pinion.force.max() == pytest.approx(maximum) and wheel.force.max() == pytest.approx(maximum)
    assert (pinion.force.size, wheel.force.size) == TEETH


def test_teeth_that_are_alike_are_not_told_apart(early):
    assert table_of(helical({}, {})).tooth_loads(torque=TORQUE) == ()
    assert [own.gear for own in early.tooth_loads(torque=TORQUE)] == [0]
    (wheel,) = table_of(helical({}, {5: 3e-6})).tooth_loads(torque=TORQUE)
    assert (wheel.gear, wheel.most_loaded) == (1, (5,))


def test_a_table_with_failed_points_answers_from_complete_rows(early):
    status, ste = early.status.copy(), early.static_transmission_error.copy()
    status[3, 1], ste[3, 1] = 1, np.nan
    share = early.load_share.copy()
    share[3, 1] = np.nan
    failed = replace(early, status=status, static_transmission_error=ste, load_share=share)
    with pytest.raises(SolveError):
        failed.tooth_loads(torque=TORQUE)
    (pinion,) = failed.tooth_loads(torque=TORQUE, allow_failed=True)
    assert pinion.most_loaded == (EARLY,) and np.isfinite(pinion.force).all()


@pytest.mark.law
def test_the_pressure_of_the_pairs_is_that_of_the_table(early):
    """Of all pairs the largest is the largest pressure, and pairs that carry nothing have none."""
    assert np.array_equal(early.pair_pressure.max(axis=-1), early.max_pressure)
    assert np.all((early.pair_pressure > 0.0) <= (early.load_share > 0.0))
    (pinion,) = early.tooth_loads(torque=TORQUE)
    assert pinion.most_pressed == (EARLY,)
    assert pinion.pressure.max() == early.max_pressure[:, 1].max()
    nominal = table_of(helical({}, {}))
    assert nominal.pair_pressure.size == 0
    far = np.roll(pinion.pressure, 1 - EARLY)[5:-5]
    assert far == pytest.approx(np.full(7, nominal.max_pressure[:, 1].max()), rel=1e-9)


def test_tables_without_the_pressure_of_pairs_have_the_forces_alone(early, tmp_path):
    """As files of earlier versions; with it files are read as they were written."""
    older = replace(early, pair_pressure=np.empty((0,) * 5))
    for name, table in (("older", older), ("own", early)):
        table.to_netcdf(tmp_path / f"{name}.nc")
        assert SteDatabase.from_netcdf(tmp_path / f"{name}.nc").identical(table)
    (pinion,) = older.tooth_loads(torque=TORQUE)
    assert pinion.most_loaded == (EARLY,) and pinion.most_pressed == () and np.isnan(pinion.pressure).all()
    with pytest.raises(DatabaseError, match="pair_pressure must have the dimensions of load_share"):
        replace(early, pair_pressure=early.pair_pressure[..., :1])


@pytest.mark.law
def test_pitches_by_derivatives_have_the_loads_of_all_pitches():
    """Within what the receipt states, on every tooth of both gears; the worst is solved."""
    draw = np.random.default_rng(3)
    pair = helical(*({k: draw.normal(0.0, 2e-6) for k in range(1, teeth + 1)} for teeth in TEETH))
    options = {"torques": [TORQUE], "level": "draft", "positions": 16}
    derived, whole = analyze(pair, **options), analyze(pair, **options, receipt="minimal")
    cycle = derived.metadata.receipt["cycle"]
    assert 0 < cycle["solved"][0] < TEETH[0] * TEETH[1] / 4
    assert np.array_equal(derived.pair_pressure.max(axis=-1), derived.max_pressure)
    for own, exact in zip(*(table.tooth_loads(torque=TORQUE) for table in (derived, whole)), strict=True):
        share = 2.0 * cycle["share_error"] * derived.force[0]
        assert own.force == pytest.approx(exact.force, abs=share)
        pressure = 2.0 * cycle["pressure_error_relative"] * exact.pressure.max()
        assert own.pressure == pytest.approx(exact.pressure, abs=pressure)
        assert own.most_pressed == exact.most_pressed
        assert own.pressure.max() == pytest.approx(exact.pressure.max(), rel=1e-9)


def test_one_tooth_that_carries_a_little_less_tells_none_apart():
    forces = np.where(np.arange(29) == 24, 1927.0, 1928.2)[:, None]
    alike = ToothLoads(0, np.zeros(1), forces, forces)
    assert alike.most_loaded == alike.most_pressed == ()
    pressed = forces.copy()
    pressed[3] *= 1.001
    assert ToothLoads(0, np.zeros(1), pressed, forces).most_loaded == (4,)
