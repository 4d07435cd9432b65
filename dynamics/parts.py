"""Kinds of parts of a scene, by the names of their fields of `Scene` and of their tables in a scene file."""

KINDS = (
    "shafts",
    "gears",
    "discs",
    "bushings",
    "rolling_bearings",
    "planet_bearings",
    "couplings",
    "meshes",
    "drives",
    "free_rotations",
    "loads",
    "speed_torques",
    "forces",
    "unbalances",
    "housings",
)
"""Kinds whose parts have a name."""

ON_A_SHAFT = tuple(kind for kind in KINDS if kind not in ("shafts", "couplings", "meshes", "housings"))
"""Kinds whose parts name the shaft that they are on."""

LAWS_OF_BEARINGS = ("rolling_contacts", "spring_curves")
"""Kinds whose parts are laws of bearings and name the bearing at which they act."""
