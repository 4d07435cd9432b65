"""The steel of shafts whose material is not stated: that of the gears' tables."""

STEEL_YOUNGS_MODULUS = 210e9
"""Pa."""
STEEL_POISSON_RATIO = 0.3
STEEL_DENSITY = 7850.0
"""kg/m^3."""
