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
from lineofaction.gearbox.units import RPM

LISTED = 5
"""Orders that are compared."""
FOLLOWED = 3.0
"""An order whose level falls by so many dB more or less than that of its STE has another cause."""


def multiples(order: float, ratios: Mapping[str, float]) -> dict[str, int]:
    """Return of which mesh frequencies an order is which multiple; `ratios` are the orders of these."""
    times = {name: order / ratio for name, ratio in ratios.items()}
    return {name: round(value) for name, value in times.items() if abs(value - round(value)) < 1e-6}


def order_name(order: float, ratios: Mapping[str, float]) -> str:
    """Return an order by the meshes it is a multiple of."""
    whole = [f"{name} x {times}" for name, times in multiples(order, ratios).items()]
    return " = ".join(whole) or f"order {order:.3f}"


def deciding(sound: RadiatedSound, ratios: Mapping[str, float]) -> tuple[str, int]:
    """Return the mesh that makes the loudest order, and its harmonic; of several the lowest."""
    (point,) = loudest(sound, 1)
    return min(multiples(point.order, ratios).items(), key=lambda harmonic: harmonic[1])


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


Pair = tuple[RadiatedSound, RadiatedSound]


def verdict(
    source: tuple[str, int],
    ratios: Mapping[str, float],
    harmonics: tuple[float, float],
    sounds: Pair,
    sounds_of_ste: Pair,
) -> list[str]:
    """Say whether the deciding order follows its harmonic of the STE, and what it follows if not.

    Pairs are before and after: harmonics in um, sounds, sounds without the load's travel along the face.
    """
    (stage, number), before, after = source, *harmonics
    order = number * ratios[stage]
    full, ste = ([order_level(sound, order) for sound in pair] for pair in (sounds, sounds_of_ste))
    change, travel = full[1] - full[0], [whole - part for whole, part in zip(full, ste, strict=True)]
    lines = [
        f"{stage} x {number}: harmonic of the STE {20.0 * np.log10(after / before):+.1f} dB",
        f"sound of the STE alone {ste[1] - ste[0]:+.1f} dB, {ste[0]:.1f} to {ste[1]:.1f} dB(A)",
        f"sound with the load's travel along the face {change:+.1f} dB, {full[0]:.1f} to {full[1]:.1f} dB(A)",
    ]
    apart = change - (ste[1] - ste[0])
    if abs(apart) > FOLLOWED:
        louder, quieter = "less ripple does not quiet this order", "this order is quieter by it"
        lines.append(
            f"the travel adds {travel[0]:.1f} and {travel[1]:.1f} dB: {louder if apart > 0.0 else quieter}"
        )
    return lines


def order_level(sound: RadiatedSound, order: float) -> float:
    """Return the largest A-weighted level of an order over speed, dB."""
    return float(sound.orders.weighted_level[np.argmin(np.abs(sound.order - order))].max())


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
