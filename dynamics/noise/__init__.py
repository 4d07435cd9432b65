"""Sound of the housings of a scene by `acoustics`: power by order and speed, shares, bands, recordings."""

from dynamics.housings.reduced_housing import SurfaceHousing
from dynamics.noise.coarse_hull import radiating_hull
from dynamics.noise.estimated_radiation import EstimatedRadiation, estimated_radiation
from dynamics.noise.exact_lines import CorrectedRadiation, ExactLine, corrected_radiation, with_exact_lines
from dynamics.noise.housing_radiation import HousingRadiation, cached_radiation, housing_radiation
from dynamics.noise.housing_recordings import (
    check_microphone,
    pressure_recording,
    pressure_signal,
    pressure_transfer,
    recording_estimate,
    scattered_pressure_transfer,
    scene_pressure,
    sound_limit,
    velocity_recording,
)
from dynamics.noise.microphone_pressure import MicrophonePressure, OrderPressure, microphone_pressure
from dynamics.noise.model_levels import ModelLevels
from dynamics.noise.panel_sound import PanelSound, Region, models_at, panel_sound, regions
from dynamics.noise.radiated_sound import LoudPoint, RadiatedSound, loudest, radiated_sound
from dynamics.noise.scene_sound import HousingRegion, SceneSound, scene_sound
from dynamics.noise.sensitivities import DesignFigure, Sensitivity, sound_sensitivities
from dynamics.noise.sound_band import GUESSES, SoundBand, SoundModel, band_about, forced_power, sound_band
from dynamics.noise.sound_over_time import SoundOverTime, sound_over_time
from dynamics.noise.sounding_housing import Radiation, SoundingHousing
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
    "HousingRegion",
    "LoudPoint",
    "MicrophonePressure",
    "ModelLevels",
    "OrderPressure",
    "PanelSound",
    "PointVelocity",
    "Quantity",
    "QuantityForm",
    "QuantityLevel",
    "RadiatedSound",
    "Radiation",
    "Region",
    "SceneSound",
    "Sensitivity",
    "SoundBand",
    "SoundModel",
    "SoundOverTime",
    "SoundPower",
    "SoundPressure",
    "SoundingHousing",
    "SurfaceHousing",
    "SurfaceVelocity",
    "Together",
    "band_about",
    "cached_radiation",
    "check_microphone",
    "corrected_radiation",
    "estimated_radiation",
    "forced_power",
    "housing_radiation",
    "loudest",
    "microphone_pressure",
    "models_at",
    "panel_sound",
    "pressure_recording",
    "pressure_signal",
    "pressure_transfer",
    "radiated_sound",
    "radiating_hull",
    "recording_estimate",
    "regions",
    "scattered_pressure_transfer",
    "scene_pressure",
    "scene_sound",
    "sound_band",
    "sound_limit",
    "sound_over_time",
    "sound_sensitivities",
    "velocity_recording",
    "with_exact_lines",
]
