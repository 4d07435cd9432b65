"""Modes of housings with mass: the bearing seats move as inertia and resonance of the housing let them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.joints import Housing
from dynamics.mechanism.additions import HOUSING_AMPLITUDES
from dynamics.mechanism.bodies import modal_housing
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.sampling import top_load_frequency, top_mesh_frequency, top_passing_frequency

SHARE = 0.01
"""Least motion of a seat by the housing's inertia, over its static motion, at which a scene calls for the
effect.
"""


class HousingModes(RotorEffect):
    """The amplitudes of all modes of a housing, as freedoms in addition to those of the shafts in it."""

    name = "housing_modes"
    in_statics = False
    compulsory = True
    adds = (HOUSING_AMPLITUDES,)
    cost = "a freedom per row of the housing's matrices, a force element per bearing in it, implicit steps"

    def verdicts(self, rotors: Sequence[LoadedRotor]) -> Sequence[Verdict]:
        """Call for the effect where mesh orders, loads or passing elements come near a housing's first mode.

        All shafts in a housing have its verdict. A shaft in two housings has the effect if one of them calls
        for it. The effect changes no static motion.
        """
        unhoused = Verdict(False, False, "no bearing of it sits in a housing with mass", 0.0)
        return [
            max(
                (_verdict(rotor, housing) for housing in _housings_of(rotor.mechanism, rotor.index)),
                key=lambda verdict: verdict.on,
                default=unhoused,
            )
            for rotor in rotors
        ]

    def extend(self, mechanism: Mechanism, decision: Sequence[Verdict | None]) -> Mechanism:
        """Return the mechanism with the amplitudes of those housings whose shafts the effect is on for."""
        on = {
            housing.name
            for index, verdict in enumerate(decision)
            if verdict is not None
            for housing in _housings_of(mechanism, index)
        }
        moving = tuple(modal_housing(part) for part in mechanism.scene.housings if part.name in on)
        return replace(mechanism, rotors=replace(mechanism.rotors, housings=moving)) if moving else mechanism


def _housings_of(mechanism: Mechanism, index: int) -> list[Housing]:
    names = {part.name for part in mechanism.rotors[index].supports}
    massive = (part for part in mechanism.scene.housings if part.mass is not None)
    return [part for part in massive if not names.isdisjoint(part.bushings)]


def _verdict(rotor: LoadedRotor, housing: Housing) -> Verdict:
    """Assess a housing under one of its shafts.

    At the frequency f the inertia of a housing whose first mode has f_1 adds up to (f/f_1)^2 of its static
    motion to that of a seat.
    """
    scene, kinematics = rotor.mechanism.scene, rotor.mechanism.kinematics
    modal = modal_housing(housing)
    content = {
        "mesh orders": scene.outputs.mesh_orders * top_mesh_frequency(scene, kinematics),
        "loads": top_load_frequency(scene, kinematics),
        "passing elements": top_passing_frequency(scene, kinematics),
    }
    source, first = max(content, key=lambda name: content[name]), float(modal.frequency[0])
    share = (content[source] / first) ** 2
    supports = [part.name for part in rotor.rotor.supports]
    seats = np.array([modal.seat(name)[:2] for name in supports if name in modal.bearings])
    softest = float(np.max(np.sum(seats**2 / modal.stiffness, axis=2)))
    influence = min(share, 1.0) * (rotor.resultant / len(supports) * softest)  # an equal share of mesh forces
    highest, lowest = engineering(content[source], 4), engineering(first, 4)
    reason = f"{source} reach {highest} Hz, the first mode of {housing.name} {lowest} Hz"
    if any(at.name in housing.bushings for at in rotor.mechanism.bearings):
        return Verdict(True, False, f"{reason}; it carries bearings that are not linear", influence)
    return Verdict(share > SHARE, True, reason, influence)
