"""Phases of meshes against a count by hand: gears drawn at random are turned until their flanks touch."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_trains import PlacedGear, Train, off_pitches, position, touching

from dynamics.errors import InputError
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.motion_checks import check_motion
from dynamics.mechanism.train_phases import train_phases
from dynamics.meshes import CoastFlank

DRAWS = range(3)
CLOSE = 1e-9  # of a pitch


def phases_of(scene):
    return train_phases(scene, solve_kinematics(scene).mesh_sense)


def chain(random):
    """Three gears of 20 teeth in a row."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    for name in "abc":
        train.add(name, 20, share=random.uniform(0.5, 0.7))
    angle, direction = random.uniform(0.3, 0.42), random.uniform(-math.pi, math.pi)
    train.mesh("a", "b", angle, direction)
    train.mesh("b", "c", angle, direction)
    return train


def angled_idler(random):
    """An idler between gears at an angle, at different working pressure angles."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    for name in "abc":
        train.add(name, int(random.integers(17, 60)), share=random.uniform(0.5, 0.7))
    train.mesh("a", "b", random.uniform(0.3, 0.42), random.uniform(-math.pi, math.pi))
    train.mesh("b", "c", random.uniform(0.3, 0.42), random.uniform(-math.pi, math.pi))
    return train


def bull_gear(random):
    """A bull gear that a pinion drives and that drives another one, and a pinion that drives it too."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    train.add("first", int(random.integers(17, 30)), share=random.uniform(0.5, 0.7), helix=0.3)
    train.add("bull", int(random.integers(50, 90)), share=random.uniform(0.5, 0.7), helix=-0.3)
    train.add(
        "second", int(random.integers(17, 30)), share=random.uniform(0.5, 0.7), helix=0.3, position=0.055
    )
    train.add(
        "output", int(random.integers(17, 30)), share=random.uniform(0.5, 0.7), helix=0.3, position=0.045
    )
    train.mesh("first", "bull", 0.38, random.uniform(-math.pi, math.pi))
    for link in (("bull", "second"), ("bull", "output")):
        train.mesh(*link, random.uniform(0.33, 0.4), random.uniform(-math.pi, math.pi))
    train.links[1] = ("second", "bull")
    return train


def planets(random):
    """Three planets between sun and ring, whose teeth fit; sun or ring drives."""
    train = Train(frame="carrier", speed=random.choice([-10.0, 10.0]))
    sun, planet = int(random.integers(20, 40)), int(random.integers(20, 30))
    ring = sun + 2 * planet
    ring += -(sun + ring) % 3
    share, outer = random.uniform(0.5, 0.7), random.uniform(0.38, 0.4)
    inner = math.acos(math.cos(outer) * (ring - planet) / (sun + planet))
    start = random.uniform(-math.pi, math.pi)
    train.add("sun", sun, share=random.uniform(0.5, 0.7))
    train.add("ring", ring, share=random.uniform(0.2, 0.3), internal=True)
    for index in range(3):
        train.add(f"planet {index}", planet, share=share)
        train.mesh("sun", f"planet {index}", outer, start + index * 2.0 * math.pi / 3.0)
    train.places["ring"] = (0.0, 0.0)
    for index in range(3):
        train.mesh(f"planet {index}", "ring", inner, 0.0)
    if random.random() < 0.5:
        train.links = [(driven, driver) for driver, driven in train.links]
    return train


def ring_between(random):
    """A ring gear that one pinion drives and that drives another one, at other pressure angles."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    train.add("first", 19, share=random.uniform(0.5, 0.7), helix=0.2)
    train.add("ring", 83, share=random.uniform(0.2, 0.3), helix=0.2, internal=True)
    train.add("second", 31, share=random.uniform(0.5, 0.7), helix=0.2, position=0.056)
    start = random.uniform(-math.pi, math.pi)
    train.mesh("first", "ring", random.uniform(0.33, 0.4), start)
    train.mesh("ring", "second", random.uniform(0.33, 0.4), start + random.uniform(1.5, 4.0))
    return train


def reverse_idler(random):
    """A reverse gear: the idler stands beside the line of both shafts."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    for name, teeth in (("input", 18), ("idler", 23), ("output", 41)):
        train.add(name, teeth, share=random.uniform(0.5, 0.7))
    up = random.uniform(0.5, 1.2)
    train.mesh("input", "idler", 0.36, up)
    train.mesh("idler", "output", 0.38, -up)
    return train


def compound(random):
    """Two stages on an intermediate shaft that states the angle between its gears."""
    train = Train(speed=random.choice([-10.0, 10.0]))
    train.add("pinion", int(random.integers(17, 30)), share=random.uniform(0.5, 0.7), helix=0.2)
    train.add(
        "wheel", int(random.integers(50, 90)), share=random.uniform(0.5, 0.7), helix=-0.2, shaft="middle"
    )
    train.add("small", 19, share=random.uniform(0.5, 0.7), helix=0.25, shaft="middle", position=0.1)
    train.add("large", 57, share=random.uniform(0.5, 0.7), helix=-0.25, position=0.1)
    train.mesh("pinion", "wheel", random.uniform(0.3, 0.42), random.uniform(-math.pi, math.pi))
    train.mesh("small", "large", random.uniform(0.3, 0.42), random.uniform(-math.pi, math.pi))
    train.angles["middle"] = (random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0))
    return train


TRAINS = {
    "chain": chain,
    "idler at an angle": angled_idler,
    "bull gear": bull_gear,
    "planets": planets,
    "ring between pinions": ring_between,
    "reverse idler": reverse_idler,
    "compound": compound,
}


def counted_by_hand(scene, start, links=()):
    """Return positions of all meshes, the first one at `start`: each gear is turned until it touches."""
    placed, counted = {}, {}
    senses = solve_kinematics(scene).mesh_sense
    centers = {shaft.name: shaft.origin[:2] for shaft in scene.shafts}
    waiting = dict(enumerate(scene.meshes))
    while waiting:
        for index, mesh in list(waiting.items()):
            driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
            if not placed:
                bare = PlacedGear(driver, centers[driver.shaft], 0.0)
                other = PlacedGear(driven, centers[driven.shaft], 0.0)
                z = middle(driver, driven)
                turned = start - position(bare, other, senses[0], senses[0], z)
                placed[driver.name] = replace(bare, angle=senses[0] * turned * 2.0 * math.pi / driver.teeth)
            if not {driver.name, driven.name} & set(placed):
                continue
            del waiting[index]
            counted[index] = mesh_by_hand(scene, index, senses[index], placed, centers)
            for shaft, first, second, angle in links:
                if first in placed and second not in placed:
                    body = scene.gear(second)
                    placed[second] = PlacedGear(body, centers[shaft], placed[first].angle + angle)
    return np.array([counted[index] for index in range(len(scene.meshes))]), placed


def middle(driver, driven):
    low = max(gear.position - gear.face_width / 2.0 for gear in (driver, driven))
    high = min(gear.position + gear.face_width / 2.0 for gear in (driver, driven))
    return (low + high) / 2.0


def mesh_by_hand(scene, index, sense, placed, centers):
    mesh = scene.meshes[index]
    driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
    z = middle(driver, driven)
    follows = sense if driver.internal or driven.internal else -sense
    if driver.name not in placed:
        placed[driver.name] = touching(placed[driven.name], driver, centers[driver.shaft], -follows, sense, z)
    at_driver = placed[driver.name]
    touched = touching(at_driver, driven, centers[driven.shaft], sense, -follows, z)
    placed.setdefault(driven.name, touched)
    off = off_pitches((placed[driven.name].angle - touched.angle) * driven.teeth / (2.0 * math.pi))
    assert abs(off) < CLOSE, (mesh.name, off)
    return position(at_driver, placed[driven.name], sense, sense, z)


@pytest.mark.parametrize("draw", DRAWS)
@pytest.mark.parametrize("name", [name for name in TRAINS if name != "compound"])
def test_phases_are_where_the_teeth_touch(name, draw):
    scene = TRAINS[name](np.random.default_rng(draw)).scene()
    phases = phases_of(scene)
    counted, _ = counted_by_hand(scene, phases.position[0])
    assert np.max(np.abs(off_pitches(phases.position - counted))) < CLOSE
    assert phases.angles == () and phases.thickness == ()


@pytest.mark.parametrize("draw", DRAWS)
def test_a_shaft_states_the_angle_between_its_gears(draw):
    """Which tooth of the first gear the angle counts from is open: the train may start a pitch later."""
    train = compound(np.random.default_rng(draw))
    scene = train.scene()
    phases = phases_of(scene)
    one, other = train.angles["middle"]
    teeth = train.gears["wheel"].teeth
    off = []
    for tooth in range(teeth):
        links = [("middle", "wheel", "small", other - one + tooth * 2.0 * math.pi / teeth)]
        counted, _ = counted_by_hand(scene, phases.position[0], links)
        off.append(abs(off_pitches(phases.position[1] - counted[1])))
    assert min(off) < CLOSE < np.sort(off)[1]
    assert phases.angles == ()


def test_an_angle_that_nobody_states_is_assumed_and_named():
    train = compound(np.random.default_rng(0))
    stated = {
        name: phases_of(replace_angles(train, (0.3, 0.3 + by))) for name, by in (("0", 0.0), ("d", 1e-3))
    }
    phases = phases_of(replace_angles(train, None))
    assert phases.position == pytest.approx(stated["0"].position, abs=1e-12)
    (assumed,) = phases.angles
    assert (assumed.shaft, assumed.gears) == ("middle", ("wheel", "small"))
    pitches = 1e-3 * 19 / (2.0 * math.pi)
    sense = solve_kinematics(train.scene()).mesh_sense[1]
    moved = off_pitches(stated["d"].position - stated["0"].position)
    assert moved == pytest.approx(sense * pitches * assumed.moves, abs=1e-12)


def replace_angles(train, angles):
    return replace(train, angles={} if angles is None else {"middle": angles}).scene()


def test_a_straight_chain_of_even_teeth_shifts_by_half_a_pitch():
    train = Train()
    for name in "abc":
        train.add(name, 20)
    train.mesh("a", "b", 0.35, 0.4)
    train.mesh("b", "c", 0.35, 0.4)
    phases = phases_of(train.scene())
    assert phases.position == pytest.approx([0.0, 0.5], abs=1e-12)
    assert phases.thickness == ("b",)


def test_a_stated_position_that_contradicts_the_geometry_is_refused_with_both_values():
    train = chain(np.random.default_rng(1))
    geometry = phases_of(train.scene()).position[1]
    for off, stated in ((0.0, geometry), (2e-3, geometry + 2e-3), (1.0, geometry + 1.0)):
        scene = replace(train, offsets={"b-c": stated}).scene()
        if off == 2e-3:
            with pytest.raises(InputError) as error:
                check_motion(scene)
            assert error.value.field == "meshes[1].position_offset"
            assert f"{stated}:" in str(error.value) and f"{geometry:.9g}," in str(error.value)
        else:
            assert phases_of(scene).position[1] == stated


def test_a_stated_position_says_how_thick_teeth_are_that_nobody_measured():
    train = chain(np.random.default_rng(1))
    train.gears["b"] = replace(train.gears["b"], base_tooth_thickness=None)
    phases = phases_of(replace(train, offsets={"b-c": 0.31}).scene())
    assert phases.thickness == () and phases.position[1] == 0.31
    thick = phases_of(train.scene())
    assert thick.thickness == ("b",)


def test_the_coast_flank_says_how_thick_teeth_are():
    train = chain(np.random.default_rng(1))
    train.gears["b"] = replace(train.gears["b"], base_tooth_thickness=None)
    scene, share = train.scene(), 0.46
    second = replace(scene.meshes[0], coast=CoastFlank(0.02 * train.gears["b"].base_pitch, share))
    given = phases_of(replace(scene, meshes=(second, scene.meshes[1])))
    half = phases_of(scene)
    assert given.position[1] - half.position[1] == pytest.approx(1.0 - share - 0.02 - 0.5, abs=1e-12)


def test_an_angle_that_the_train_does_not_leave_open_is_refused_with_both_values():
    """Two compound shafts side by side: the second has the angle that the first one leaves."""
    scene = split_power(0.0)
    with pytest.raises(InputError) as error:
        check_motion(scene)
    assert error.value.field == "shafts[2].tooth_angles[1]"
    fits = float(str(error.value).split("must be ")[-1].split(" rad")[0])
    for whole in (0.0, 2.0 * math.pi / 43, 2.0 * math.pi / 20):  # a tooth of either gear on
        check_motion(split_power(fits + whole))
    assert phases_of(split_power(None)).angles == ()


def split_power(angle):
    """Two intermediate shafts between the same two gears."""
    train = Train()
    train.add("in", 21, share=0.6)
    for side in "ab":
        train.add(f"wheel {side}", 43, share=0.6, shaft=side)
        train.add(f"small {side}", 20, share=0.6, shaft=side, position=0.1)
    train.add("out", 61, share=0.6, position=0.1)
    train.mesh("in", "wheel a", 0.36, 0.7)
    train.mesh("in", "wheel b", 0.36, -0.7)
    apart = 81e-3 / math.cos(0.38)
    x, y = train.places["a"]
    train.places["out"] = (x + math.sqrt(apart**2 - y**2), 0.0)
    train.mesh("small a", "out", 0.38, 0.0)
    train.mesh("small b", "out", 0.38, 0.0)
    train.angles["a"] = (0.0, 0.1)
    if angle is not None:
        train.angles["b"] = (0.0, angle)
    return train.scene()


def test_teeth_that_nobody_can_assemble_are_refused():
    train = planets(np.random.default_rng(0))
    train.gears["planet 1"] = replace(train.gears["planet 1"], base_tooth_thickness=1.5e-3)
    with pytest.raises(InputError, match="assemble"):
        check_motion(train.scene())


def over_pitches(mesh, count):
    """The mesh with a table that repeats after so many pitches."""
    table = mesh.table
    position = np.concatenate([table.position + pitch for pitch in range(count)])
    names = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
    long = {name: np.tile(getattr(table, name), (1, 1, count, 1)) for name in names}
    return replace(mesh, table=replace(table, position=position, period=count, **long))


def test_planets_meet_the_same_tooth_of_the_ring_one_after_the_other():
    """Positions count the teeth of the central gear: its deviations reach all planets."""
    train = planets(np.random.default_rng(2))
    scene = train.scene()
    scene = replace(
        scene, meshes=tuple(over_pitches(mesh, train.gears["ring"].teeth) for mesh in scene.meshes)
    )
    position = phases_of(scene).position[3:]
    teeth, period = train.gears["ring"].teeth, train.gears["ring"].teeth
    apart = np.abs(np.diff(position))
    np.testing.assert_allclose(np.minimum(apart % period, -apart % period), teeth / 3.0, atol=1e-9)
