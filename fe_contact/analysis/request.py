"""What `analyze` was asked, checked and in one frozen object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from fe_contact.analysis.spared_effects import spared_effects
from fe_contact.checks import increasing, integer, positive, within
from fe_contact.compliance.rounding import LARGEST_ROUNDING, least_face_width
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, FaceLoadDistribution, FiniteWidth, LedgerEntry, compose
from fe_contact.effects.sparing import WITHOUT
from fe_contact.errors import InputError
from fe_contact.geometry import CLAMPED, ParallelAxes
from fe_contact.mesh import SectorRecipe
from fe_contact.planning import Accuracy, CycleCost, cycle_cost, make_plan, refuse_long_cycle
from fe_contact.types import FloatArray, Json

LARGEST_DEVIATION = 0.01
"""m; larger values of an axis are micrometres given as metres."""
LARGEST_PERIOD = 1_000_000
ON_VIOLATION = ("repeat", "fail", "report")


@dataclass(frozen=True)
class Request:
    """A checked request.

    Attributes
    ----------
    pair : GearPair or InternalGearPair
    load : ndarray
        Normal forces F_bn in N, increasing.
    accuracy : Accuracy
    misalignment, center_distance_change : ndarray
        Table axes, m.
    effects : mapping
        Effect name to "on", "off" or "auto".
    pitches : int, optional
        Base pitches that the table shall cover where teeth differ; None: until all repeats.
    on_violation : str
        What to do where an assumption of the run turns out wrong: "repeat", "fail" or "report".
    spared, turned_on : mapping of str to str
        Automatic effects that are left off because the asked accuracy does not need them, or on because a run
        without them showed that it does, and why.
    """

    pair: ParallelAxes
    load: FloatArray
    accuracy: Accuracy
    misalignment: FloatArray
    center_distance_change: FloatArray
    effects: Mapping[str, str] = field(default_factory=dict)
    pitches: int | None = None
    on_violation: str = "repeat"
    spared: Mapping[str, str] = field(default_factory=dict)
    turned_on: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.on_violation not in ON_VIOLATION:
            raise InputError("on_violation", self.on_violation, f"one of {', '.join(ON_VIOLATION)}")

    @property
    def torque(self) -> FloatArray:
        """Torques on the driving gear in N m."""
        return self.pair.torque(self.load)

    @property
    def alignments(self) -> tuple[int, int]:
        """Numbers of misalignments and of centre distances."""
        return self.misalignment.size, self.center_distance_change.size

    @property
    def whole_scene(self) -> ContactScene:
        """What the effects judge by, before any was spared."""
        alignments = self.misalignment, self.center_distance_change
        return ContactScene(self.pair, self.torque, *alignments, pitches=self.pitches)

    @property
    def scene(self) -> ContactScene:
        """What the effects judge by: what is spared is not in it."""
        scene = self.whole_scene
        for name in self.spared:
            scene = WITHOUT[name](scene)
        return scene

    @property
    def asked_choices(self) -> dict[str, str]:
        """Choice of each effect; an explicit model decides about the face and its finite width."""
        asked = {"3d": "on", "plane_strain": "off", "plane_stress": "off"}.get(self.accuracy.model)
        if asked is not None:
            return dict(self.effects) | {FaceLoadDistribution.name: asked, FiniteWidth.name: "off"}
        if self.effects.get(FaceLoadDistribution.name) == "on":
            return dict(self.effects) | {FiniteWidth.name: "off"}
        return dict(self.effects)

    @property
    def choices(self) -> dict[str, str]:
        """Choice of each effect, those that are spared or turned on included."""
        decided = dict.fromkeys(self.spared, "off") | dict.fromkeys(self.turned_on, "on")
        return self.asked_choices | decided

    def to_json(self) -> Json:
        """Return plain JSON in SI units: what decides the result."""
        return {
            "pair": asdict(self.pair),
            "normal_force": self.load.tolist(),
            "accuracy": asdict(self.accuracy),
            "misalignment": self.misalignment.tolist(),
            "center_distance_change": self.center_distance_change.tolist(),
            "effects": dict(sorted(self.effects.items())),
            "pitches": self.pitches,
            "on_violation": self.on_violation,
        }


@dataclass(frozen=True)
class Checked:
    """A request that can be computed, with the model its effects compose and their ledger.

    `cycle` is what a table over several base pitches costs, None for one pitch.
    """

    request: Request
    model: ContactModel
    ledger: tuple[LedgerEntry, ...]
    cycle: CycleCost | None = None

    @property
    def decided(self) -> dict[str, str]:
        """Every effect "on" or "off", as the whole request decides it."""
        return {entry.name: "on" if entry.on else "off" for entry in self.ledger}

    def judging(self, name: str) -> tuple[ContactScene, dict[str, str]]:
        """Return the scene and the decisions by which the worth of an effect is estimated.

        Those of a spared effect are of the scene with everything in it: without it there may be no model
        left that can show it.
        """
        request = self.request
        if name not in request.spared:
            return request.scene, self.decided
        _, ledger = compose(request.whole_scene, request.asked_choices, EFFECTS)
        return request.whole_scene, {entry.name: "on" if entry.on else "off" for entry in ledger}


def check_request(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    pitches: int | None = None,
    misalignments: Sequence[float] | FloatArray = (0.0,),
    center_distance_changes: Sequence[float] | FloatArray = (0.0,),
    effects: Mapping[str, str] | None = None,
    whole_table: bool = True,
    receipt: str = "full",
    on_violation: str = "repeat",
    spare: bool = True,
) -> Checked:
    """Check everything that `analyze` is given, without computing anything.

    Parameters are its; `whole_table` = False leaves out the limit on the size of a table, `spare` = False the
    decision about effects that a tolerance does not need, which takes some milliseconds of solving.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    """
    request = Request(
        pair,
        load_levels(pair, torques, normal_forces),
        Accuracy(tolerance, time_budget, level, model, positions, receipt),
        axis("misalignments", misalignments),
        axis("center_distance_changes", center_distance_changes),
        dict(effects or {}),
        None if pitches is None else integer("pitches", pitches, 1, LARGEST_PERIOD),
        on_violation,
    )
    return check_asked(request, whole_table=whole_table, spare=spare)


def check_one_load(
    pair: ParallelAxes,
    torque: float | None,
    normal_force: float | None,
    misalignment: float,
    center_distance_change: float,
    *,
    tolerance: float | None,
    level: str | None,
    time_budget: float | None,
    model: str,
    effects: Mapping[str, str] | None,
    on_violation: str = "repeat",
) -> Checked:
    """Check what is asked of one load (N m or N, exactly one) and alignment (m), as `check_request` does."""
    return check_request(
        pair,
        torques=None if torque is None else [torque],
        normal_forces=None if normal_force is None else [normal_force],
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        misalignments=[misalignment],
        center_distance_changes=[center_distance_change],
        effects=effects,
        on_violation=on_violation,
        whole_table=False,
        spare=False,  # what does not show in the transmission error may show in pressures and stresses
    )


def check_asked(request: Request, *, whole_table: bool = True, spare: bool = True) -> Checked:
    """Compose the model of a request and refuse what it cannot hold; parameters of `check_request`.

    With a tolerance, automatic effects that it does not need are then spared.
    """
    composed, ledger = _composed(request)
    _refuse_plane(request, composed)
    if spare and not (request.spared or request.turned_on):
        request = replace(request, spared=spared_effects(request.scene, ledger, request.accuracy.tolerance))
        composed, ledger = _composed(request) if request.spared else (composed, ledger)
    if composed.across_face:
        refuse_thin_discs(request.pair, request.accuracy.level)
    _refuse_distances(request)
    _refuse_idle_pitches(request)
    cycle = _cycle_cost(request, composed) if whole_table and composed.period > 1 else None
    return Checked(request, composed, ledger, cycle)


def _refuse_plane(request: Request, composed: ContactModel) -> None:
    """Refuse what acts across the face where a plane is asked for."""
    if composed.across_face:
        return
    refuse_beyond_plane(request.scene)
    if composed.thin_rim:
        refuse_web_off_center(request.scene)
    if composed.bore_seat:
        refuse_seats(request.scene)


def _composed(request: Request) -> tuple[ContactModel, tuple[LedgerEntry, ...]]:
    """Compose the model; the ledger says what was asked for, and of what is spared what the scene held."""
    composed, ledger = compose(request.scene, request.choices, EFFECTS)
    asked, overrides = request.asked_choices, {**request.spared, **request.turned_on}
    whole = {effect.name: effect.called_for(request.whole_scene) for effect in EFFECTS}
    return composed, tuple(
        replace(
            entry,
            choice=asked.get(entry.name, "auto"),
            verdict=whole[entry.name] if entry.name in request.spared else entry.verdict,
            override=overrides.get(entry.name, ""),
        )
        for entry in ledger
    )


def _refuse_idle_pitches(request: Request) -> None:
    """Refuse a number of pitches where all of them are alike."""
    gears = (request.pair.pinion, request.pair.wheel)
    if request.pitches is not None and all(gear.pitch_deviation.neutral for gear in gears):
        bound = "left out where all teeth are alike"
        raise InputError("pitches", request.pitches, bound, "Give a gear its pitch deviations.")


def _cycle_cost(request: Request, model: ContactModel) -> CycleCost:
    """Predict the cost of the whole table; refuse one that is too long to be made."""
    plan = make_plan(request.pair, request.load, request.accuracy, model)
    alignments = request.misalignment.size * request.center_distance_change.size
    cost = cycle_cost(request.pair, plan, model.period, alignments)
    refuse_long_cycle(cost)
    return cost


def _refuse_distances(request: Request) -> None:
    """Refuse a change of the centre distance at which the gears do not mesh, by its place in the list."""
    for i, change in enumerate(request.center_distance_change):
        try:
            request.pair.at_center_distance(request.pair.center_distance + float(change))
        except InputError as error:
            bound = f"a change at which the gears mesh: {error.field} {error.bound}"
            field_name = f"center_distance_changes[{i}]"
            raise InputError(field_name, float(change), bound, error.suggestion) from None


def load_levels(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray | None,
    forces: Sequence[float] | FloatArray | None,
) -> FloatArray:
    """Return the load levels as normal forces.

    Raises
    ------
    InputError
        Both or neither given, or not increasing and above zero.
    """
    if (torques is None) == (forces is None):
        raise InputError(
            "torques", torques, "given, or normal_forces instead", "Give exactly one of the two."
        )
    name, given = ("torques", torques) if torques is not None else ("normal_forces", forces)
    levels = increasing(name, given if given is not None else ())
    positive(
        f"{name}[0]", float(levels[0]), "Loads start above zero; the no-load curve is always in the table."
    )
    return pair.normal_force(levels) if torques is not None else levels


def axis(name: str, values: Sequence[float] | FloatArray) -> FloatArray:
    """Return a table axis in m, increasing.

    Raises
    ------
    InputError
        Not increasing, not finite, or larger than 1 cm: micrometres given as metres.
    """
    levels = increasing(name, values)
    for i, value in enumerate(levels):
        within(f"{name}[{i}]", float(value), -LARGEST_DEVIATION, LARGEST_DEVIATION, "In m: 30 um is 3e-5.")
    return levels


def refuse_beyond_plane(scene: ContactScene) -> None:
    """Refuse what a plane model cannot hold, naming the field."""
    pair, advice = scene.pair, "Use the 3-D model for it."
    if pair.pinion.helix_angle != 0.0:
        raise InputError("pinion.helix_angle", pair.pinion.helix_angle, "0 for a plane model", advice)
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if gear.modification.varies_along_face:
            bound = "constant along the face for a plane model"
            raise InputError(f"{name}.modification", gear.modification, bound, advice)
        if pair.shafts[name == "wheel"] is not None:
            raise InputError(f"{name}.shaft", "given", "left out for a plane model", advice)
    if np.any(scene.misalignment != 0.0):
        raise InputError("misalignments", scene.misalignment.tolist(), "[0.0] for a plane model", advice)


def refuse_thin_discs(pair: ParallelAxes, level: str | None) -> None:
    """Refuse discs so thin that rounding would show; where no mesh is asked for, the finest counts."""
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        least = least_face_width(gear, getattr(SectorRecipe, level or "fine")(gear).layers)
        if gear.face_width < least:
            bends = "bends as a plate under the axial force of its helix" if gear.helix_angle else "gives way"
            bound = (
                f"at least {least:.6g} m: a thinner disc {bends}, and rounding of its stiffness changes that "
                f"by more than {LARGEST_ROUNDING:g}"
            )
            advice = "Widen the face or the bore" + (", or take a spur gear." if gear.helix_angle else ".")
            raise InputError(f"{name}.face_width", gear.face_width, bound, advice)


def refuse_web_off_center(scene: ContactScene) -> None:
    """Refuse a web that tilts its gear: the plane has no tilt."""
    for name, gear in (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel)):
        if gear.web is not None and gear.web.low + gear.web.high != 0.0:
            offset, advice = 0.5 * (gear.web.low + gear.web.high), "Use the 3-D model for it."
            raise InputError(f"{name}.blank.web_offset", offset, "0 for a plane model", advice)


def refuse_seats(scene: ContactScene) -> None:
    """Refuse seats of bores: in the plane every bore is fixed."""
    for name, gear in (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel)):
        if gear.seat != CLAMPED:
            advice = "Use the 3-D model for it."
            raise InputError(f"{name}.seat", "given", "left out for a plane model", advice)
