"""The pair in its bushings, by this package's integrator and by Exudyn's, on the same mesh-force table."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, with_bushings, with_gear, with_mesh

from benchmarks.exudyn_scene import run_in_exudyn
from dynamics import Integration, Outputs, TimeLaw, simulate
from dynamics.errors import InputError

pytest.importorskip("exudyn", reason="Exudyn is not installed: pip install exudyn")

OUTPUTS = Outputs(20e3, bearing_forces=False, energy_audit=False, anti_alias=False)


def scene(speed: float = 900.0, **changes):
    changed = gear_pair_scene(speed=TimeLaw.constant(speed * RPM), duration=0.04, outputs=OUTPUTS)
    return replace(with_mesh(changed, damping_ratio=0.15), **changes)


def difference(changed, **settings) -> float:
    """Rms difference of the transmission errors over the rms of their swing."""
    run = simulate(replace(changed, integration=Integration(tolerance=1e-11)))
    other = run_in_exudyn(changed, **settings)
    np.testing.assert_allclose(other.time, run.time, rtol=0.0, atol=1e-12)
    own = run.dynamic_transmission_error[0]
    return float(np.sqrt(np.mean((other.dynamic_transmission_error - own) ** 2)) / np.std(own))


def test_both_engines_give_one_transmission_error(record_figure):
    found = difference(scene(), solver="RK44", step=5e-6)
    title = "DTE of the 20/20 pair on four bushings, 900 rpm, in Exudyn, over its swing"
    record_figure(title, 100 * found, "below 1 %", "%", "the same law in two engines")
    assert found < 1e-4  # the explicit method at a quarter of what 1 % allows for its steps


def test_the_implicit_method_converges_to_it_with_its_order():
    """Exudyn's generalized-alpha method is of order 2: its Jacobian is the element's, its limit ours."""
    coarse, fine = (difference(scene(), solver="GeneralizedAlpha", step=step) for step in (1e-5, 5e-6))
    assert fine < 0.01
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.15)


def test_backwards():
    assert difference(scene(speed=-900.0), solver="RK44", step=5e-6) < 1e-4


def test_where_flanks_part():
    """A light load cannot follow 40 um of error at the first pitches; more would rattle without order."""
    changed = gear_pair_scene(
        spring_table(4e8, 40e-6, level=1e4),
        speed=TimeLaw.constant(900.0 * RPM),
        torque=5.0,
        duration=0.04,
        outputs=OUTPUTS,
    )
    assert np.mean(simulate(changed).mesh_force == 0.0) > 0.01
    assert difference(changed, solver="RK44", step=2e-6) < 2e-3


def test_scenes_that_are_not_rebuilt_are_refused():
    ramp = scene()
    ramp = replace(ramp, drives=(replace(ramp.drives[0], speed=TimeLaw.ramp(0.0, 90.0, 1.0)),))
    stiff = with_bushings(scene(), preload=(1.0, 0.0, 0.0, 0.0, 0.0))
    off_center = with_gear(with_gear(scene(), 0, position=0.05), 1, position=0.05)
    for changed, field in ((ramp, r"drives\[0\].speed"), (stiff, "bushings"), (off_center, "effects")):
        with pytest.raises(InputError, match=f"^{field} = "):
            run_in_exudyn(changed)
    with pytest.raises(InputError, match=r"^solver = "):
        run_in_exudyn(scene(), solver="euler")
