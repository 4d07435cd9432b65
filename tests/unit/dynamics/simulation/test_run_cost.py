"""What a run costs before it begins: the steps of a probe are those of the run, and it leaves nothing."""

from dataclasses import replace

import pytest
from geared_scenes import gear_pair_scene, square_wave_table, with_bushings

from dynamics.assembly.assemble import assemble
from dynamics.integrators import code_choice
from dynamics.integrators.march import advance_to
from dynamics.loads import TimeLaw
from dynamics.simulation import run_cost, run_scene
from dynamics.simulation.run_cost import FINER, PARTS, WINDOW_SHARE, _probe, probe_run
from dynamics.structure_code.machine_code import CodeStore


@pytest.fixture
def scene():
    """A pair whose flanks jump in stiffness: its steps are those of its motion, not the largest."""
    pair = with_bushings(gear_pair_scene(square_wave_table()))
    return replace(pair, duration=0.2)


def test_a_probe_takes_the_steps_of_the_run(scene):
    system = assemble(scene)
    probed = sum(_probe(system, part * scene.duration).steps for part in PARTS) / len(PARTS)
    taken = run_scene(scene).statistics
    assert probed * scene.duration == pytest.approx(taken.accepted + taken.rejected, rel=0.3)


def test_a_run_of_few_steps_is_probed_as_a_whole(scene, monkeypatch):
    """However few they are: the next stretch would be no longer."""
    lasted = []

    def counted(march, code, until, sink):
        lasted.append(until)
        assert len(lasted) <= 2
        return advance_to(march, code, until, sink)

    monkeypatch.setattr(run_cost, "advance_to", counted)
    short = replace(scene, duration=1e-6)
    assert 0.0 < _probe(assemble(short), 0.0).seconds < 1e9


def test_a_prediction_is_linear_in_the_duration(scene, monkeypatch):
    monkeypatch.setattr(run_cost, "_probe", lambda *_: run_cost._Probe(0.0, 3.0, 1e5, False, False))
    monkeypatch.setattr(run_cost, "cpu_seconds", lambda: 0.0)
    probed, longer = probe_run(scene), probe_run(replace(scene, duration=0.4))
    once = probed.seconds(1, with_errors=True)
    assert longer.seconds(1, with_errors=True) == pytest.approx(2.0 * once)
    assert probed.seconds(7, with_errors=True) == pytest.approx(7.0 * once)
    assert probed.seconds(1, with_errors=False) == pytest.approx(once / (1.0 + (1.0 + FINER) * WINDOW_SHARE))


@pytest.mark.parametrize("light", [False, True])
def test_light_damping_costs_a_finer_run(scene, monkeypatch, light):
    monkeypatch.setattr(run_cost, "_probe", lambda *_: run_cost._Probe(0.0, 3.0, 1e5, False, light))
    monkeypatch.setattr(run_cost, "cpu_seconds", lambda: 0.0)
    probed = probe_run(scene)
    ratio = probed.seconds(1, with_errors=True) / probed.seconds(1, with_errors=False)
    assert (ratio > 2.5) == light


def test_code_of_their_own_serves_all_runs(scene, monkeypatch):
    monkeypatch.setattr(run_cost, "_probe", lambda *_: run_cost._Probe(0.0, 3.0, 1e5, True, False))
    monkeypatch.setattr(run_cost, "cpu_seconds", lambda: 0.0)
    once, many = (probe_run(scene).seconds(runs, with_errors=True) for runs in (1, 1000))
    assert many == pytest.approx(1000.0 * once / run_cost.FASTER, rel=0.02)


def test_a_prediction_follows_the_speed_over_the_run(scene, monkeypatch):
    """A run that ends fast costs what its steps there cost, too."""
    slow = replace(scene.drives[0], speed=TimeLaw.constant(0.2 * scene.drives[0].speed.extreme))
    system = assemble(scene)
    rising = TimeLaw.ramp(slow.speed.extreme, scene.drives[0].speed.extreme, scene.duration)
    run_up = assemble(replace(scene, drives=(replace(scene.drives[0], speed=rising),)))
    early, late = (_probe(run_up, part * scene.duration).steps for part in (PARTS[0], PARTS[-1]))
    assert early < late
    assert late == pytest.approx(_probe(system, 0.0).steps, rel=0.4)


def test_a_probe_neither_makes_code_nor_counts_as_a_run(scene, monkeypatch, tmp_path):
    store = CodeStore(tmp_path)
    monkeypatch.setattr(code_choice, "_store", lambda: store)
    monkeypatch.setattr(code_choice, "WORTHWHILE", 0.0)
    monkeypatch.setattr(code_choice, "SEEN", 0.0)
    monkeypatch.setattr(code_choice, "_module", lambda _: pytest.fail("it makes code"))
    before = dict(code_choice._spent)
    probe_run(replace(scene, integration=replace(scene.integration, method="explicit")))
    assert code_choice._spent == before
