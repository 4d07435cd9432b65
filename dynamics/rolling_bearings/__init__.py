"""Rolling bearings by their internal geometry: balls in grooves, rollers in laminae."""

import host.analysis  # noqa: F401 (says what to install)
from dynamics.bearing_rows import BallBearing, EllipticContact, RollerBearing
from dynamics.bearing_rows.catalog import from_catalog
from dynamics.rolling_bearings.element_passing import ElementPassing, element_passing
from dynamics.rolling_bearings.loaded_bearing import LoadedBearing, Reaction
from dynamics.rolling_bearings.rating_life import RatingLife, rating_life
from dynamics.rolling_bearings.tangent_bushing import tangent_bushing

__all__ = [
    "BallBearing",
    "ElementPassing",
    "EllipticContact",
    "LoadedBearing",
    "RatingLife",
    "Reaction",
    "RollerBearing",
    "element_passing",
    "from_catalog",
    "rating_life",
    "tangent_bushing",
]
