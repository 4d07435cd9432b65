"""Check that effects neglected for a tolerance were too small to be seen in the run without them.

An influence is the change of a run's figures by leaving one effect out in all parts of the scene, estimated
by linear theory. A tolerance of the scene decides which effects may be left out; the run then compares the
estimates with its own series.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System, assemble
from dynamics.effects import EFFECTS
from dynamics.errors import InputError, SolveError
from dynamics.influence.content_key import content_key
from dynamics.influence.level_change import (
    ROUNDING,
    BearingForces,
    LevelChange,
    in_decibels,
    in_relative,
    level_change,
)
from dynamics.influence.linear_figures import COMPARED, LinearFigures, linear_figures
from dynamics.influence.operating_conditions import (
    FEWER,
    SPEEDS,
    OperatingCondition,
    conditions_at,
    operating_conditions,
)
from dynamics.kernels.by_address import by_value
from dynamics.linearize.operating_speeds import leading_law
from dynamics.linearize.steady_vibration import excited
from dynamics.linearize.transfer import possible_lines
from dynamics.motion.sampled_states import States
from dynamics.results.checks import Check, SeriesBlock
from dynamics.scene import Scene
from dynamics.types import FloatArray, Json
from model_studies import in_unit
from model_studies.stage_clock import TimeTaken

_Key = tuple[bytes | None, float, bool]
_KNOWN: dict[_Key, dict[str, Influence]] = {}
"""Influences by content of the scene, for the last `KNOWN` scenes: a scene is often run again with other
steps or outputs.
"""
KNOWN = 64  # most scenes whose influences stay in memory
_SOLVED, _VARYING, _BEGUN = 4.5e-8, 2e-3, 0.01
"""CPU seconds of one line at one speed over the square of the freedoms, of varying stiffness at one speed,
and of one effect without its lines.

5 to 170 freedoms, 2 to 30 lines: within a factor of 2.
"""
SCREENED = 3
"""Least number of meshes at which effects are first estimated with the mean stiffness: for six meshes the
varying stiffness takes ten times as long.
"""
UNSEEN = 0.01
"""Change of level, dB, up to which the estimate with the mean stiffness is the influence of an effect."""
LINEAR = frozenset(effect.name for effect in EFFECTS if effect.linear)
"""Effects whose size linear theory estimates."""
SHARE = 0.1
"""Share of a relative tolerance that all neglected effects together may take. Estimates may be wrong by a
factor of two and more, and neglected effects must stay invisible.
"""
LEVEL_SHARE = 0.5
"""Share of a tolerance of levels that all neglected effects together may take. 97 of 100 changes of a level
are estimated within a factor of two.
"""
ANY_PART = ""


def _no_orders() -> FloatArray:
    return np.zeros((0, COMPARED))


@dataclass(frozen=True)
class Influence:
    """Estimated change by leaving one effect out in all parts of a scene; m meshes, b bearings."""

    mean: FloatArray = field(metadata=in_unit("m", "curve"))
    peak_to_peak: FloatArray = field(metadata=in_unit("m", "curve"))
    """`mean`, `peak_to_peak`: Changes of mean and peak-to-peak of the dynamic transmission error, m. Shape
    (m,) each.
    """
    bearing_force: FloatArray = field(metadata=in_unit("n", "bearing"))
    """Change of the mesh orders 1 to 5 of each bearing's force and of the part that loads excite, together,
    N. Shape (b,).
    """
    relative_mean: float
    relative_peak_to_peak: float
    """`relative_mean`, `relative_peak_to_peak`: Largest change over all meshes, relative to the value with
    the effect.
    """
    relative_bearing_force: float
    """Largest change over all bearings, relative to the largest bearing force."""
    freedoms: int
    rows: int
    """`freedoms`, `rows`: Freedoms, and local coordinates of force elements, that the effect adds."""
    on: bool
    """Whether the effect is on in any part of the scene."""
    orders: FloatArray = field(default_factory=_no_orders, metadata=in_unit("m", "curve", "order"))
    """Change of the largest amplitudes along the run of mesh orders 1 to 5 of the transmission error, m.
    Shape (m, 5).
    """
    bearing_orders: FloatArray = field(default_factory=_no_orders, metadata=in_unit("n", "bearing", "order"))
    """Change of the largest amplitudes along the run of mesh orders 1 to 5 of the bearing forces, N. Shape
    (b, 5).
    """
    relative_orders: FloatArray = field(default_factory=_no_orders)
    relative_bearing_orders: FloatArray = field(default_factory=_no_orders)
    """`relative_orders`, `relative_bearing_orders`: Largest change of each order, relative to the largest
    amplitude of that order with the effect. Shape (5,) each.
    """
    level: LevelChange = field(default_factory=LevelChange)
    """Change of level of the quantity for which the scene is computed, by default of all bearing forces
    together.
    """
    decides: bool = False
    """Whether the level alone decides on the effect."""
    beyond: str = ""
    """Why a run may change by more, in words; empty where linear theory holds."""
    parts: bool = False
    """Whether flanks part, with or without the effect."""

    @property
    def largest(self) -> float:
        """Largest relative change that counts for the decision: of amplitudes of a level, or of all."""
        if self.decides:
            return self.level.relative
        return max(self.relative_mean, self.relative_peak_to_peak, self.relative_bearing_force)

    @property
    def decibels(self) -> float:
        """Largest change, dB: of the level and, unless it alone decides, of the figures of `largest`."""
        level = abs(self.level.decibels) if self.level.relative > ROUNDING else 0.0
        return level if self.decides else max(level, in_decibels(self.largest))

    @property
    def text(self) -> str:
        """The change of the level, and the relative ones of transmission errors, in words."""
        shares = (
            100 * part if part > ROUNDING else 0.0
            for part in (self.relative_mean, self.relative_peak_to_peak)
        )
        mean, ripple = (f"{engineering(share, 2)} %" for share in shares)
        parts = f"{self.level.text}, {mean} of the mean, {ripple} of the peak-to-peak transmission error"
        return f"{parts}; {self.beyond}" if self.beyond else parts

    def to_json(self) -> Json:
        """Return plain JSON without numbers that are not known; whoever shows it says `on` beside it."""
        content: Json = {"words": self.text}
        for item in fields(self):
            value, unit = getattr(self, item.name), item.metadata.get("unit")
            if isinstance(value, LevelChange):
                content[item.name] = asdict(value)
            elif item.name not in ("on", "parts") and (not isinstance(value, float) or np.isfinite(value)):
                content[f"{item.name}_{unit}" if unit else item.name] = np.asarray(value).tolist()
        return content


def estimate_influences(
    scene: Scene, settled: float = 0.0, system: System | None = None, free: bool = False
) -> dict[str, Influence]:
    """Estimate the influence of each effect: toggle it in linear theory, all others as they are.

    Parameters
    ----------
    settled : float
        Part of the run from which on it is looked at, 0..1.
    system : System, optional
        The scene assembled.
    free : bool
        Whether effects that the scene chooses are left out: those left to "auto" are what is decided.

    Returns
    -------
    dict of str to Influence
        Without an effect that has no part in the scene, or without which there is no system that can be
        linearized; empty where linear theory says nothing: torques alone move a train, nothing turns, the
        drives' speeds are in no proportion of small integers.

    Notes
    -----
    The response is that of `parametric_response`: flanks that part, impacts and transients are left out.
    """
    return _sizes(scene, settled, partial(assemble, scene) if system is None else lambda: system, free)


def _sizes(scene: Scene, settled: float, system: Callable[[], System], free: bool) -> dict[str, Influence]:
    """Return `estimate_influences` of a scene, whose `system` is assembled if they are not known."""
    content = content_key(scene)
    for only_free in (False, free):  # sizes of all effects hold those of the free ones
        known = _KNOWN.get((content, settled, only_free))
        if content is not None and known is not None:
            return {name: size for name, size in known.items() if not (free and _chosen(scene, name))}
    sizes = _estimated(scene, settled, system(), free)
    _remember((content, settled, free), sizes)
    return dict(sizes)


def _chosen(scene: Scene, effect: str) -> bool:
    """Return whether a scene chooses an effect by name, so that no tolerance decides on it."""
    return scene.effects.get(effect, "auto") != "auto"


def forget_sizes() -> None:
    """Forget all influences, for example to measure their cost."""
    _KNOWN.clear()


def _remember(key: _Key, sizes: dict[str, Influence]) -> None:
    if key[0] is not None:
        _KNOWN[key] = sizes
        if len(_KNOWN) > KNOWN:
            _KNOWN.pop(next(iter(_KNOWN)), None)


def _estimated(scene: Scene, settled: float, system: System, free: bool) -> dict[str, Influence]:
    """Return `estimate_influences` of a scene that is not known."""
    try:
        conditions = operating_conditions(scene, leading_law(system), settled)
    except (InputError, SolveError):
        return {}
    return _influences(scene, system, conditions, free)


def response_influences(scene: Scene, speed: FloatArray, time: float = 0.0) -> dict[str, Influence]:
    """Return `estimate_influences` of a linear response at speeds (S,), rad/s, > 0.

    At up to 32 of the speeds, alike with and without an effect.
    """
    return _influences(scene, assemble(scene), conditions_at(speed, time))


class ResponseCost(NamedTuple):
    """CPU seconds of a linear response per speed, and per system with or without an effect; systems."""

    speed: float
    system: float
    systems: int


def response_cost(system: System, speed: FloatArray, orders: int) -> ResponseCost:
    """Return the cost of a forced response at speeds (S,), rad/s, and of its `response_influences`.

    Raises `InputError`, `SolveError` as the response.
    """
    freedoms, switched = system.freedoms.column.size, len(_switchable(system))
    at = excited(system, 0.0, max(orders, FEWER))
    lines = (possible_lines(at, count, speed).size for count in (orders, FEWER))
    seconds, fewer = (_VARYING + _SOLVED * freedoms**2 * count for count in lines)
    return ResponseCost(seconds, _BEGUN + fewer * min(speed.size, SPEEDS), 1 + switched)


def _influences(
    scene: Scene, system: System, conditions: Sequence[OperatingCondition], free: bool = False
) -> dict[str, Influence]:
    screened = len(scene.meshes) >= SCREENED
    try:
        current = linear_figures(system, conditions)
        mean = linear_figures(system, conditions, varying=False) if screened else current
    except (InputError, SolveError):
        return {}
    influences = {}
    for name, on in _switchable(system).items():
        if free and _chosen(scene, name):
            continue
        try:
            other = assemble(replace(scene, effects={**scene.effects, name: "off" if on else "on"}))
            influence = None
            if _same((other.arrays, other.bearing_map), (system.arrays, system.bearing_map)):
                influence = _influence_of(system, name, on, current, current)
            elif screened:
                figures = linear_figures(other, conditions, varying=False)
                influence = _influence_of(system, name, on, mean, figures)
            if influence is None or influence.decibels > UNSEEN:
                influence = _influence_of(system, name, on, current, linear_figures(other, conditions))
        except (InputError, SolveError):
            continue
        influences[name] = influence
    return influences


def _same(first: object, second: object) -> bool:
    """Whether arrays are equal, in tuples of tuples: of systems that have the same figures."""
    first, second = by_value(first), by_value(second)
    if isinstance(first, tuple) and isinstance(second, tuple):
        return len(first) == len(second) and all(map(_same, first, second))
    return np.array_equal(np.asarray(first), np.asarray(second))


def _switchable(system: System) -> dict[str, bool]:
    """Return the effects that a part of a system can have and would feel, and whether any has them on."""
    states: dict[str, bool] = {}
    for name in dict.fromkeys(entry.effect for entry in system.ledger.entries):
        able = [entry for entry in system.ledger.of(name) if entry.possible]
        if any(entry.on or entry.influence > 0.0 for entry in able):
            states[name] = any(entry.on for entry in able)
    return states


def _influence_of(
    system: System, name: str, on: bool, current: LinearFigures, other: LinearFigures
) -> Influence:
    """Return the influence of an effect: `current` are the figures, `other` the figures with it toggled.

    Flanks that linear theory pulls apart by more than the backlash would go on that far without a coast
    flank.
    """
    with_effect, without = (current, other) if on else (other, current)
    parts = any(np.any(figures.parted > 0.0) for figures in (current, other))
    mean, ripple = without.mean - with_effect.mean, without.peak_to_peak - with_effect.peak_to_peak
    force = without.bearing_force - with_effect.bearing_force
    orders = without.orders - with_effect.orders
    bearing_orders = without.bearing_orders - with_effect.bearing_orders
    if with_effect.coasting and not without.coasting:
        room = [np.inf if mesh.coast is None else mesh.coast.backlash for mesh in system.scene.meshes]
        ripple = np.maximum(ripple, np.maximum(with_effect.parted - np.array(room), 0.0))
    quantity = system.scene.quantity or BearingForces()
    return Influence(
        mean=mean,
        peak_to_peak=ripple,
        bearing_force=force,
        relative_mean=_largest(mean, with_effect.mean),
        relative_peak_to_peak=_largest(ripple, with_effect.peak_to_peak),
        relative_bearing_force=_largest(force, np.max(with_effect.bearing_force, initial=0.0)),
        freedoms=with_effect.freedoms - without.freedoms,
        rows=with_effect.rows - without.rows,
        on=on,
        orders=orders,
        bearing_orders=bearing_orders,
        relative_orders=_by_order(orders, with_effect.orders),
        relative_bearing_orders=_by_order(bearing_orders, with_effect.bearing_orders),
        level=level_change(with_effect.lines, without.lines, quantity.name, quantity.unit),
        decides=system.scene.quantity is not None,
        beyond=_omission(system, name in LINEAR, parts),
        parts=parts,
    )


def _omission(system: System, linear: bool, parts: bool) -> str:
    """Return the part of a change that linear theory leaves out, in words; `linear`: of a linear effect.

    `parts`: whether flanks part.
    """
    if parts:
        return "flanks part, which linear theory leaves out"
    if system.bearings and not linear:
        return "its size is by the tangents of bearings at the load"
    if system.bearings:
        return "bearings count by their tangents at the load: motion across their clearance is left out"
    return ""


def _by_order(change: FloatArray, value: FloatArray) -> FloatArray:
    """Return the largest change of each order over its largest amplitude, (5,); 0 where there is none."""
    size = np.max(value, axis=0, initial=0.0)
    maximum = np.max(np.abs(change), axis=0, initial=0.0)
    is_present = size > ROUNDING * np.max(size, initial=0.0)
    return np.asarray(np.divide(maximum, size, out=np.zeros(maximum.shape), where=is_present))


def _largest(change: FloatArray, value: FloatArray | float) -> float:
    """Return the largest relative change; of nothing, nothing."""
    size = np.broadcast_to(np.abs(np.asarray(value, dtype=float)), change.shape)
    part = np.divide(np.abs(change), size, out=np.zeros(change.shape), where=size > 0.0)
    return float(np.max(part, initial=0.0))


@dataclass(frozen=True)
class _Allowance:
    """Changes that a tolerance allows effects to make, in the unit of `size`."""

    text: str
    """Tolerance as text, with its unit."""
    alone: float
    """Change by one effect, above which the effect is turned on though the scene does not call for it."""
    together: float
    """Largest sum of the changes by all neglected effects."""
    size: Callable[[Influence], float]
    """Change by an effect."""
    parted: bool
    """Whether effects are neglected too where flanks part, of which linear theory knows nothing."""

    @classmethod
    def of(cls, scene: Scene) -> _Allowance | None:
        """Return the allowance of a scene's tolerance, a relative one first; None: there is no tolerance."""
        if scene.tolerance is not None:
            allowed = SHARE * scene.tolerance
            size, text = (lambda influence: influence.largest), f"{scene.tolerance:g}"
            return cls(text=text, alone=allowed, together=allowed, size=size, parted=True)
        if scene.level_tolerance is None:
            return None
        maximum = scene.level_tolerance
        size, text = (lambda influence: influence.decibels), f"{maximum:g} dB"
        return cls(text=text, alone=maximum, together=LEVEL_SHARE * maximum, size=size, parted=False)


@dataclass(frozen=True)
class Decision:
    """A scene with the decisions by its tolerance."""

    scene: Scene
    """Scene whose `effects` hold the decisions."""
    automatic: Mapping[str, str] = field(default_factory=dict)
    """Effects on which the tolerance decided otherwise than the scene calls for, each with the reason."""
    influences: Mapping[str, Influence] = field(default_factory=dict)
    """Estimates; empty where there was no tolerance to decide by."""
    taken: TimeTaken = field(default_factory=TimeTaken)
    """Time that the decision took."""
    assembled: tuple[Scene, System] | None = None
    """Scene that was assembled for the estimates, and its system."""

    def system(self) -> System:
        """Return the system of the scene, that of the estimates where they were of the same scene."""
        if self.assembled is not None and self.assembled[0] is self.scene:
            return self.assembled[1]
        return assemble(self.scene)

    @property
    def allowed(self) -> float:
        """Relative change that the tolerance of the scene allows."""
        if self.scene.tolerance is not None:
            return self.scene.tolerance
        return in_relative(self.scene.level_tolerance or 0.0)

    @property
    def neglected(self) -> dict[str, Influence]:
        """Effects that the scene calls for and are off, with their influence."""
        off = [name for name in self.automatic if self.scene.effects[name] == "off"]
        return {name: self.influences[name] for name in off}


def decide_effects(
    scene: Scene, estimates: Callable[[Scene], Mapping[str, Influence]] | None = None
) -> Decision:
    """Decide the effects that are left to "auto" by the scene's tolerance; without one, as the scene calls.

    Influences may sum up to a tenth of a relative tolerance in neglected effects, to half of a tolerance of
    levels, the smallest first. They are of the amplitudes of the quantity that the scene is computed for;
    where it states none, of mean and peak-to-peak transmission error and of the largest bearing force too. An
    effect that the scene does not call for is on if its influence by itself exceeds that tenth, or the whole
    tolerance of levels. By default `estimate_influences`, for levels and a minimal receipt of what
    is decided alone.
    """
    allowance = _Allowance.of(scene)
    if allowance is None:
        return Decision(scene)
    began = TimeTaken.now()
    systems: list[System] = []

    def system() -> System:
        systems.append(assemble(scene))
        return systems[0]

    if estimates is None:
        lean = scene.tolerance is None and scene.outputs.receipt != "full"
        influences: Mapping[str, Influence] = _sizes(scene, 0.0, system, free=lean)
    else:
        influences = estimates(scene)
    free = {name: influence for name, influence in influences.items() if not _chosen(scene, name)}
    automatic = {
        name: f"on for the tolerance of {allowance.text}: influence {influence.text}"
        for name, influence in free.items()
        if not influence.on and allowance.size(influence) > allowance.alone
    }
    choices = dict.fromkeys(automatic, "on")
    for name in _neglected(free, allowance):
        choices[name] = "off"
        automatic[name] = f"neglected for the tolerance of {allowance.text}: influence {free[name].text}"
    chosen = replace(scene, effects={**scene.effects, **choices}) if choices else scene
    assembled = (scene, systems[0]) if systems else None
    return Decision(chosen, automatic, influences, TimeTaken.now().since(began), assembled)


def _neglected(free: Mapping[str, Influence], allowance: _Allowance) -> list[str]:
    """Return the effects on that a tolerance allows to neglect together, the smallest first."""
    able = {
        name: allowance.size(influence)
        for name, influence in free.items()
        if influence.on and name in LINEAR and (allowance.parted or not influence.parts)
    }
    order = sorted(able, key=lambda name: able[name])
    total = np.cumsum([able[name] for name in order])
    return [name for name, changed in zip(order, total, strict=True) if changed <= allowance.together]


class NeglectedChecks:
    """Quantities of a run, gathered by block, to compare with estimates of neglected effects."""

    def __init__(self, decision: Decision) -> None:
        self._decision = decision
        meshes = len(decision.scene.meshes)
        self._low, self._high = np.full(meshes, np.inf), np.full(meshes, -np.inf)
        self._sum, self._samples, self._parted = np.zeros(meshes), 0, False

    def see(self, series: SeriesBlock, _states: States) -> None:
        """Take a block of series."""
        error: FloatArray = series["dynamic_transmission_error"]
        self._low = np.minimum(self._low, np.min(error, axis=1, initial=np.inf))
        self._high = np.maximum(self._high, np.max(error, axis=1, initial=-np.inf))
        self._sum = self._sum + np.sum(error, axis=1)
        self._samples += error.shape[1]
        self._parted = self._parted or bool(np.any(series["mesh_force"] <= 0.0))

    def checks(self) -> list[Check]:
        """Return one check per neglected effect.

        ``change`` is its estimate over the computed mean and peak-to-peak transmission error, and of bearing
        forces as estimated. Where flanks parted the linear theory of the estimate says nothing: it does not
        hold.
        """
        left = self._decision.neglected if self._samples else {}
        return [self._check(name, influence) for name, influence in left.items()]

    def _check(self, name: str, influence: Influence) -> Check:
        mean, ripple = np.abs(self._sum) / self._samples, self._high - self._low
        parts = [
            np.max(np.abs(influence.mean) / np.maximum(mean, 1e-300), initial=0.0),
            np.max(np.abs(influence.peak_to_peak) / np.maximum(ripple, 1e-300), initial=0.0),
        ]
        change = max(*(float(part) for part in parts), influence.relative_bearing_force)
        size = "the computed mean, peak-to-peak or bearing force"
        if influence.decides:
            change, size = influence.largest, f"the amplitude of {influence.level.quantity}"
        reason = f"estimated at {engineering(100.0 * change, 2)} % of {size}"
        if self._parted:
            reason = "flanks lifted off: the linear theory that neglected it is invalid"
        holds = not self._parted and change <= self._decision.allowed
        assumption = "neglected effects are negligible"
        return Check(name, assumption, ANY_PART, holds, reason, {"change": change})
