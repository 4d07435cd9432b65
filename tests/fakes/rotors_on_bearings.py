"""A rotor on two rolling bearings of every kind."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene, spring_table

from dynamics import Coupling, Inertia, Shaft, TimeLaw
from dynamics.bearings import BallBearing, RollerBearing, RollingBearing

ON = {"lateral": "on", "axial": "on", "tilt": "on"}
DEEP_GROOVE = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=1e-5)
ANGULAR = BallBearing(8, 11.5e-3, 43.5e-3, contact_angle=0.6)
CYLINDRICAL = RollerBearing(14, 9e-3, 13.6e-3, 53.5e-3, clearance=1e-5, laminae=10)
TAPERED = RollerBearing(17, 9e-3, 13.6e-3, 65e-3, contact_angle=-0.25, laminae=10)
KINDS = {"deep groove": DEEP_GROOVE, "angular": ANGULAR, "cylindrical": CYLINDRICAL, "tapered": TAPERED}
KINDS |= {"floating": DEEP_GROOVE, "cross-located": DEEP_GROOVE}
SEATS = {"floating": ("both", "none"), "cross-located": ("negative", "positive")}
PRELOAD = 400.0  # N


def mirrored(row):
    return replace(row, contact_angle=-row.contact_angle)


def rotor(rows, preload=0.0, positions=(0.02, 0.18), gravity=(0.0, 0.0, 0.0), mass=40.0, kind="", **changes):
    """A shaft of 0.2 m on rolling bearings, turned through a torsional coupling by a gear pair's driver."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(10.0), effects=ON)
    shaft = Shaft("rotor", 0.2, (0.0, 0.0, 0.4), Inertia(mass, 0.05, 0.1))
    bearings = tuple(
        RollingBearing(f"seat {i}", "rotor", row, z, np.sign(row.contact_angle) * preload, locating=seat)
        for i, (row, z, seat) in enumerate(
            zip(rows, positions, SEATS.get(kind, ("both", "both")), strict=True)
        )
    )
    fields = {"rolling_bearings": bearings, "gravity": gravity} | changes
    return replace(
        scene,
        shafts=(*scene.shafts, shaft),
        couplings=(Coupling("joint", "input", "rotor", 100.0),),
        **fields,
    )


def pair_of(row):
    """Two rows that hold the shaft against each other."""
    return row, mirrored(row)
