"""The loudest orders and speeds of a radiated sound, and through what they get there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import sound_power_level
from dynamics.acoustics.levels import a_weighting
from dynamics.noise.radiated_sound import RadiatedSound
from dynamics.types import FloatArray

QUIET = 30.0
"""dB below the loudest beyond which a maximum is not listed."""


@dataclass(frozen=True)
class LoudPoint:
    """An order at a speed at which it is louder than at the speeds beside it.

    Attributes
    ----------
    speed_index, order_index : int
    order, speed, frequency : float
        Multiple of the frequency of the first mesh; rad/s; Hz.
    level, weighted_level : float
        dB and dB(A) re 1e-12 W.
    efficiency : float
        Radiation efficiency.
    mode, natural_frequency : int, float
        Number from 1 on, and frequency in Hz, of the mode of the housing with the largest share.
    mode_share : float
        Of it, of the power.
    mode_housing : str
    bearing : str
        With the largest share.
    bearing_level, level_without_bearing : float
        dB(A): of its force alone, and of what is left without it.
    in_contact : bool
        Whether all flanks stay in contact there; where not, no linear answer holds.
    """

    speed_index: int
    order_index: int
    order: float
    speed: float
    frequency: float
    level: float
    weighted_level: float
    efficiency: float
    mode: int
    natural_frequency: float
    mode_share: float
    mode_housing: str
    bearing: str
    bearing_level: float
    level_without_bearing: float
    in_contact: bool


def loudest(sound: RadiatedSound, count: int = 15) -> tuple[LoudPoint, ...]:
    """Return the maxima over speed of the A-weighted levels of all orders, the loudest first.

    The ends of the speeds count too. Maxima `QUIET` below the loudest are left out; silence has none.
    """
    level = sound.orders.weighted_level.T
    if not np.any(sound.power > 0.0):
        return ()
    beside = np.pad(level, ((1, 1), (0, 0)), constant_values=-np.inf)
    peak = (level > beside[:-2]) & (level >= beside[2:]) & (level >= level.max() - QUIET)
    rows, columns = np.nonzero(peak)
    order = np.argsort(-level[rows, columns], kind="stable")[:count]
    return tuple(_point(sound, int(rows[k]), int(columns[k])) for k in order)


def _point(sound: RadiatedSound, s: int, h: int) -> LoudPoint:
    power, hertz = float(sound.power[s, h]), float(sound.frequency[s, h])
    mode, bearing = int(np.argmax(sound.mode_share[:, s, h])), int(np.argmax(sound.bearing_share[:, s, h]))
    own = mode - sound.mode_housing.index(sound.mode_housing[mode])
    powers = np.array([power, sound.bearing_alone[bearing, s, h], sound.without_bearing[bearing, s, h]])
    weighted: FloatArray = sound_power_level(np.maximum(powers, 0.0)) + a_weighting(hertz)
    return LoudPoint(
        s,
        h,
        float(sound.order[h]),
        float(sound.speed[s]),
        hertz,
        float(sound_power_level(power)),
        float(weighted[0]),
        float(sound.efficiency[s, h]),
        own + 1,
        float(sound.natural_frequency[mode]),
        float(sound.mode_share[mode, s, h]) / power,
        sound.mode_housing[mode],
        sound.bearing[bearing],
        float(weighted[1]),
        float(weighted[2]),
        bool(sound.in_contact[s]),
    )
