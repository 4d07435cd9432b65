"""The sound of several housings together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bounds import at_least
from dynamics.errors import InputError
from dynamics.noise.radiated_sound import RadiatedSound
from dynamics.types import FloatArray


def together(sounds: Sequence[RadiatedSound]) -> RadiatedSound:
    """Return the sound of housings under one response: powers add up, interference between them is left out.

    The efficiency is that of all surfaces together.

    Raises
    ------
    InputError
        There is none, or their speeds and orders differ.
    """
    if not sounds:
        raise InputError("sounds", len(sounds), at_least(1))
    first = sounds[0]
    if len(sounds) == 1:
        return first
    for index, sound in enumerate(sounds):
        if not np.array_equal(sound.frequency, first.frequency):
            raise InputError(f"sounds[{index}].frequency", "others", "those of the first")
    plane = sum(sound.power / np.maximum(sound.efficiency, 1e-300) for sound in sounds)
    power = _sum(sounds)
    return RadiatedSound(
        tuple(name for sound in sounds for name in sound.housing),
        tuple(name for sound in sounds for name in sound.bearing),
        tuple(name for sound in sounds for name in sound.mode_housing),
        first.speed,
        first.order,
        first.frequency,
        power,
        np.asarray(power / np.maximum(plane, 1e-300)),
        np.concatenate([sound.bearing_share for sound in sounds]),
        np.concatenate([sound.bearing_alone for sound in sounds]),
        np.concatenate([sound.mode_share for sound in sounds]),
        np.concatenate([sound.mode_alone for sound in sounds]),
        np.concatenate([sound.natural_frequency for sound in sounds]),
        first.in_contact,
        {"radiation": {name: about for sound in sounds for name, about in sound.facts["radiation"].items()}},
    )


def _sum(sounds: Sequence[RadiatedSound]) -> FloatArray:
    """Return the power of all, (S, H), W."""
    return np.asarray(np.sum([sound.power for sound in sounds], axis=0))
