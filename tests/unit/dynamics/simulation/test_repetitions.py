"""What a repetition goes on from, and the checks of neglected effects for a tolerance or by name."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, with_gear, with_mesh
from sliced_face import sliced_database

from dynamics import CoastFlank, Outputs, RunResult, Scene, TimeLaw, simulate, simulate_to_file
from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.influence import decide_effects
from dynamics.integrators import march
from dynamics.integrators.start_value import added_rows
from dynamics.simulation.violations import needed_effects
from dynamics.types import Json

SERIES = ("dynamic_transmission_error", "mesh_force", "bearing_force", "drive_torque")


def dropped(**changes: object) -> Scene:
    """A slightly helical pair at speed whose load falls in 0.2 ms to a twentieth: the teeth spring apart."""
    scene = gear_pair_scene(spring_table(4e8, 3e-7), duration=0.006, speed=TimeLaw.constant(5000.0 * RPM))
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.01), 1, base_helix_angle=-0.01)
    falling = TimeLaw((0.0, 0.003, 0.0032, 0.01), (100.0, 100.0, 5.0, 5.0))
    bushings = tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings)
    loads = (replace(scene.loads[0], torque=falling),)
    return replace(scene, loads=loads, bushings=bushings, **changes)


def coasting(**changes: object) -> Scene:
    """The same with a near coast flank, whose need nothing foretells, and gyroscopic elements behind it."""
    coast = CoastFlank(backlash=0.5e-6, thickness=0.48)
    scene = with_mesh(dropped(), coast=coast, table=spring_table(4e8))
    return replace(scene, effects={"gyroscopic": "on", **scene.effects}, **changes)


def same(one: RunResult, other: RunResult) -> None:
    """Bit by bit the same series."""
    for name in SERIES:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def check(result: RunResult, assumption: str) -> Json:
    """The first entry of an assumption."""
    return next(dict(one) for one in result.effect_ledger["checks"] if assumption in one["assumption"])


def test_a_run_without_coast_flanks_is_repeated_from_where_the_teeth_had_not_parted(tmp_path, monkeypatch):
    monkeypatch.setattr(march, "BLOCK_WORK", 0)  # save this short run's state as often as a long one's
    scene = coasting()
    repeated = simulate(scene)
    explicit = simulate(replace(scene, effects={**scene.effects, "backlash": "on"}))
    same(repeated, explicit)
    np.testing.assert_array_equal(repeated.coast_force, explicit.coast_force)
    assert repeated.coast_force.max() > 0.0
    assert repeated.statistics == explicit.statistics
    assert repeated.energy == explicit.energy
    since = repeated.receipt["repeated"]["since"]
    reported = simulate(replace(scene, on_violation="report"))
    last = check(reported, "coast flanks")["since"]
    assert last == pytest.approx(reported.time[np.argmax(reported.least_mesh_force[0] <= 0.0) - 1], abs=0.0)
    assert last - scene.duration / 50.0 - scene.integration.largest_step < since <= last
    file = tmp_path / "run.nc"
    simulate_to_file(scene, file)
    streamed = RunResult.from_netcdf(file)
    same(streamed, explicit)
    assert streamed.receipt["repeated"]["since"] == since


def test_rows_are_matched_in_their_order():
    before = assemble(coasting())
    after = assemble(replace(coasting(), effects={"gyroscopic": "on", "backlash": "on"}))
    rows = added_rows(before, after)
    np.testing.assert_array_equal(after.arrays.direction[rows], before.arrays.direction)
    assert rows.tolist() == [0, *range(2, after.arrays.direction.shape[0])]
    assert added_rows(after, before) is None
    assert added_rows(before, assemble(replace(coasting(), effects={"axial": "off"}))) is None


@pytest.mark.law
def test_what_a_tolerance_neglected_is_on_after_flanks_parted():
    scene = dropped(tolerance=0.5)
    left = set(decide_effects(scene).neglected)
    assert "axial" in left
    repeated = simulate(scene)
    on = simulate(dropped(effects=dict.fromkeys(left, "on")))
    same(repeated, on)
    again = repeated.receipt["repeated"]
    assert set(again["turned_on"]) == left
    assert again["turned_on"]["axial"].startswith("flanks lifted off: the linear theory")
    assert again["since"] == 0.0
    entry = next(one for one in repeated.effect_ledger["entries"] if one["effect"] == "axial")
    assert entry["on"] and entry["reason"].startswith("on after a run without it: flanks lifted off")
    with pytest.raises(SolveError, match=r"neglected effects are negligible \(\w+\): flanks lifted off"):
        simulate(replace(scene, on_violation="fail"))
    calm = replace(scene, duration=0.003, on_violation="fail")
    seen = check(simulate(calm), "negligible")
    assert seen["holds"] and seen["change"] < 0.05


@pytest.fixture(scope="module")
def table():
    knots = (-60e-6, -30e-6, -10e-6, 0.0, 10e-6, 30e-6, 60e-6)
    return sliced_database(knots, (-1e-4, 0.0, 1e-4), positions=12).force_table()


def test_tilt_that_a_table_does_not_follow_is_noticed(table):
    """The pair off the middle of its shafts, one bushing unlike the others."""
    scene = gear_pair_scene(table, duration=0.004, outputs=Outputs(displacements=True))
    scene = with_gear(with_gear(scene, 0, position=0.02), 1, position=0.02)
    softer = replace(scene.bushings[0], radial_stiffness=2e7)
    scene = replace(scene, bushings=(softer, *scene.bushings[1:]))
    followed = simulate(scene)
    off = simulate(replace(scene, effects={"dynamic_misalignment": "off"}))
    found = check(off, "tilt stays")
    misaligned = followed.misalignment[0]
    assert abs(found["farthest"]) == pytest.approx(np.max(np.abs(misaligned)), rel=0.05)
    assert not found["holds"]
    settled = slice(off.time.size // 4, None)
    means = [np.mean(run.dynamic_transmission_error[0, settled]) for run in (followed, off)]
    assert 1.0 < found["change"] / (means[0] / means[1] - 1.0) < 2.0  # the farthest against all along
    assert not needed_effects(off.effect_ledger)  # switched off by name: only said
    with pytest.raises(SolveError, match="tilt stays at the operating point"):
        simulate(replace(scene, effects={"dynamic_misalignment": "off"}, on_violation="fail"))
    assert "tilt stays" not in str(followed.effect_ledger["checks"])
