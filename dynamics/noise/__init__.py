"""Sound of the housings of a scene by `acoustics`: power by order and speed, shares, bands, recordings."""

from dynamics.noise.coarse_hull import radiating_hull
from dynamics.noise.estimated_radiation import EstimatedRadiation, estimated_radiation
from dynamics.noise.exact_lines import CorrectedRadiation, ExactLine, corrected_radiation, with_exact_lines
from dynamics.noise.housing_radiation import HousingRadiation, housing_radiation, kept_radiation
from dynamics.noise.housing_recordings import (
    check_microphone,
    heard_estimate,
    pressure_recording,
    pressure_signal,
    pressure_transfer,
    scattered_pressure_transfer,
    sound_limit,
    velocity_recording,
)
from dynamics.noise.panel_sound import PanelSound, Region, models_at, panel_sound, regions
from dynamics.noise.radiated_sound import LoudPoint, RadiatedSound, loudest, radiated_sound
from dynamics.noise.sensitivities import DesignFigure, Sensitivity, sound_sensitivities
from dynamics.noise.sound_band import GUESSES, SoundBand, SoundModel, forced_power, sound_band
from dynamics.noise.sound_over_time import SoundOverTime, sound_over_time
from dynamics.noise.transferred_quantities import (
    BearingForce,
    EquivalentSoundPower,
    PointVelocity,
    Quantity,
    QuantityForm,
    QuantityLevel,
    SoundPower,
    SoundPressure,
    SurfaceVelocity,
    Together,
)

__all__ = [
    "GUESSES",
    "BearingForce",
    "CorrectedRadiation",
    "DesignFigure",
    "EquivalentSoundPower",
    "EstimatedRadiation",
    "ExactLine",
    "HousingRadiation",
    "LoudPoint",
    "PanelSound",
    "PointVelocity",
    "Quantity",
    "QuantityForm",
    "QuantityLevel",
    "RadiatedSound",
    "Region",
    "Sensitivity",
    "SoundBand",
    "SoundModel",
    "SoundOverTime",
    "SoundPower",
    "SoundPressure",
    "SurfaceVelocity",
    "Together",
    "check_microphone",
    "corrected_radiation",
    "estimated_radiation",
    "forced_power",
    "heard_estimate",
    "housing_radiation",
    "kept_radiation",
    "loudest",
    "models_at",
    "panel_sound",
    "pressure_recording",
    "pressure_signal",
    "pressure_transfer",
    "radiated_sound",
    "radiating_hull",
    "regions",
    "scattered_pressure_transfer",
    "sound_band",
    "sound_limit",
    "sound_over_time",
    "sound_sensitivities",
    "velocity_recording",
    "with_exact_lines",
]
