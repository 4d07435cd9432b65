"""Force waves of an electric machine: pressures by temporal and spatial order, resultants."""

from dynamics.force_waves.resultants import AirGap, Resultants, resultants
from dynamics.force_waves.table import ForceWaveTable
from dynamics.force_waves.waves import ForceWaves

__all__ = ["AirGap", "ForceWaveTable", "ForceWaves", "Resultants", "resultants"]
