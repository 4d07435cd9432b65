"""Sound of housings in a scene: outer hull, radiation resistance, sound power by order and speed, shares."""

from dynamics.noise.coarse_hull import RadiatingHull, coarse_hull, radiating_hull
from dynamics.noise.housing_radiation import HousingRadiation, housing_radiation
from dynamics.noise.kept import kept_radiation
from dynamics.noise.loudest import LoudPoint, loudest
from dynamics.noise.model_comparison import models_at, panels_at
from dynamics.noise.outer_hull import OuterHull, outer_hull
from dynamics.noise.point_recording import velocity_recording
from dynamics.noise.radiated_sound import RadiatedSound, radiated_sound
from dynamics.noise.several_housings import together

__all__ = [
    "HousingRadiation",
    "LoudPoint",
    "OuterHull",
    "RadiatedSound",
    "RadiatingHull",
    "coarse_hull",
    "housing_radiation",
    "kept_radiation",
    "loudest",
    "models_at",
    "outer_hull",
    "panels_at",
    "radiated_sound",
    "radiating_hull",
    "together",
    "velocity_recording",
]
