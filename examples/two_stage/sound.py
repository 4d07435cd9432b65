"""Sound of the unit's case before and after, from the results of `loa noise`: levels, causes, WAV files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from dynamics.acoustics import (
    Air,
    Recording,
    common_full_scale,
    free_field_pressure,
    order_recording,
    write_wav,
)
from dynamics.noise import RadiatedSound, loudest
from service.units import RPM

LISTED = 5
"""Orders that are compared."""


def order_name(order: float, ratios: Mapping[str, float]) -> str:
    """Return an order by the meshes it is a multiple of; `ratios` are the orders of their frequencies."""
    multiples = {name: order / ratio for name, ratio in ratios.items()}
    whole = [
        f"{name} x {round(times)}" for name, times in multiples.items() if abs(times - round(times)) < 1e-6
    ]
    return " = ".join(whole) or f"order {order:.3f}"


def levels(before: RadiatedSound, after: RadiatedSound, ratios: Mapping[str, float]) -> list[str]:
    """Return the levels of both at the speed where the first is loudest, by order, and through what."""
    old, new = before.orders, after.orders
    at = int(np.argmax(old.total_weighted_level))
    speed = f"at {before.speed[at] / RPM:.0f} rpm"
    pairs = {
        "loudest of all speeds": (old.total_weighted_level.max(), new.total_weighted_level.max()),
        f"{speed}, all orders": (old.total_weighted_level[at], new.total_weighted_level[at]),
    }
    for order in np.argsort(-old.weighted_level[:, at])[:LISTED]:
        name = f"{order_name(before.order[order], ratios)}, {before.frequency[at, order]:.0f} Hz"
        pairs[name] = old.weighted_level[order, at], new.weighted_level[order, at]
    rows = [f"{name:44}{first:10.1f}{second:10.1f}" for name, (first, second) in pairs.items()]
    head = f"{'sound power, dB(A) re 1e-12 W':44}{'before':>10}{'after':>10}"
    return [head, *rows, *causes("before", before, ratios), *causes("after", after, ratios)]


def causes(name: str, sound: RadiatedSound, ratios: Mapping[str, float]) -> list[str]:
    """Say through which mode and bearing the loudest order radiates."""
    (point,) = loudest(sound, 1)
    order = order_name(point.order, ratios)
    return [
        f"{name}: {order} at {point.speed / RPM:.0f} rpm, {point.frequency:.0f} Hz: "
        f"{point.weighted_level:.1f} dB(A), {point.mode_share:.0%} through the mode at "
        f"{point.natural_frequency:.0f} Hz; {point.bearing} alone {point.bearing_level:.1f} dB(A)"
    ]


def pressure(sound: RadiatedSound, duration: float) -> Recording:
    """Return the sound pressure at 1 m over a run-up of some s, as if radiated evenly to all sides."""
    time = duration * (sound.speed - sound.speed[0]) / (sound.speed[-1] - sound.speed[0])
    amplitude = np.sqrt(2.0) * free_field_pressure(sound.orders.power, 1.0, Air().impedance)
    return order_recording(time, sound.orders.frequency, amplitude, "sound pressure at 1 m", "Pa")


def write_sounds(folder: Path, sounds: Mapping[str, RadiatedSound], duration: float) -> None:
    """Write run-ups as NAME.wav on one scale, so that they play at their true relative level."""
    recordings = {name: pressure(sound, duration) for name, sound in sounds.items()}
    scale = common_full_scale(*recordings.values())
    for name, recording in recordings.items():
        write_wav(folder / f"{name}.wav", recording, scale)
