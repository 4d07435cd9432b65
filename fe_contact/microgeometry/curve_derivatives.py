"""Derivatives of curves of transmission error and load arm by the flanks, the alignment and the torque.

A figure is what a curve is differentiated by: a quantity of a gear's flank modification
("pinion.tip_relief"), the misalignment, the center distance or the torque. The quantities of a curve are its
mean, its peak-to-peak and its amplitudes (`curve_quantities`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.contact import CarryingStrips, ContactSolution, load_arm
from fe_contact.contact.model import GapTerm
from fe_contact.effects.flank_modification import ModificationGap
from fe_contact.effects.misalignment import MisalignmentGap
from fe_contact.errors import InputError, SolveError
from fe_contact.flank.modification import UNMODIFIED, FlankModification
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.variables import (
    ACROSS_FACE,
    GEARS,
    LENGTHS,
    QUANTITIES,
    SLOPES,
    effect_of,
    figure,
    gear_and_quantity,
    lacks_length,
)
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, PEAK_TO_PEAK, quantity_derivatives
from fe_contact.types import FloatArray

CENTER_DISTANCE, TORQUE = "center_distance_change", "torque"


AMOUNT_STEP, LENGTH_STEP = 1e-6, 1e-6
"""Steps of differences by the flanks: of amounts in m, in which the gap is linear, and of lengths relative to
the length.
"""


DISTANCE_STEP = 1e-7
"""Step of the center distance to a larger one, m. The curve is solved there too, since other points of the
flanks touch.
"""


NEAR = 0.8
"""Least pressure, over the largest one, of the points whose pressure is differentiated."""


@dataclass(frozen=True)
class FlankDerivatives:
    """Derivatives by material removed at the nodes of a grid over the flank, bilinear between the nodes."""

    roll_length: FloatArray
    face_position: FloatArray
    """`roll_length`, `face_position`: Roll length, and distance from the gear's mid-face, m. Ndarray, shapes
    (R,), (Z,).
    """
    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Derivatives of mean and peak-to-peak STE, m/m. Shape (F, R, Z) each."""
    harmonics: FloatArray
    """Derivatives of the amplitudes of the mesh harmonics, m/m. Shape (20, F, R, Z)."""


@dataclass(frozen=True)
class CurveDerivatives:
    """Curves at F torques and their derivatives by A figures."""

    names: tuple[str, ...]
    """Names of the figures: ``gear.quantity``, "misalignment", "center_distance_change" or "torque"."""
    torque: FloatArray
    """Torque on the driving gear, N m. Shape (F,)."""
    position: FloatArray
    """Position, base pitches. Shape (P,)."""
    ste: FloatArray
    """Static transmission error, m. Shape (P, F)."""
    by: FloatArray
    """Derivatives of the transmission error by the figures, m/m; by the torque in m/(N m). Shape (A, P, F).
    """
    load_arm: FloatArray
    """Arm of the load about the axis of a misalignment, m. Shape (P, F)."""
    load_arm_by: FloatArray
    """Derivatives of `load_arm`, in the units of `by`. Shape (A, P, F)."""
    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Derivatives of mean and peak-to-peak STE by the figures. Shape (A, F) each."""
    harmonics: FloatArray
    """Derivatives of the amplitudes of the mesh harmonics by the figures. Shape (A, 20, F)."""
    # carrying strips of the solutions, and derivatives of the quantities by the curve, (quantities, P, F)
    _strips: CarryingStrips = field(repr=False)
    _quantities: FloatArray = field(repr=False)

    def on_flank(self, gear: str, profile: int = 21, face: int = 21) -> FlankDerivatives:
        """Return the derivatives by the flank of "pinion" or "wheel" on a grid of (profile, face) nodes.

        The grid spans the involute and the face width; in the plane all of the face changes together.
        """
        pair = self._strips.strips.pair
        toothing = getattr(pair, gear)
        ends = toothing.form_roll_length, toothing.tip_roll_length
        roll = np.linspace(min(ends), max(ends), profile)
        across = 0.5 * toothing.face_width * np.linspace(-1.0, 1.0, face)
        levels = np.eye(self.torque.size)  # a quantity at torque g depends on the curve at g alone
        rows = np.einsum("qpf,fg->qgpf", self._quantities, levels).reshape(-1, *self.ste.shape)
        slopes = self._strips.on_flank(GEARS.index(gear), roll, across, rows)
        slopes = slopes.reshape(-1, self.torque.size, profile, face)
        return FlankDerivatives(roll, across, slopes[MEAN], slopes[PEAK_TO_PEAK], slopes[FIRST_HARMONIC:])


def curve_derivatives(
    bodies: CondensedPair,
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray,
    by: Sequence[str] | None = None,
    misalignment: float = 0.0,
    center_distance_change: float = 0.0,
) -> CurveDerivatives:
    """Solve the curves of flanks on condensed bodies, and the arms of the load, with their derivatives.

    Raises `InputError` as `CondensedPair.table`, or a name whose effect is off, or a relief without its
    length; `SolveError`: the contact of a position cannot be solved.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        The same macro geometry with any flank modification.
    torques : sequence of float
        Torques on the driving gear in N m, increasing, > 0.
    by : sequence of str, optional
        Figures, by name: ``gear.quantity`` of `QUANTITIES`, "misalignment", "center_distance_change" and
        "torque"; default: all figures of the flanks that act, the misalignment where it can, and the torque.
        A figure that is zero and cannot be negative is given its derivative to the one side.
    misalignment, center_distance_change : float
        m.
    """
    loads = np.asarray(torques, dtype=float)
    solved = bodies.solve(pair, loads, misalignment, center_distance_change)
    checked, problem, solution = solved.checked, solved.problem, solved.solution
    _require_solved(solution)
    names = _checked_names(pair, checked, by)
    strips = CarryingStrips.of(solved.pair, problem, solution)
    arm = load_arm(solved.pair, problem, solution)

    def derivative(name: str) -> tuple[FloatArray, FloatArray]:
        if name == TORQUE:
            return solution.tangent * (solution.load / loads), (strips.added_arm - arm) / loads
        if name == CENTER_DISTANCE:  # its compliance changes: the curve is solved once more
            further = bodies.solve(pair, loads, misalignment, center_distance_change + DISTANCE_STEP)
            return _differences(further, solution, arm)
        opened = Difference.of(pair, name).opened(strips)
        return strips.change(opened), strips.arm_change(opened)

    derivatives, of_arm = (np.stack(arrays) for arrays in zip(*map(derivative, names), strict=True))
    weights = _quantity_weights(solution.deflection, checked.model.period)
    changes = np.einsum("qpf,apf->aqf", weights, derivatives)
    return CurveDerivatives(
        names=names,
        torque=loads,
        position=problem.candidates.position,
        ste=solution.deflection,
        by=derivatives,
        load_arm=arm,
        load_arm_by=of_arm,
        mean=changes[:, MEAN],
        peak_to_peak=changes[:, PEAK_TO_PEAK],
        harmonics=changes[:, FIRST_HARMONIC:],
        _strips=strips,
        _quantities=weights,
    )


def _checked_names(pair: ParallelAxes, checked: Checked, by: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of the derivatives, by default all; raises `InputError` by the first that has none."""
    names = _all_names(pair, checked) if by is None else tuple(by)
    for name in names:
        _check_name(name, pair, checked)
    return names


def _quantity_weights(deflection: FloatArray, period: int) -> FloatArray:
    """Return the derivatives of the curve quantities by each value of the curves (P, F), (q, P, F)."""
    return np.stack([quantity_derivatives(curve, period) for curve in deflection.T], axis=-1)


def _differences(
    further: SolvedOperatingPoint, solution: ContactSolution, arm: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the changes of deflection and load arm by the center distance, per m."""
    _require_solved(further.solution)
    further_arm = load_arm(further.pair, further.problem, further.solution)
    change = further.solution.deflection - solution.deflection
    return change / DISTANCE_STEP, (further_arm - arm) / DISTANCE_STEP


def _all_names(pair: ParallelAxes, checked: Checked) -> tuple[str, ...]:
    """Return the names of all figures that change the curves, but for the center distance.

    The derivative by the center distance costs a further solution.
    """
    flanks = [f"{gear}.{quantity}" for gear in GEARS for quantity in QUANTITIES]
    named = (
        *(name for name in flanks if not lacks_length(pair, name.removesuffix("_length"))),
        MISALIGNMENT,
        TORQUE,
    )
    return tuple(name for name in named if acts(name, checked))


def acts(name: str, checked: Checked) -> bool:
    """Return whether a figure of the flanks or the alignment changes the curves of a model."""
    if name in (TORQUE, CENTER_DISTANCE):
        return True
    request = checked.request
    effect = request.named(name) or effect_of(name, request.registry)
    across = name == MISALIGNMENT or name.partition(".")[2] in ACROSS_FACE
    return request.choices.get(effect) != "off" and (checked.model.across_face or not across)


def _check_name(name: str, pair: ParallelAxes, checked: Checked) -> None:
    if name not in (MISALIGNMENT, CENTER_DISTANCE, TORQUE):
        gear_and_quantity("by", name)
        if lacks_length(pair, name.removesuffix("_length")):
            raise InputError("by", name, "a relief that has a length", "Give the flank its length.")
    if not acts(name, checked):
        remedy = "Analyze the pair over the face width, and leave the effect at auto."
        raise InputError("by", name, "a figure whose effect the table has", remedy)


def _require_solved(solution: ContactSolution) -> None:
    if not solution.converged:
        raise SolveError("the contact of a position cannot be solved", solution.status)


@dataclass(frozen=True)
class Difference:
    """The gaps at both ends of a step of a figure of the flanks or of the misalignment, `over` m apart."""

    above: GapTerm
    below: GapTerm
    over: float

    @classmethod
    def of(cls, pair: ParallelAxes, name: str) -> Difference:
        """Return the difference about the present figure of the pair."""
        if name == MISALIGNMENT:
            return cls(MisalignmentGap(1.0), MisalignmentGap(0.0), 1.0)
        gear, quantity = gear_and_quantity("by", name)
        value = figure(pair, name)
        step = LENGTH_STEP * value if quantity in LENGTHS else AMOUNT_STEP
        low = value - step if quantity in SLOPES else max(value - step, 0.0)
        part = getattr(pair, gear).modification.part_with(quantity)
        above, below = (_gap(gear, replace(part, **{quantity: end})) for end in (value + step, low))
        return cls(above, below, value + step - low)

    def opened(self, strips: CarryingStrips) -> FloatArray:
        """Return the change of the normal gap of each strip by the figure, (k,), m/m."""
        return strips.opened(self.above, self.below) / self.over


def _gap(gear: str, modification: FlankModification) -> ModificationGap:
    return ModificationGap(**(dict.fromkeys(GEARS, UNMODIFIED) | {gear: modification}))
