"""From surface velocity to sound: radiation models, levels, sound power over a run."""

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import BoundaryElements, SurfacePressure, surface_pressure
from dynamics.acoustics.elemental_radiators import ElementalRadiators
from dynamics.acoustics.equivalent_radiated_power import EquivalentRadiatedPower, panel_power
from dynamics.acoustics.hull import Hull
from dynamics.acoustics.levels import a_weighting, free_field_pressure, level_sum, sound_power_level
from dynamics.acoustics.modal_resistance import ModalResistance, modal_resistance
from dynamics.acoustics.multipoles import errors_db, monopoles_efficiency, sphere_efficiency
from dynamics.acoustics.radiation import (
    RadiationModel,
    mean_square_velocity,
    radiation_efficiency,
    resistance,
    sound_power,
)

__all__ = [
    "Air",
    "BoundaryElements",
    "ElementalRadiators",
    "EquivalentRadiatedPower",
    "Hull",
    "ModalResistance",
    "RadiationModel",
    "SurfacePressure",
    "a_weighting",
    "errors_db",
    "free_field_pressure",
    "level_sum",
    "mean_square_velocity",
    "modal_resistance",
    "monopoles_efficiency",
    "panel_power",
    "radiation_efficiency",
    "resistance",
    "sound_power",
    "sound_power_level",
    "sphere_efficiency",
    "surface_pressure",
]
