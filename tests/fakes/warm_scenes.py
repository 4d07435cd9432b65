"""A gear pair on two shafts in a housing, every part with a temperature."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene, with_mesh

from dynamics.bearings import BallBearing, RollerBearing, RollingBearing
from dynamics.meshes import CoastFlank
from dynamics.shafts import BeamSection, Inertia
from dynamics.solid_housing import CAST_ALUMINUM
from dynamics.temperatures import Temperatures

ON = {"lateral": "on", "axial": "on", "tilt": "on"}
DEEP_GROOVE = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=2e-5)
TAPERED = RollerBearing(17, 9e-3, 13.6e-3, 65e-3, contact_angle=0.25, laminae=10)
CYLINDRICAL = RollerBearing(14, 9e-3, 13.6e-3, 53.5e-3, clearance=3e-5, laminae=10)
ANGULAR = BallBearing(10, 11.5e-3, 52e-3, contact_angle=0.6)
STEEL, ALUMINUM = 11.5e-6, 21e-6
LEFT, RIGHT = 0.02, 0.18


def distant(table, change=60.0, axis="center_distance_change", knots=(-2e-4, -5e-5, 5e-5, 2e-4)):
    """`table` with one more axis, along which the flanks yield more by `change` per meter."""
    along = np.array(knots)
    more = 1.0 + change * np.reshape(along, (-1, 1, 1, 1) if axis == "misalignment" else (1, -1, 1, 1))
    softer = {name: getattr(table, name) * more for name in ("deflection", "deflection_slope")}
    stiffer = {name: getattr(table, name) / more for name in ("stiffness", "stiffness_slope")}
    return replace(table, **{axis: along}, **softer, **stiffer)


def mirrored(row):
    return replace(row, contact_angle=-row.contact_angle)


def warm_pair(
    rows=(DEEP_GROOVE, DEEP_GROOVE), shafts=70.0, gears=80.0, rings=(70.0, 60.0), housing=50.0, **changes
):
    """The 20/20 pair whose four bearings have these `rows`, left and right; preloads by `preload`."""
    preload, fits = changes.pop("preload", 0.0), changes.pop("fits", None)
    positions, table = changes.pop("positions", (LEFT, RIGHT)), changes.pop("table", None)
    seats, coast = changes.pop("seats", (None, None)), changes.pop("coast", CoastFlank(8e-5))
    scene = with_mesh(gear_pair_scene(table), coast=coast)
    bearings = tuple(
        RollingBearing(
            f"{shaft.name} {side}",
            shaft.name,
            row,
            z,
            float(np.sign(row.contact_angle)) * preload,
            inner_temperature=rings[0],
            outer_temperature=rings[1],
            seat_temperature=seat,
            fits=fits,
        )
        for shaft in scene.shafts
        for side, row, z, seat in zip(("left", "right"), rows, positions, seats, strict=True)
    )
    section = BeamSection(scene.shafts[0].length, 0.04)
    fields = {
        "shafts": tuple(
            replace(part, temperature=shafts, sections=(section,), inertia=Inertia()) for part in scene.shafts
        ),
        "gears": tuple(replace(part, temperature=gears) for part in scene.gears),
        "bushings": (),
        "rolling_bearings": bearings,
        "temperatures": Temperatures(CAST_ALUMINUM, housing),
        "effects": ON | {"flexible_shafts": "off"},
    }
    return replace(scene, **(fields | changes))
