"""A run that shows one of its assumptions to be wrong is repeated, refused or reported."""

import threading
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, square_wave_table, with_mesh

from dynamics import CoastFlank, Outputs, RunResult, Scene, TimeLaw, simulate, simulate_to_file
from dynamics.errors import InputError, SolveError
from dynamics.simulation import interrupted_run
from dynamics.simulation.violations import needed_effects
from dynamics.types import Json, RunStatus


def dropped(**changes: object) -> Scene:
    """A load that falls in 0.2 ms to a twentieth: the teeth spring apart by more than the backlash."""
    scene = gear_pair_scene(spring_table(4e8), duration=0.008)
    falling = TimeLaw((0.0, 0.002, 0.0022, 0.01), (100.0, 100.0, 5.0, 5.0))
    scene = replace(scene, loads=(replace(scene.loads[0], torque=falling),), **changes)
    return with_mesh(scene, coast=CoastFlank(backlash=0.5e-6, thickness=0.48))


def same(one: RunResult, other: RunResult) -> None:
    """Bit by bit the same series."""
    for name in ("dynamic_transmission_error", "mesh_force", "coast_force", "bearing_force"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def backlash(result: RunResult) -> Json:
    """The entry of the effect."""
    return next(dict(one) for one in result.effect_ledger["entries"] if one["effect"] == "backlash")


def test_it_is_repeated_with_the_effect_and_says_so():
    repeated, explicit = simulate(dropped()), simulate(dropped(effects={"backlash": "on"}))
    same(repeated, explicit)
    assert repeated.coast_force.max() > 0.0
    entry = backlash(repeated)
    assert entry["on"]
    assert entry["choice"] == "auto"
    assert entry["reason"].startswith("on after a run without it")
    again = repeated.receipt["repeated"]
    assert set(again["turned_on"]) == {"backlash"}
    assert again["seconds"] > 0.0
    assert "repeated" not in explicit.receipt


def test_it_may_fail_or_be_reported_and_an_explicit_off_is_obeyed():
    with pytest.raises(SolveError, match="coast flanks are not reached") as caught:
        simulate(dropped(on_violation="fail"))
    reported = simulate(dropped(on_violation="report"))
    off = simulate(dropped(effects={"backlash": "off"}))
    for run in (reported, off, caught.value.partial):
        assert isinstance(run, RunResult)
        assert backlash(run)["holds"] is False
        assert not backlash(run)["on"]
        assert run.coast_force.size == 0
    assert needed_effects(reported.effect_ledger)
    assert not needed_effects(off.effect_ledger)
    with pytest.raises(InputError, match="on_violation"):
        dropped(on_violation="shrug")


def test_a_streamed_run_is_repeated_too_and_may_be_interrupted_in_between(tmp_path):
    scene, file = dropped(), tmp_path / "run.nc"
    assert simulate_to_file(scene, file) is RunStatus.COMPLETED
    same(RunResult.from_netcdf(file), simulate(scene))
    assert not interrupted_run(file).exists()
    stop = threading.Event()
    runs: list[float] = []

    def progress(fraction, what):
        if runs and fraction < runs[-1]:
            stop.set()  # the second run has begun
        runs.append(fraction)

    other = tmp_path / "other.nc"
    assert simulate_to_file(scene, other, progress=progress, cancel=stop.is_set) is RunStatus.CANCELLED
    assert simulate_to_file(scene, other, resume=True) is RunStatus.COMPLETED
    resumed = RunResult.from_netcdf(other)
    same(resumed, simulate(scene))
    assert set(resumed.receipt["repeated"]["turned_on"]) == {"backlash"}
    with pytest.raises(SolveError, match="not reached"):
        simulate_to_file(replace(scene, on_violation="fail"), file)


def test_forces_beyond_the_table_are_noticed():
    table = square_wave_table()
    calm = simulate(gear_pair_scene(table, duration=0.01))
    (check,) = (one for one in calm.effect_ledger["checks"] if one["assumption"] == "force inside the table")
    assert check["holds"]
    assert check["largest"] == pytest.approx(calm.largest_mesh_force.max(), rel=0.0)
    heavy = simulate(gear_pair_scene(table, torque=420.0, duration=0.01))
    (check,) = (one for one in heavy.effect_ledger["checks"] if one["assumption"] == "force inside the table")
    assert not check["holds"]
    assert check["beyond"] == pytest.approx(np.mean(heavy.largest_mesh_force > table.level[-1]), rel=1e-12)


def test_a_bearing_that_lets_go_is_noticed():
    def checks(result):
        found = result.effect_ledger["checks"]
        return [one for one in found if one["assumption"] == "linear bearing stays loaded"]

    calm = checks(simulate(gear_pair_scene(duration=0.01)))
    assert len(calm) == 4
    assert all(one["holds"] and one["unloaded"] == 0.0 for one in calm)
    run = simulate(dropped(effects={"backlash": "on"}))
    unloaded = checks(run)
    force = run.bearing_force[:, :2]
    first = force[:, :, 0] / np.linalg.norm(force[:, :, 0], axis=1)[:, None]
    share = np.mean(np.einsum("bct,bc->bt", force, first) <= 0.0, axis=1)
    assert share.max() > 0.0
    assert [one["unloaded"] for one in unloaded] == pytest.approx(share.tolist(), rel=1e-12)
    assert [one["holds"] for one in unloaded] == (share == 0.0).tolist()


def test_every_entry_of_the_ledger_is_complete():
    fields = {
        "effect", "part", "choice", "on", "reason", "influence_m", "called_for", "possible", "cost", "price",
        "checked", "holds",
    }  # fmt: skip
    scene = gear_pair_scene(duration=0.002, effects={"lateral": "off"})
    lean = simulate(replace(scene, outputs=Outputs(energy_audit=False, receipt="minimal")))
    result = simulate(scene)
    entries = result.effect_ledger["entries"]
    assert entries
    for entry in entries:
        assert set(entry) == fields
        assert all(entry[name] for name in ("reason", "cost", "checked"))
    lateral = next(one for one in entries if one["effect"] == "lateral")
    assert not lateral["on"]
    assert lateral["called_for"]
    size = result.effect_ledger["influences"]["lateral"]["words"]
    assert lateral["price"] == f"left out: {size}"
    without = next(one for one in lean.effect_ledger["entries"] if one["effect"] == "lateral")
    assert without["price"] == f"{1e6 * lateral['influence_m']:.3g} µm of static displacement neglected"
