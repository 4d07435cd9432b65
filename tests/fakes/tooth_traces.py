"""Traces of measuring machines on single teeth, and an oracle of the gap by nothing but many samples."""

import math

import numpy as np

from fe_contact.contact.model import MeetingTeeth
from fe_contact.contact.plain_touch import conjugate_touch
from fe_contact.geometry import FlankGrid, Gear, GearPair, InternalGearPair, RingGear, ToothFlank

KINDS = ("spur", "helical", "internal")
SHAPES = ("white", "filtered", "edge break", "step")
TEETH = 23, 67
_WINDOW = 0.8e-3
"""Way along the flank that the oracle looks at to either side, m: no trace reaches further."""


def trace(shape: str, gear, rng: np.random.Generator) -> FlankGrid:
    """Return a profile of some 10 um that is the same all over the face."""
    roll = np.linspace(*sorted((gear.form_roll_length, gear.tip_roll_length)), int(rng.integers(8, 61)))
    noise = rng.normal(0.0, 1.0, roll.size + 8)
    if shape == "white":
        removed = 3.3e-6 * noise[8:]
    elif shape == "filtered":
        removed = np.convolve(noise, np.ones(9) / 9.0, "valid")
        removed = 10e-6 * removed / np.ptp(removed)
    elif shape == "edge break":
        removed = 0.5e-6 * noise[8:]
        removed[-1 if gear.sign > 0 else 0] += rng.uniform(5e-6, 15e-6)
    else:
        removed = np.where(roll > rng.uniform(roll[0], roll[-1]), rng.uniform(-8e-6, 8e-6), 0.0)
    return on_profile(gear, roll, removed)


def on_profile(gear, roll, removed) -> FlankGrid:
    """Return a surface of this profile, m."""
    half = 0.5 * gear.face_width
    return FlankGrid(tuple(roll), (-half, half), tuple((float(value),) * 2 for value in removed))


def pair_with(kind: str, index: int, **changes):
    """Return gears of 23 and 67 teeth, one of them changed."""
    hand = math.radians(22.0) if kind == "helical" else 0.0
    sizes = {"normal_module": 2e-3, "face_width": 30e-3}
    own = [changes if index == gear else {} for gear in (0, 1)]
    pinion = Gear(TEETH[0], helix_angle=hand, bore_diameter=20e-3, **sizes, **own[0])
    if kind == "internal":
        ring = RingGear(TEETH[1], rim_diameter=150e-3, tip_diameter=131e-3, **sizes, **own[1])
        return InternalGearPair(pinion, ring)
    return GearPair(pinion, Gear(TEETH[1], helix_angle=-hand, bore_diameter=20e-3, **sizes, **own[1]))


def traced_pair(kind: str, index: int, shape: str, rng: np.random.Generator):
    """Return such gears with a trace on the second tooth of one of them."""
    plain = pair_with(kind, index)
    surface = trace(shape, (plain.pinion, plain.wheel)[index], rng)
    return pair_with(kind, index, tooth_flanks=(ToothFlank(2, flank_grid=surface),))


def sampled_gap(pair, model, candidates, meeting, samples: int):
    """Return the least of many samples of the true rigid gap of the candidates that exist, m."""
    touch = candidates.touch
    at = np.nonzero(np.isfinite(touch.gap))
    roll_1, face, teeth = (
        touch.roll_1[at],
        np.broadcast_to(candidates.face_position, touch.gap.shape)[at],
        meeting[at],
    )
    plain = conjugate_touch(pair, touch.roll_1, pair.mating_roll_length(touch.roll_1), model.corner_contact)
    s_1, s_2, slope, curvature = (getattr(plain, name)[at] for name in ("s_1", "s_2", "slope", "curvature"))
    inwards = np.minimum(s_1, np.where(s_2 < 0.0, -s_2, np.inf))
    first = np.maximum(np.maximum(plain.low[at], -0.5 * inwards), -_WINDOW)
    last = np.minimum(np.minimum(plain.high[at], np.where(s_2 < 0.0, np.inf, 0.5 * s_2)), _WINDOW)
    steady = sum(
        term(pair, roll_1, pair.mating_roll_length(roll_1), face)
        for term in model.gaps
        if not term.along_profile
    )
    minimum = np.full(roll_1.size, np.inf)
    for part in np.linspace(0.0, 1.0, samples):
        x = first + part * (last - first)
        rolls = (
            np.sqrt(2.0 * pair.pinion.base_radius * np.maximum(s_1 + x, 0.0)),
            np.sqrt(2.0 * pair.wheel.base_radius * np.maximum(pair.wheel.sign * (s_2 - x), 0.0)),
        )
        gap = x * (slope + 0.5 * curvature * x)
        gap = gap + sum(term(pair, *rolls, face) for term in model.gaps if term.along_profile)
        gap = gap + model.gap_of_teeth(MeetingTeeth(pair, teeth, *rolls, face))
        minimum = np.minimum(minimum, gap)
    return at, plain.gap[at] + steady + minimum
