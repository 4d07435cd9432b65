"""Spectra of run results: over frequency, over mesh orders, and their peaks."""

from dynamics.orders.order_tracking import OrderTrack, order_track, resample_to_position
from dynamics.orders.peaks import Peak, find_peaks
from dynamics.orders.spectrum import MeshOrder, Spectrum, mesh_orders, spectrum, window_spectrum

__all__ = [
    "MeshOrder",
    "OrderTrack",
    "Peak",
    "Spectrum",
    "find_peaks",
    "mesh_orders",
    "order_track",
    "resample_to_position",
    "spectrum",
    "window_spectrum",
]
