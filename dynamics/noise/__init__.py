"""Sound of housings in a scene: outer hull, radiation resistance, sound power by order and speed, shares."""

from dynamics.noise.coarse_hull import RadiatingHull, coarse_hull, radiating_hull
from dynamics.noise.housing_radiation import HousingRadiation, housing_radiation
from dynamics.noise.outer_hull import OuterHull, outer_hull
from dynamics.noise.radiated_sound import RadiatedSound, radiated_sound

__all__ = [
    "HousingRadiation",
    "OuterHull",
    "RadiatedSound",
    "RadiatingHull",
    "coarse_hull",
    "housing_radiation",
    "outer_hull",
    "radiated_sound",
    "radiating_hull",
]
