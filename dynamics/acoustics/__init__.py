"""Sound from the velocity of any surface: radiation models, levels, sound power by order, recordings."""

from dynamics.acoustics.air import Air
from dynamics.acoustics.boundary_elements import BoundaryElements, exterior_pressure, surface_pressure
from dynamics.acoustics.hull import Hull
from dynamics.acoustics.levels import (
    LevelBand,
    Range,
    a_weighting,
    band_cases,
    free_field_pressure,
    level_bands,
    sound_power_level,
)
from dynamics.acoustics.model_comparison import ElementalRadiators, ModelComparison, compare_models
from dynamics.acoustics.order_power import ModalResistance, OrderPower, modal_resistance, order_power
from dynamics.acoustics.outer_hull import OuterHull, outer_hull
from dynamics.acoustics.radiation import (
    EquivalentRadiatedPower,
    PanelModel,
    RadiationModel,
    errors_db,
    mean_square_velocity,
    monopoles_efficiency,
    panel_power,
    radiation_efficiency,
    resistance,
    sound_power,
    sphere_efficiency,
)
from dynamics.acoustics.recording import (
    Recording,
    audible,
    common_full_scale,
    force_recording,
    order_recording,
    principal_direction,
    series_recording,
    wav_file,
    write_wav,
)
from dynamics.acoustics.sound_quality import (
    SoundFigures,
    loudness_over_time,
    sound_figures,
    sound_pressure_level,
    sound_quality,
)

__all__ = [
    "Air",
    "BoundaryElements",
    "ElementalRadiators",
    "EquivalentRadiatedPower",
    "Hull",
    "LevelBand",
    "ModalResistance",
    "ModelComparison",
    "OrderPower",
    "OuterHull",
    "PanelModel",
    "RadiationModel",
    "Range",
    "Recording",
    "SoundFigures",
    "a_weighting",
    "audible",
    "band_cases",
    "common_full_scale",
    "compare_models",
    "errors_db",
    "exterior_pressure",
    "force_recording",
    "free_field_pressure",
    "level_bands",
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
    "resistance",
    "series_recording",
    "sound_figures",
    "sound_power",
    "sound_power_level",
    "sound_pressure_level",
    "sound_quality",
    "sphere_efficiency",
    "surface_pressure",
    "wav_file",
    "write_wav",
]
