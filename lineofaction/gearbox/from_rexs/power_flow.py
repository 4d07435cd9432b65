"""The flow of power through a gear unit at an operating point: speeds, torques, and which gear drives.

Components, external loads, shafts and rotors are named by the integer ids of the file. A rotor is a set of
shafts that turn as one. A train is all stages and couplings; it has an open end where a rotor of a single
stage has no external load. Speeds and torques are about z.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_train import Flow, Train
from lineofaction.gearbox.from_rexs.gear_unit import GearStage
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.operating_points import OperatingPoint

DEFAULT_SPEED = 1000.0 * math.pi / 30.0
"""Speed of the first loaded shaft if the file states no speed, rad/s."""

# remarks of the account of an import
NO_SPEED = "no speed is stated: the first loaded shaft turns at 1000/min"
UNBALANCED = "the torques stated do not balance: the first is taken, the others follow from it"
REPLACED = "it does not balance the first torque stated, from which the scene's follows"
SHARED = "statics leaves open how parallel stages share the load: equally among equal planets (least squares)"


@dataclass(frozen=True)
class PowerFlow:
    """Speeds and torques about z at an operating point."""

    point: OperatingPoint
    layout: Layout
    train: Train
    speeds: FloatArray
    """Speeds of the rotors, rad/s. Shape (rotors,)."""
    loads: Mapping[int, float]
    """Torque from outside, N m, by the id of the external load. At an open end of the train without external
    load it is by the id of a shaft.
    """
    flow: Flow
    """Torques of the stages on the rotors."""
    remarks: tuple[str, ...]
    """Sentences about assumed values."""
    joined: frozenset[int]
    """Rotors that stages and couplings join to a rotor of known speed."""
    replaced: tuple[int, ...] = ()
    """Loads whose stated torques do not balance the first load. The torques used for them follow from the
    balance."""

    def moves(self, stage: GearStage) -> bool:
        """Return whether all rotors of a stage are joined to a rotor of known speed."""
        return all(self.layout.rotor(shaft.id) in self.joined for shaft in stage.shafts)

    def speed(self, rotor: int) -> float:
        """Return the speed of a rotor, rad/s."""
        return float(self.speeds[self.train.rotors.index(rotor)])

    def relative_speed(self, stage: GearStage, gear: int) -> float:
        """Return the speed of gear 1 (0) or 2 (1) of a stage in the frame of its carrier, rad/s."""
        carrier = self.layout.carrier(stage)
        frame = 0.0 if carrier is None else self.speed(carrier)
        return self.speed(self.layout.rotor(stage.shafts[gear].id)) - frame

    def on_gear(self, stage: GearStage, gear: int) -> float:
        """Return the torque about z of the stage on its gear 1 (0) or 2 (1), N m."""
        row = self.train.stages.index(stage)
        column = self.train.rotors.index(self.layout.rotor(stage.shafts[0].id))
        # the rotor may also be the carrier of the stage: the part of the torque by the teeth alone
        share = stage.teeth[0] / float(self.train.rows[row, column])
        first = share * float(self.flow.on_rotor[row, column])
        ratio = stage.teeth[1] / stage.teeth[0] * (-1.0 if stage.internal else 1.0)
        return first if gear == 0 else ratio * first

    def driver(self, stage: GearStage) -> int:
        """Return which gear drives: 0 for gear 1, 1 for gear 2.

        The stage does negative work on the driving gear, seen from the carrier. Without load or speed it is
        gear 1.
        """
        return 1 if self.on_gear(stage, 0) * self.relative_speed(stage, 0) > 0.0 else 0

    @staticmethod
    def of(point: OperatingPoint, layout: Layout, train: Train) -> PowerFlow | str:
        """Return the flow of power at an operating point, or the reason why there is none."""
        problem = _Problem(point, layout, train)
        if not problem.known_speeds and not problem.owner:
            return "neither a speed nor a torque is stated"
        speeds = train.speeds(problem.known_speeds or problem.default_speed)
        if speeds is None:
            speeds_text = f"the speeds stated (of shafts {', '.join(map(str, point.speeds)) or 'none'})"
            return f"{speeds_text} contradict the ratios of the stages, or leave some open"
        known = problem.known(speeds)
        for loads, remark in problem.attempts(known):
            open_loads = [load for load in problem.owner if load not in loads]
            flow = problem.balanced(loads, open_loads)
            if flow is not None:
                torques = loads | {load: flow.outside[problem.rotor(load)] for load in open_loads}
                torques |= problem.at_open_ends(flow, open_loads)
                shared = [SHARED] if flow.is_shared else []
                remarks = (*problem.remarks, *([remark] if remark else ()), *shared)
                replaced = tuple(load for load in known if load not in loads)
                joined = frozenset(problem.joined)
                return PowerFlow(point, layout, train, speeds, torques, flow, remarks, joined, replaced)
        return "the torques stated do not balance, or leave some open"


class _Problem:
    """Speeds and torques that the file states for an operating point, by rotor.

    `owner` has the shaft of each external load, without loads on rotors that nothing joins to a known speed.
    """

    def __init__(self, point: OperatingPoint, layout: Layout, train: Train) -> None:
        self._point, self._layout, self._train = point, layout, train
        owners = {load: layout.unit.part(load).shaft for load in point.torques}
        self.owner = {load: owner.id for load, owner in owners.items() if owner is not None}
        self.known_speeds = {
            layout.rotor(shaft): speed * layout.sense(shaft) for shaft, speed in point.speeds.items()
        }
        self.remarks = () if self.known_speeds else (NO_SPEED,)
        self.joined = train.joined_to(self.known_speeds or (self.default_speed if self.owner else ()))
        self.owner = {load: shaft for load, shaft in self.owner.items() if layout.rotor(shaft) in self.joined}

    @property
    def default_speed(self) -> dict[int, float]:
        """The speed of the first loaded shaft, in the sense of its torque."""
        load, shaft = next(iter(self.owner.items()))
        sense = math.copysign(1.0, self._point.torques[load] or 1.0) * self._layout.sense(shaft)
        return {self._layout.rotor(shaft): sense * DEFAULT_SPEED}

    def rotor(self, load: int) -> int:
        """Return the rotor that a load acts on."""
        return self._layout.rotor(self.owner[load])

    def known(self, speeds: FloatArray) -> dict[int, float]:
        """Return the torques that are stated, or follow from a stated power, N m about z."""
        known = {}
        for load, shaft in self.owner.items():
            torque, power = self._point.torques[load], self._point.powers.get(load)
            speed = float(speeds[self._train.rotors.index(self.rotor(load))])
            if torque is not None:
                known[load] = torque * self._layout.sense(shaft)
            elif power is not None and speed != 0.0:
                known[load] = power / speed
        return known

    def attempts(self, known: dict[int, float]) -> Iterator[tuple[dict[int, float], str]]:
        """Yield the known torques to balance, with a remark: all of them, then the first alone."""
        yield known, ""
        if len(known) > 1:
            first = next(iter(known))
            yield {first: known[first]}, UNBALANCED

    def balanced(self, loads: Mapping[int, float], open_loads: list[int]) -> Flow | None:
        """Return the torques of stages and open loads that balance the known `loads`; None: there are none.

        If no load is open and the known ones do not balance, the one open end of the train has a torque.
        """
        torques: dict[int, float] = {}
        for load, torque in loads.items():
            torques[self.rotor(load)] = torques.get(self.rotor(load), 0.0) + torque
        rotors = list(dict.fromkeys(map(self.rotor, open_loads)))
        if len(rotors) < len(open_loads):  # two open loads of one rotor: statics does not tell them apart
            return None
        flow = self._train.forces(torques, rotors)
        if flow is None and not open_loads and any(torques.values()):
            ends = self._open_ends(set(torques))
            return self._train.forces(torques, ends) if len(ends) == 1 else None
        return flow

    def at_open_ends(self, flow: Flow, open_loads: list[int]) -> dict[int, float]:
        """Return the torques of a balance on rotors without an open load, by external load or shaft."""
        loaded = set(map(self.rotor, open_loads))
        return {
            self._load_or_shaft(rotor): torque
            for rotor, torque in flow.outside.items()
            if rotor not in loaded
        }

    def _load_or_shaft(self, rotor: int) -> int:
        """Return the external load of a rotor that the operating point does not name, else its shaft."""
        unit = self._layout.unit
        for load in unit.of_type("external_load"):
            owner = load.shaft
            if owner is not None and self._layout.rotor(owner.id) == rotor and load.id not in self.owner:
                return load.id
        return next(part.id for part in unit.of_type("shaft") if self._layout.rotor(part.id) == rotor)

    def _open_ends(self, loaded: set[int]) -> list[int]:
        """Return the rotors of one stage or coupling that are neither `loaded` nor at rest."""
        counts = np.count_nonzero(self._train.rows, axis=0)
        bound = loaded | {self._train.rotors[column] for column in self._train.grounded}
        return [
            r for r, count in zip(self._train.rotors, counts, strict=True) if count == 1 and r not in bound
        ]
