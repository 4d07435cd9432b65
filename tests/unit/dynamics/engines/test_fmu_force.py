"""The FMU's force is the library's: everywhere on the table, below it and beyond it."""

from dataclasses import replace

import numpy as np
import pytest
from fmu_instance import Instance
from geared_scenes import BASE_RADIUS, gear_pair_scene, repeated, square_wave_table, with_mesh

from dynamics import CoastFlank, Outputs, TimeLaw, simulate
from dynamics.engines import MeshElement, mesh_element
from dynamics.engines.fmu import export_fmu
from dynamics.errors import InputError
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.technique import mirrored, table_at


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
    """Misalignment and center distance: softer and later contact away from zero."""
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


def test_axes_are_the_tables_and_their_ends_are_reported(element, rng, tmp_path):
    table = table_with_axes()
    element = replace(element, table=table)
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(dte_from_angles=False)
        assert unit.get("misalignment", "center_distance_change") == [0.0, -1e-4]  # nearest to zero
        locations = [*zip(rng.uniform(-10e-6, 30e-6, 60), rng.uniform(-1e-4, 2e-4, 60), strict=True)]
        for m, d in [*locations, (0.0, 2e-4), (30e-6, -1e-4), (-10e-6, 0.0)]:
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
    scene = gear_pair_scene(
        speed=TimeLaw.constant(60.0),
        duration=0.05,
        outputs=Outputs(20e3, displacements=True, anti_alias=False),
    )
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

    def along(rate):
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


def test_the_coast_flank_reads_the_table_at_the_other_misalignment(element, tmp_path):
    """Seen turned about the line of centers, the gap grows towards the other end."""
    table = table_with_axes()
    element = replace(element, table=table, coast=CoastFlank(20e-6, 0.47))
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(dte_from_angles=False, misalignment=-8e-6, center_distance_change=1e-4, displacement=-1e-3)
        for approach in (1e-6, 5e-6, 12e-6):
            unit.set(coast_displacement=approach + 20e-6)
            back = mirrored(table_at(table, 8e-6, 1e-4), 0.47)
            force = library(element, back, 0.3, approach, 0.0)[0]
            assert unit.get("coast_force")[0] == pytest.approx(force, rel=1e-7) and force > 1.0
        assert unit.get("validity") == [0]
        unit.set(misalignment=20e-6)  # -20 um is beyond the table's axis
        assert unit.get("validity") == [2]
        with pytest.raises(Exception, match="fmi2SetReal"):
            unit.set(backlash=-1e-6)


@pytest.mark.parametrize("table", [square_wave_table(), hunting_table(7)], ids=["one", "hunting"])
def test_the_coast_flank_is_the_librarys(element, rng, tmp_path, table):
    """The mirror rule, its own approach with the backlash, the same damping; torques are those of both."""
    coast = CoastFlank(20e-6, 0.47)
    element = replace(element, table=table, coast=coast)
    back, top = mirrored(table_at(table, 0.0, 0.0), coast.thickness), 1.2 * table.deflection.max()
    seen = set()
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start()
        for _ in range(400):
            angle, lag = rng.uniform(-9.0, 9.0), rng.uniform(-1.0, 1.0) * (top + 20e-6)
            speed, along, across = (
                rng.uniform(-10.0, 10.0),
                rng.uniform(-5e-6, 5e-6),
                rng.uniform(-5e-6, 5e-6),
            )
            driven = (20 / 30) * angle - lag / element.base_radius[1]
            unit.set(
                driver_angle=angle,
                driven_angle=driven,
                driver_speed=speed,
                driven_speed=0.0,
                displacement=along,
                coast_displacement=across,
                coast_displacement_rate=0.01,
            )
            x, rotated = 20 * angle / (2.0 * np.pi) + 0.3, element.base_radius[0] * speed
            error = element.base_radius[0] * angle - element.base_radius[1] * driven
            approach = across - error - coast.backlash
            force, elastic, tangent, viscous, _ = library(element, back, x, approach, 0.01 - rotated)
            found = unit.get("coast_force", "coast_approach", "coast_stiffness", "coast_viscosity")
            assert found == pytest.approx([force, approach, tangent, viscous], rel=1e-7, abs=1e-9)
            drive, touched, *_ = library(element, table, x, error + along, rotated)
            assert unit.get("mesh_force")[0] == pytest.approx(drive, rel=1e-7, abs=1e-7)
            torques = unit.get("driver_torque", "driven_torque", "driver_axial_force")
            r1, r2 = element.base_radius
            both = (drive - force) * np.array([-r1, r2, np.tan(element.base_helix_angle)])
            assert torques == pytest.approx(both, rel=1e-7, abs=1e-7)
            state = int(unit.get("contact_state")[0])
            assert state == int(touched > 0.0) + 2 * int(elastic > 0.0)
            seen.add(state)
    assert seen == {0, 1, 2}


def test_rattle_comes_back_from_its_recorded_motion(tmp_path):
    """A lightly loaded pair thrown between its flanks; the coast flank's line mirrors the other one."""
    speed = TimeLaw((0.0, 0.01, 0.02), (60.0, 60.0, 20.0))
    scene = gear_pair_scene(
        speed=speed,
        duration=0.03,
        torque=1.0,
        outputs=Outputs(20e3, displacements=True, anti_alias=False),
        effects={"backlash": "on"},
    )
    scene = with_mesh(scene, coast=CoastFlank(5e-6, 0.48), damping_ratio=0.05)
    run = simulate(scene)
    element = mesh_element(scene, scene.meshes[0].name)
    assert element.coast == CoastFlank(5e-6, 0.48)
    n = np.array(run.case["meshes"][0]["line_of_action"])[:2]
    e = np.array([1.0, 0.0])  # from the driver's center to the driven one's
    lines = {"displacement": n, "coast_displacement": 2.0 * (n @ e) * e - n}
    location = {name: index for index, name in enumerate(run.freedom)}
    driver, driven = (shaft.name for shaft in scene.shafts)

    def along(line, series, k):
        return sum(
            sign * (line @ [series[location[f"{shaft}.{axis}"], k] for axis in "xy"])
            for sign, shaft in ((1.0, driver), (-1.0, driven))
        )

    worst = 0.0
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start()
        for k in range(run.time.size):
            lag, lagging = (s[location[f"{driven}.rotation"], k] for s in (run.displacement, run.velocity))
            angle = 2.0 * np.pi * run.position[0, k] / 20
            unit.set(
                driver_angle=angle,
                driven_angle=angle - lag,
                driver_speed=0.0,
                driven_speed=-lagging,
                **{name: along(line, run.displacement, k) for name, line in lines.items()},
                **{f"{name}_rate": along(line, run.velocity, k) for name, line in lines.items()},
            )
            found = np.array(unit.get("mesh_force", "coast_force"))
            exact = np.array([run.mesh_force[0, k], run.coast_force[0, k]])
            worst = max(worst, float(np.max(np.abs(found - exact))))
    assert run.coast_force.max() > 100.0 and run.mesh_force.max() > 100.0
    assert worst < 1e-6 * run.coast_force.max()


def test_a_coast_flank_with_a_table_of_its_own_is_refused(element):
    with pytest.raises(InputError) as caught:
        replace(element, coast=CoastFlank(5e-6, 0.5, square_wave_table()))
    assert caught.value.field == "coast.table"
