"""The FMU's force is the library's: everywhere on the table, below it and beyond it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fmu_instance import Instance
from geared_scenes import BASE_RADIUS, gear_pair_scene, repeated, square_wave_table, with_mesh

from dynamics.bodies import TimeLaw
from dynamics.engines import MeshElement, mesh_element
from dynamics.engines.fmu import export_fmu
from dynamics.forces.flank_force import FlankLaws, flank_force
from dynamics.forces.packed_tables import pack_tables
from dynamics.forces.technique import table_at
from dynamics.simulate import simulate
from dynamics.system.scene import Outputs


def hunting_table(period: int):
    """Pitches that differ, knots that do not begin at zero."""
    table = repeated(square_wave_table(), period)
    phase = 2.0 * np.pi * table.position[:, None] / period
    position, height = table.position + 0.004, 1e-6 * np.cos(phase)
    slope = -1e-6 * np.sin(phase) * 2.0 * np.pi / period
    return replace(
        table,
        position=position,
        deflection=table.deflection + height,
        deflection_slope=table.deflection_slope + slope,
    )


def table_with_axes():
    """Misalignment and centre distance: softer and later contact away from zero."""
    one, m, d = square_wave_table(), np.array([-10e-6, 0.0, 30e-6]), np.array([-1e-4, 2e-4])
    scale = 1.0 + 2e4 * np.abs(m)[:, None] + 500.0 * d[None, :]
    later = 0.05 * np.abs(m)[:, None] + 0.001 * d[None, :]
    grow = scale[:, :, None, None]
    return replace(
        one,
        misalignment=m,
        center_distance_change=d,
        deflection=one.deflection * grow + later[:, :, None, None],
        deflection_slope=one.deflection_slope * grow,
        stiffness=one.stiffness / grow,
        stiffness_slope=one.stiffness_slope / grow,
    )


def library(element: MeshElement, table, x: float, d: float, rate: float):
    law = FlankLaws(pack_tables([table]), np.array([element.damping]), np.array([element.reach]))
    return flank_force(law, 0, x, d, rate, 0)


@pytest.mark.parametrize("table", [square_wave_table(), hunting_table(7)], ids=["one", "hunting"])
def test_it_is_the_librarys_force(element, rng, tmp_path, table):
    element = replace(element, table=table)
    top = 1.3 * table.deflection.max()
    seen = set()
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(dte_from_angles=False)
        for _ in range(600):
            angle, d, rate = rng.uniform(-9.0, 9.0), rng.uniform(-0.2, 1.0) * top, rng.uniform(-1.0, 1.0)
            unit.set(driver_angle=angle, displacement=d, displacement_rate=rate)
            x = 20 * angle / (2.0 * np.pi) + 0.3
            force, elastic, tangent, viscous, _ = library(element, table, x, d, rate)
            found = unit.get("mesh_force", "elastic_force", "stiffness", "viscosity")
            assert found == pytest.approx([force, elastic, tangent, viscous], rel=1e-9, abs=1e-9)
            state, validity = unit.get("contact_state", "validity")
            assert state == (elastic > 0.0)
            assert validity == (1 if elastic > table.level[-1] else 0)
            seen.add((state, validity, force > 0.0))
    assert {(0, 0, False), (1, 0, True), (1, 0, False), (1, 1, True)} <= seen  # (1, 0, False): no pull


def test_axes_are_the_tables_and_their_ends_are_told(element, rng, tmp_path):
    table = table_with_axes()
    element = replace(element, table=table)
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(dte_from_angles=False)
        assert unit.get("misalignment", "center_distance_change") == [0.0, -1e-4]  # nearest to zero
        places = [*zip(rng.uniform(-10e-6, 30e-6, 60), rng.uniform(-1e-4, 2e-4, 60), strict=True)]
        for m, d in [*places, (0.0, 2e-4), (30e-6, -1e-4), (-10e-6, 0.0)]:
            y = rng.uniform(0.0, 40e-6)
            unit.set(driver_angle=0.2, displacement=y, misalignment=m, center_distance_change=d)
            expected = library(element, table_at(table, m, d), 20 * 0.2 / (2 * np.pi) + 0.3, y, 0.0)[0]
            assert unit.get("mesh_force")[0] == pytest.approx(expected, rel=1e-9, abs=1e-9)
            assert unit.get("validity")[0] in {0, 1}
        for m, d, flag in ((31e-6, 0.0, 2), (0.0, -2e-4, 4), (-11e-6, 3e-4, 6)):
            unit.set(displacement=5e-6, misalignment=m, center_distance_change=d)
            nearest = table_at(table, float(np.clip(m, -10e-6, 30e-6)), float(np.clip(d, -1e-4, 2e-4)))
            expected = library(element, nearest, 20 * 0.2 / (2 * np.pi) + 0.3, 5e-6, 0.0)[0]
            assert unit.get("mesh_force")[0] == pytest.approx(expected, rel=1e-9, abs=1e-9)
            assert unit.get("validity")[0] == flag


def test_the_recorded_angles_of_a_run_give_its_mesh_force(tmp_path):
    """Angles about +z, the shafts' displacements along the line of action, and all rates, from a run."""
    scene = gear_pair_scene(speed=TimeLaw.constant(60.0), duration=0.05, outputs=Outputs(displacements=True))
    scene = with_mesh(scene, damping_ratio=0.15)
    run = simulate(scene)
    element = mesh_element(scene, scene.meshes[0].name)
    line = np.array(run.case["meshes"][0]["line_of_action"])
    state = {
        rate: {
            name: (run.velocity if rate else run.displacement)[index]
            for index, name in enumerate(run.freedom)
        }
        for rate in (False, True)
    }
    driver, driven = (shaft.name for shaft in scene.shafts)

    def along(rate: bool):
        return sum(
            sign * (line[0] * state[rate][f"{shaft}.x"] + line[1] * state[rate][f"{shaft}.y"])
            for sign, shaft in ((1.0, driver), (-1.0, driven))
        )

    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start()
        worst = 0.0
        for k in range(run.time.size):
            angle = 60.0 * run.time[k]
            unit.set(
                driver_angle=angle,
                driven_angle=angle - state[False][f"{driven}.rotation"][k],
                driver_speed=60.0,
                driven_speed=60.0 - state[True][f"{driven}.rotation"][k],
                displacement=along(False)[k],
                displacement_rate=along(True)[k],
            )
            unit.unit.doStep(run.time[k], 5e-5)
            force = unit.get("mesh_force")[0]
            worst = max(worst, abs(force / run.mesh_force[0, k] - 1.0))
    assert np.ptp(run.mesh_force) > 100.0  # it moves
    assert worst < 1e-9


@pytest.mark.parametrize("turns", [3, 500_000, 100_000_000])
def test_whole_turns_change_no_bit(element, tmp_path, turns):
    """Counted apart from the angles: 3 turns of a 20-tooth driver are 2 of the 30-tooth driven gear."""
    names = ("position", "dte", "mesh_force", "driven_torque")
    with Instance(export_fmu(replace(element, table=hunting_table(3)), tmp_path / "m.fmu")) as unit:
        unit.start(driver_angle=0.7, driven_angle=0.7 / 1.5 - 1e-4, driver_speed=80.0, driven_speed=53.0)
        here = unit.get(*names)
        unit.set(driver_turns=3 * turns, driven_turns=2 * turns)
        assert unit.get(*names) == here
        unit.set(driver_turns=3 * turns + 1)
        assert unit.get("position")[0] == pytest.approx((here[0] + 20) % 3, abs=1e-12)
        assert unit.get("dte")[0] == pytest.approx(here[1] + 20 * element.base_pitch, rel=1e-12)


def test_the_torques_are_one_force_on_two_base_circles(element, rng, tmp_path):
    """Action and reaction: torques as the radii, and their power is what the flanks take."""
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start()
        loaded = 0
        for _ in range(100):
            w1, w2 = rng.uniform(-0.02, 0.02, 2) + np.array([90.0, 60.0])
            a1 = rng.uniform(0.0, 6.0)
            a2 = a1 / 1.5 - rng.uniform(-1e-4, 5e-4)
            unit.set(driver_angle=a1, driven_angle=a2, driver_speed=w1, driven_speed=w2)
            force, t1, t2, axial, rate = unit.get(
                "mesh_force", "driver_torque", "driven_torque", "driver_axial_force", "dte_rate"
            )
            assert t1 == pytest.approx(-force * BASE_RADIUS, rel=1e-14, abs=0.0)
            assert t2 == pytest.approx(-1.5 * t1, rel=1e-14, abs=0.0)
            assert axial == pytest.approx(force * np.tan(0.2), rel=1e-14, abs=0.0)
            assert t1 * w1 + t2 * w2 == pytest.approx(-force * rate, abs=1e-12 * max(abs(t1 * w1), 1.0))
            loaded += force > 0.0
    assert 50 < loaded < 100
