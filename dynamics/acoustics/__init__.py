"""From surface velocity to sound: radiation models, levels, sound power over a run, recordings."""

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import BoundaryElements, SurfacePressure, surface_pressure
from dynamics.acoustics.equivalent_radiated_power import (
    EquivalentRadiatedPower,
    errors_db,
    monopoles_efficiency,
    sphere_efficiency,
)
from dynamics.acoustics.exterior_pressure import exterior_pressure
from dynamics.acoustics.hull import Hull
from dynamics.acoustics.level_band import LevelBand, Range, level_band, level_bands
from dynamics.acoustics.levels import a_weighting, free_field_pressure, level_sum, sound_power_level
from dynamics.acoustics.model_ladder import ElementalRadiators, ModelLadder, ModelResult, compare_models
from dynamics.acoustics.order_power import ModalResistance, OrderPower, modal_resistance, order_power
from dynamics.acoustics.outer_hull import OuterHull, outer_hull
from dynamics.acoustics.radiation import (
    PanelModel,
    RadiationModel,
    mean_square_velocity,
    panel_power,
    radiation_efficiency,
    resistance,
    sound_power,
)
from dynamics.acoustics.recording import Recording, order_recording
from dynamics.acoustics.run_recording import (
    audible,
    force_recording,
    principal_direction,
    series_recording,
)
from dynamics.acoustics.sound_pressure_level import sound_pressure_level
from dynamics.acoustics.sound_quality import SoundQuality, loudness_over_time, sound_quality
from dynamics.acoustics.wav import common_full_scale, read_wav, wav_file, write_wav

__all__ = [
    "Air",
    "BoundaryElements",
    "ElementalRadiators",
    "EquivalentRadiatedPower",
    "Hull",
    "LevelBand",
    "ModalResistance",
    "ModelLadder",
    "ModelResult",
    "OrderPower",
    "OuterHull",
    "PanelModel",
    "RadiationModel",
    "Range",
    "Recording",
    "SoundQuality",
    "SurfacePressure",
    "a_weighting",
    "audible",
    "common_full_scale",
    "compare_models",
    "errors_db",
    "exterior_pressure",
    "force_recording",
    "free_field_pressure",
    "level_band",
    "level_bands",
    "level_sum",
    "loudness_over_time",
    "mean_square_velocity",
    "modal_resistance",
    "monopoles_efficiency",
    "order_power",
    "order_recording",
    "outer_hull",
    "panel_power",
    "principal_direction",
    "radiation_efficiency",
    "read_wav",
    "resistance",
    "series_recording",
    "sound_power",
    "sound_power_level",
    "sound_pressure_level",
    "sound_quality",
    "sphere_efficiency",
    "surface_pressure",
    "wav_file",
    "write_wav",
]
