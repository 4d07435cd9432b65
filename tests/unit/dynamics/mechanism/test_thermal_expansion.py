"""A scene at temperature against closed forms."""

import math
from dataclasses import replace

import pytest
from geared_scenes import spring_table
from planetary_scenes import planetary_scene, published_set
from warm_scenes import (
    ALUMINUM,
    ANGULAR,
    DEEP_GROOVE,
    LEFT,
    RIGHT,
    STEEL,
    TAPERED,
    distant,
    mirrored,
    warm_pair,
)

from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.bearings.ring_fits import RingFits
from dynamics.bearings.row_law import row_law
from dynamics.bearings.spring_curve import SpringCurve
from dynamics.bearings.warm_rings import Cylinder, fit_pressure, warm_rings
from dynamics.effects.bearing_temperature import axial_state
from dynamics.effects.ledger import mechanism_of
from dynamics.errors import InputError
from dynamics.mechanism.thermal_expansion import warmed_bearings
from dynamics.mechanism.warm_meshes import warmed_meshes
from dynamics.solid_housing import CAST_ALUMINUM, Material
from dynamics.temperatures import Temperatures

EXACT = {"rel": 1e-6, "abs": 1e-15}
REFERENCE = 20.0
STRAIGHT = replace(TAPERED, profile="straight")
FITS = RingFits(30e-3, 62e-3, 100.0, 10e-6, 12e-6)


def strain(expansion, temperature):
    return expansion * (temperature - REFERENCE)


def end_play(scene):
    return axial_state([part for part in scene.rolling_bearings if part.shaft == "input"])


# Rings.


def test_a_ring_warmer_inside_takes_its_difference_over_the_pitch_circle():
    warm = warmed_bearings(warm_pair(rings=(75.0, 60.0))).rolling_bearings[0]
    expected = DEEP_GROOVE.clearance + DEEP_GROOVE.pitch_diameter * STEEL * (60.0 - 75.0)
    assert warm.row.clearance == pytest.approx(expected, **EXACT)


def test_a_contact_angle_turns_play_across_into_play_along():
    row = warmed_bearings(warm_pair((TAPERED, mirrored(TAPERED)), rings=(60.0, 80.0))).rolling_bearings[1].row
    expected = TAPERED.pitch_diameter * STEEL * 20.0 / (2.0 * math.tan(TAPERED.contact_angle))
    assert row.clearance == pytest.approx(expected, **EXACT)


def test_a_ring_in_a_wall_and_on_a_shaft_of_its_own_steel_gives_the_ratio_of_diameters():
    """Of one steel a solid shaft and an endless wall pass interference on by the ratio of diameters."""
    inner, outer = DEEP_GROOVE.raceways
    shaft, wall = Cylinder(0.0, 1.0, strain=2e-4), Cylinder(0.0, 1e6, strain=-1e-4)
    play = warm_rings(DEEP_GROOVE, FITS, (0.0, 0.0), shaft, wall).play
    expected = (
        -FITS.bore * 2e-4 * FITS.bore / inner - FITS.outside_diameter * 1e-4 * outer / FITS.outside_diameter
    )
    assert play == pytest.approx(expected, **EXACT)


def test_a_ring_in_a_bore_of_aluminum_by_lame():
    bore, wall = 62e-3, 90e-3
    ring = Cylinder(52e-3, bore)
    housing = Cylinder(bore, wall, CAST_ALUMINUM.youngs_modulus, CAST_ALUMINUM.poissons_ratio)
    interference, young = 20e-6, (210e9, 73e9)
    own = ((bore**2 + 52e-3**2) / (bore**2 - 52e-3**2) - 0.3) / young[0]
    around = ((wall**2 + bore**2) / (wall**2 - bore**2) + 0.33) / young[1]
    pressure = interference / (bore * (own + around))
    assert fit_pressure(ring, housing, interference) == pytest.approx(pressure, **EXACT)
    narrowed = 2.0 * pressure * bore**2 * 52e-3 / (young[0] * (bore**2 - 52e-3**2))
    assert -ring.far_side(bore) * pressure == pytest.approx(narrowed, **EXACT)
    assert fit_pressure(ring, housing, -1e-6) == 0.0


def test_a_fit_that_opens_gives_its_interference_back_and_no_more():
    """The housing leaves the ring: its play is that without any interference, however warm it gets."""
    scenes = [warm_pair(rings=(20.0, 20.0), shafts=20.0, housing=t, fits=FITS) for t in (120.0, 180.0)]
    plays = [warmed_bearings(scene).rolling_bearings[0].row.clearance for scene in scenes]
    assert plays[0] == plays[1] > DEEP_GROOVE.clearance
    loose = [warmed_bearings(scene).temperatures.bearings["input left"].loose for scene in scenes]
    opened = FITS.outside_diameter * strain(ALUMINUM, 120.0) - FITS.housing_interference
    assert loose[0] == pytest.approx({"outer ring": opened}, **EXACT)


# Pairs on a shaft.


@pytest.mark.parametrize("row", [STRAIGHT, ANGULAR], ids=["tapered", "angular"])
@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["O", "X"])
def test_the_play_of_a_pair_follows_shaft_housing_and_rings(row, sign):
    """A shaft that outgrows the housing loosens an O arrangement and tightens an X arrangement."""
    loose = replace(row, clearance=2e-4)
    rows = (loose, mirrored(loose)) if sign > 0.0 else (mirrored(loose), loose)
    scene = warm_pair(rows, shafts=90.0, housing=40.0, rings=(80.0, 60.0))
    grown = (RIGHT - LEFT) * (strain(STEEL, 90.0) - strain(ALUMINUM, 40.0))
    rings = row.pitch_diameter * STEEL * -20.0 / (2.0 * math.tan(row.contact_angle))
    assert end_play(scene) == pytest.approx((4e-4, 0.0), **EXACT)
    assert end_play(warmed_bearings(scene)) == pytest.approx(
        (4e-4 + sign * grown + 2.0 * rings, 0.0), **EXACT
    )


def test_a_preloaded_pair_by_its_law():
    """Straight rollers: preload = Z c sin(a) (x sin(a))^(10/9), x what each row is pressed along the axis."""
    scene = warm_pair(
        (STRAIGHT, mirrored(STRAIGHT)), preload=500.0, rings=(50.0, 50.0), shafts=30.0, housing=60.0
    )
    sine = math.sin(STRAIGHT.contact_angle)
    factor = STRAIGHT.count * STRAIGHT.element_stiffness * sine ** (19.0 / 9.0)
    pressed = (500.0 / factor) ** 0.9
    closer = (RIGHT - LEFT) * (strain(ALUMINUM, 60.0) - strain(STEEL, 30.0))
    expected = factor * (pressed + 0.5 * closer) ** (10.0 / 9.0)
    assert end_play(scene) == pytest.approx((0.0, 500.0), **EXACT)
    assert end_play(warmed_bearings(scene)) == pytest.approx((0.0, expected), **EXACT)


def test_a_preload_does_not_make_up_for_play():
    """The drawn preload is made once, cold; rings that yield to each other take it."""
    scene = warm_pair(
        (ANGULAR, mirrored(ANGULAR)), preload=300.0, rings=(20.0, 90.0), shafts=20.0, housing=20.0
    )
    play, force = end_play(warmed_bearings(scene))
    assert (play > 0.0, force) == (True, 0.0)


def test_one_locating_bearing_takes_no_axial_growth():
    scene = warm_pair()
    floating = tuple(
        replace(part, locating="none") if part.name.endswith("right") else part
        for part in scene.rolling_bearings
    )
    shifts = {
        part.axial_shift
        for part in warmed_bearings(replace(scene, rolling_bearings=floating)).rolling_bearings
    }
    assert shifts == {0.0}


def test_bushings_and_curves_push_as_the_shaft_grows():
    stiffness, grown = 1e8, 0.5 * (RIGHT - LEFT) * (strain(STEEL, 70.0) - strain(ALUMINUM, 50.0))
    sides = ("left", LEFT, -grown), ("right", RIGHT, grown)
    bushings = [
        Bushing(f"{s} {side}", s, z, 1e8, stiffness) for s in ("input", "output") for side, z, _ in sides
    ]
    curve = SpringCurve("input left", "z", (-1e-4, 1e-4), (-10.0, 10.0))
    scene = warm_pair(rolling_bearings=(), bushings=tuple(bushings), spring_curves=(curve,))
    warm = warmed_bearings(scene)
    pushed = [part.preload[2] for part in warm.bushings]
    assert pushed == pytest.approx([-stiffness * sides[k][2] for k in (0, 1, 0, 1)], **EXACT)
    assert warm.spring_curves[0].displacement == pytest.approx((-1e-4 + grown, 1e-4 + grown), **EXACT)


# Meshes.


def test_center_distance_and_backlash_of_a_pair():
    scene = warm_pair(table=distant(spring_table(4e8)), gears=60.0, housing=90.0)
    warm = warmed_meshes(scene).meshes[0]
    apart = 0.08 * (strain(ALUMINUM, 90.0) - strain(STEEL, 60.0))
    assert warm.center_distance_change == pytest.approx(apart, **EXACT)
    grown = 2.0 * math.sin(math.radians(20.0)) * apart
    assert warm.coast.backlash == pytest.approx(8e-5 + grown, **EXACT)


def test_backlash_is_that_of_involutes_that_grow():
    """j = p_b - s_b1 - s_b2 + 2 (r_b1 + r_b2) inv(alpha), every length of a gear grown with it."""
    radius, teeth, distance, housing, gear = 0.04 * math.cos(math.radians(20.0)), 20, 0.08, 2.0e-4, 5.0e-5

    def gap(center, grown):
        own, angle = radius * (1.0 + grown), math.acos(2.0 * radius * (1.0 + grown) / center)
        pitch = 2.0 * math.pi * own / teeth
        nominal = math.radians(20.0)
        thickness = (0.5 * 2.0 * math.pi * radius / teeth + 2.0 * radius * (math.tan(nominal) - nominal)) * (
            1.0 + grown
        )
        return pitch - 2.0 * thickness + 4.0 * own * (math.tan(angle) - angle)

    exact = gap(distance * (1.0 + housing), gear) - gap(distance, 0.0)
    temperatures = Temperatures(Material(73e9, 0.33, 2700.0, housing / 50.0), 70.0)
    scene = warm_pair(temperatures=temperatures)
    gears = tuple(replace(part, temperature=70.0, thermal_expansion=gear / 50.0) for part in scene.gears)
    change = warmed_meshes(replace(scene, gears=gears)).temperatures.meshes[0].backlash
    assert change == pytest.approx(exact, rel=1e-3)  # second order: strain over tan(alpha)^2


@pytest.mark.parametrize(("carrier", "planets"), [(120.0, 20.0), (20.0, 120.0)])
def test_a_carrier_carries_and_planets_grow_into_the_sun_and_the_ring(carrier, planets):
    scene = planetary_scene(published_set(3))
    frame = scene.shafts[0].frame
    on_pins = {part.shaft for part in scene.planet_bearings}
    shafts = [replace(part, temperature=carrier if part.name == frame else 20.0) for part in scene.shafts]
    gears = [replace(part, temperature=planets if part.shaft in on_pins else 20.0) for part in scene.gears]
    warm = Temperatures(CAST_ALUMINUM, 20.0)
    warm = warmed_meshes(
        replace(scene, shafts=tuple(shafts), gears=tuple(gears), temperatures=warm)
    ).temperatures
    for mesh, change in zip(scene.meshes, warm.meshes, strict=True):
        pair = [scene.gear(name) for name in (mesh.driver, mesh.driven)]
        distance = math.dist(*(scene.shaft(gear.shaft).origin[:2] for gear in pair))
        ring = any(gear.internal for gear in pair)
        sign = -1.0 if ring else 1.0
        radii = {gear.shaft in on_pins: gear.base_radius for gear in pair}
        acting = abs(radii[False] + sign * radii[True])
        growth = sign * radii[True] * distance / acting * strain(STEEL, planets)
        assert change.distance_change == pytest.approx(distance * strain(STEEL, carrier) - growth, **EXACT)
        yielded = 2.0 * math.sqrt(1.0 - (acting / distance) ** 2) * change.distance_change
        assert change.backlash == pytest.approx(sign * yielded, **EXACT)


def test_seats_of_unlike_temperature_misalign():
    """Axes that diverge by a tilt t open the flanks by b t sin(alpha) over the face, towards +z."""
    table = distant(spring_table(4e8), axis="misalignment")
    scene = warm_pair(table=table, seats=(40.0, 80.0))
    tilt = 0.08 * ALUMINUM * 40.0 / (RIGHT - LEFT)
    expected = -0.025 * tilt * math.sin(math.radians(20.0))  # the face position runs against z
    assert warmed_meshes(scene).meshes[0].misalignment == pytest.approx(expected, **EXACT)
    middle = 0.08 * (strain(ALUMINUM, 60.0) - strain(STEEL, 80.0))
    assert warmed_meshes(scene).temperatures.meshes[0].distance_change == pytest.approx(middle, **EXACT)


# Scenes.


def test_without_temperatures_nothing_is_touched():
    scene = warm_pair()
    cold = replace(
        scene,
        temperatures=None,
        shafts=tuple(replace(part, temperature=None) for part in scene.shafts),
        gears=tuple(replace(part, temperature=None) for part in scene.gears),
        rolling_bearings=tuple(
            replace(part, inner_temperature=None, outer_temperature=None) for part in scene.rolling_bearings
        ),
    )
    assert warmed_bearings(cold) is cold
    assert warmed_meshes(cold) is cold


def test_at_the_reference_everything_is_as_drawn():
    scene = warm_pair(shafts=20.0, gears=20.0, rings=(20.0, 20.0), housing=20.0, fits=FITS)
    warm = warmed_meshes(warmed_bearings(scene))
    assert (warm.rolling_bearings, warm.meshes) == (scene.rolling_bearings, scene.meshes)


def test_a_warm_scene_is_warmed_once():
    warm = warmed_meshes(warmed_bearings(warm_pair()))
    assert warmed_meshes(warmed_bearings(warm)) is warm
    assert mechanism_of(warm).scene is warm


def test_off_is_the_scene_as_drawn():
    scene = warm_pair((ANGULAR, mirrored(ANGULAR)), preload=300.0)
    off = assemble(replace(scene, effects=dict.fromkeys(("bearing_temperature", "mesh_temperature"), "off")))
    assert off.scene.rolling_bearings == scene.rolling_bearings
    assert off.scene.meshes == scene.meshes
    system = assemble(scene)
    assert system.resolved(scene).rolling_bearings == scene.rolling_bearings
    assert row_law(system.scene.rolling_bearings[0]).shift != row_law(scene.rolling_bearings[0]).shift


# What cannot be.


TIGHT = replace(DEEP_GROOVE, inner_groove=0.505, outer_groove=0.51)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: warmed_meshes(warm_pair(gears=400.0, housing=20.0)),
            r"meshes\[0\].coast.backlash.*at temperature",
        ),
        (
            lambda: warmed_meshes(warm_pair(table=distant(spring_table(4e8)), housing=400.0)),
            r"meshes\[0\].center_distance_change",
        ),
        (
            lambda: warmed_bearings(warm_pair(rings=(-200.0, 900.0), fits=None, rows=(TIGHT, TIGHT))),
            r"rolling_bearings\[0\].ball.clearance",
        ),
        (lambda: warm_pair(rings=(70.0, None)), r"rolling_bearings\[0\].outer_temperature"),
        (lambda: warm_pair(temperatures=None), r"shafts\[0\].temperature.*left out without"),
        (lambda: Temperatures(Material(70e9, 0.3, 2700.0), 60.0), r"housing_material\.thermal_expansion"),
    ],
    ids=["flanks that bind", "table too short", "tight grooves", "ring", "no housing", "material"],
)
def test_what_cannot_be_warmed_is_refused_by_name(make, words):
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize("kind", ["shafts", "gears"])
def test_a_part_without_a_temperature_is_named(kind):
    scene = warm_pair()
    first, *rest = getattr(scene, kind)
    with pytest.raises(InputError, match=rf"{kind}\[0\].temperature = None: must be given"):
        replace(scene, **{kind: (replace(first, temperature=None), *rest)})


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"bore": 33e-3}, "bore"),
        ({"outside_diameter": 53e-3}, "outside_diameter"),
        ({"housing_diameter": 60e-3}, "housing_diameter"),
    ],
)
def test_rings_hold_their_raceways(changes, field):
    with pytest.raises(InputError, match=field):
        warm_pair(fits=replace(FITS, **changes))


def test_a_mesh_that_is_none_is_left_to_the_mechanism():
    scene = warm_pair()
    near = tuple(replace(part, origin=(0.001 * k, 0.0, 0.0)) for k, part in enumerate(scene.shafts))
    with pytest.raises(InputError, match=r"meshes\[0\].driven"):
        mechanism_of(replace(scene, shafts=near))
