"""Spectra of run results: over frequency, over mesh orders, and their peaks."""

from dynamics.orders.bearing_orders import BearingOrders, bearing_orders, bearing_signals
from dynamics.orders.noise_floor import OrderPower, order_power, shared_frequencies
from dynamics.orders.recorded_orders import PositionedSignal, recorded_waterfall
from dynamics.orders.resampling import (
    driving_shaft,
    driving_speed,
    highest_valid_order,
    leading_shaft,
    order_frequency,
    resample_to_position,
)
from dynamics.orders.spectrum import Spectrum, find_peaks, mesh_orders, sidebands, spectrum, window_spectrum
from dynamics.orders.third_octaves import (
    ThirdOctaves,
    Waterfall,
    band_sums,
    frequency_waterfall,
    nominal_center,
    order_track,
    order_waterfall,
    third_octaves,
)

__all__ = [
    "BearingOrders",
    "OrderPower",
    "PositionedSignal",
    "Spectrum",
    "ThirdOctaves",
    "Waterfall",
    "band_sums",
    "bearing_orders",
    "bearing_signals",
    "driving_shaft",
    "driving_speed",
    "find_peaks",
    "frequency_waterfall",
    "highest_valid_order",
    "leading_shaft",
    "mesh_orders",
    "nominal_center",
    "order_frequency",
    "order_power",
    "order_track",
    "order_waterfall",
    "recorded_waterfall",
    "resample_to_position",
    "shared_frequencies",
    "sidebands",
    "spectrum",
    "third_octaves",
    "window_spectrum",
]
