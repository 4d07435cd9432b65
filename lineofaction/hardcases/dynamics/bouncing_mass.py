"""A mass thrown to and fro between two springs with a gap between them, in closed form."""

from __future__ import annotations

import math

import numpy as np

from dynamics.types import FloatArray


def bounce(time: FloatArray, gap: float, speed: float, natural: float) -> FloatArray:
    """Return the position of the mass, m from the first spring's end, < 0 towards the second.

    Parameters
    ----------
    time : (T,) array
        s; at 0 it leaves the first spring.
    gap, speed : float
        Gap between the springs in m, and speed of the mass in the gap in m/s.
    natural : float
        Natural frequency of the mass on either spring, rad/s; a contact takes half its period.
    """
    flight, contact = gap / speed, math.pi / natural
    since = np.mod(time, 2.0 * (flight + contact))
    starts = np.array([flight, flight + contact, 2.0 * flight + contact])
    phase = np.searchsorted(starts, since, side="right")
    depth = speed / natural
    elapsed = since - np.r_[0.0, starts][phase]
    return np.choose(
        phase,
        [
            -speed * elapsed,  # flight to the second spring
            -gap - depth * np.sin(natural * elapsed),  # contact with it
            -gap + speed * elapsed,  # flight back
            depth * np.sin(natural * elapsed),  # contact with the first spring
        ],
    )


def cycle(gap: float, speed: float, natural: float) -> float:
    """Return the time from leaving the first spring until leaving it again, s."""
    return 2.0 * (gap / speed + math.pi / natural)
