"""Spectra of run results: over frequency, over mesh orders, and their peaks."""

from dynamics.orders.bearing_orders import BearingOrders, bearing_orders
from dynamics.orders.bearing_signals import bearing_signals
from dynamics.orders.order_frequency import leading_shaft, order_frequency
from dynamics.orders.peaks import Peak, find_peaks
from dynamics.orders.position_grid import resample_to_position
from dynamics.orders.sidebands import Sideband, sidebands
from dynamics.orders.spectrum import MeshOrder, Spectrum, mesh_orders, spectrum, window_spectrum
from dynamics.orders.third_octaves import (
    OrderTrack,
    ThirdOctaves,
    Waterfall,
    band_number,
    band_sums,
    frequency_waterfall,
    nominal_center,
    order_track,
    order_waterfall,
    third_octaves,
)
from dynamics.orders.valid_orders import highest_valid_order

__all__ = [
    "BearingOrders",
    "MeshOrder",
    "OrderTrack",
    "Peak",
    "Sideband",
    "Spectrum",
    "ThirdOctaves",
    "Waterfall",
    "band_number",
    "band_sums",
    "bearing_orders",
    "bearing_signals",
    "find_peaks",
    "frequency_waterfall",
    "highest_valid_order",
    "leading_shaft",
    "mesh_orders",
    "nominal_center",
    "order_frequency",
    "order_track",
    "order_waterfall",
    "resample_to_position",
    "sidebands",
    "spectrum",
    "third_octaves",
    "window_spectrum",
]
