"""Results that no effect can mend end a run or a study: unbalanced work, loads beyond the table."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, square_wave_table, with_mesh
from sliced_face import rigid_share_database

from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.linearize import forced_response, modal_analysis
from dynamics.linearize.linear_system import about_running
from dynamics.loads import TimeLaw
from dynamics.meshes import CoastFlank
from dynamics.periodic import steady_states
from dynamics.results import EnergyAudit, RunResult
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate, simulate_to_file

TOP = 10640.0 * BASE_RADIUS  # N m, the last load of the square-wave table


def check(ledger, start):
    (found,) = (one for one in ledger["checks"] if one["assumption"].startswith(start))
    return found


def test_a_step_that_misses_the_motion_is_no_result(tmp_path):
    """A fixed step of 1 ms at 955 rpm leaves 9 % of the turnover."""
    blind = gear_pair_scene(duration=0.2, integration=Integration(fixed_step=1e-3))
    with pytest.raises(SolveError, match="not accounted for: shorten the fixed step") as caught:
        simulate(blind)
    assert caught.value.partial.energy.relative > 0.05
    file = tmp_path / "run.nc"
    with pytest.raises(SolveError, match="work is balanced"):
        simulate_to_file(blind, file)
    assert check(RunResult.from_netcdf(file).effect_ledger, "work is balanced")["valid"] is False
    reported = check(simulate(replace(blind, on_violation="report")).effect_ledger, "work is balanced")
    assert reported["holds"] is False
    assert reported["unaccounted"] == pytest.approx(caught.value.partial.energy.relative, rel=1e-12)
    sound = simulate(gear_pair_scene(duration=0.02, on_violation="fail"))
    assert check(sound.effect_ledger, "work is balanced")["holds"]
    assert sound.energy.relative < 1e-3


def test_friction_that_drives_is_found():
    """Friction in the sense of the scene, as if nothing ever turned round: it gives back what it took."""
    law = TimeLaw((0.0, 0.01, 0.03, 0.04), (50.0, 50.0, -50.0, -50.0))
    table = rigid_share_database(40).force_table()
    scene = with_mesh(gear_pair_scene(table, speed=law, duration=0.04), friction=0.06)
    system = about_running(assemble(scene))
    run = integrate(system, static_equilibrium(system), scene.integration)
    audit = EnergyAudit.from_arrays(run.work, run.stored, run.fallen)
    assert abs(audit.friction) < 0.2 * audit.fallen
    found = audit.check()
    assert found.valid is False
    assert "it supplied energy" in found.reason
    assert EnergyAudit.from_json(audit.to_json()) == audit


@pytest.mark.parametrize("study", ["run", "modes", "response", "steady"])
def test_loads_beyond_the_table_end_every_study(study):
    make = {
        "run": lambda scene: simulate(scene).effect_ledger,
        "modes": lambda scene: modal_analysis(assemble(scene)).metadata["effect_ledger"],
        "response": lambda scene: forced_response(assemble(scene), [90.0], 1).metadata["effect_ledger"],
        "steady": lambda scene: steady_states(assemble(scene), [40.0], branch=False).metadata[
            "effect_ledger"
        ],
    }[study]
    scene = gear_pair_scene(square_wave_table(8), duration=0.002)

    def loaded(times, **changes):
        load = replace(scene.loads[0], torque=TimeLaw.constant(times * TOP))
        return replace(scene, loads=(load,), **changes)

    if study in ("run", "modes"):
        calm = check(make(loaded(0.5)), "force inside")
        assert calm["holds"]
        assert calm["valid"]
        over = check(make(loaded(1.1)), "force inside")
        assert not over["holds"]
        assert over["valid"]
        with pytest.raises(SolveError, match="force inside the table"):
            make(loaded(1.1, on_violation="fail"))
    far = loaded(1.3)
    with pytest.raises(SolveError, match=r"1.064e\+04 N; above it .* 1\.2 times\. .* it ends at 399\.9 N m"):
        make(far)
    reported = check(make(replace(far, on_violation="report")), "force inside")
    assert reported["valid"] is False
    assert reported["largest"] == pytest.approx(1.3 * 10640.0, rel=0.1)


def test_a_coast_flank_is_held_to_the_loads_of_its_table():
    scene = gear_pair_scene(square_wave_table(16), torque=-1.3 * TOP, duration=0.001)
    scene = with_mesh(scene, coast=CoastFlank(backlash=20e-6, thickness=0.48))
    points = Outputs(20e3, anti_alias=False)
    run = simulate(replace(scene, on_violation="report", effects={"backlash": "on"}, outputs=points))
    found = check(run.effect_ledger, "force inside")
    assert found["valid"] is False
    assert found["largest"] == pytest.approx(float(np.max(run.coast_force)), rel=1e-12)
