"""What of a case can be swept: names as in the case file, short ones, and the values if none are given."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bounds import Kind
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.sweep_request import CENTER_DISTANCE, TORQUE, SweepAxis
from fe_contact.microgeometry.variables import GEARS, figure
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.declared import Figure, figures
from lineofaction.gearbox.schemas.number_list import number_list
from lineofaction.gearbox.units import factor, unit_name

STEPS = 9
"""Values of an axis whose range is not given."""
_EACH = 3  # fewer torques of a case are no range
_SKEW_UM, _DISTANCE = 30.0, 0.002  # usual misalignment; part of the center distance


@dataclass(frozen=True)
class Swept:
    """Something of a case that can be swept.

    Attributes
    ----------
    name : str
        Of a `SweepAxis`.
    path : str
        As in the case file; ``*`` stands for both gears.
    words : str
    what : Figure or None
        The declaration of a figure of the flanks.
    """

    name: str
    path: str
    words: str
    what: Figure | None = None

    @property
    def unit(self) -> str:
        """Symbol of the unit of the boundary."""
        return (unit_name(self.path) or "N m").replace("um", "µm")

    @property
    def factor(self) -> float:
        """The SI value of one unit."""
        return factor(self.path)

    @property
    def label(self) -> str:
        """The words with the unit, as on an axis."""
        return f"{self.words}, {self.unit}"

    @property
    def spellings(self) -> set[str]:
        """What it may be called: the path, its last names, and these without the unit."""
        names = self.path.split(".")
        least = 2 if self.what is not None and "*" not in names else 1
        tails = {".".join(names[-count:]) for count in range(least, len(names) + 1)}
        last = self.name.rpartition(".")[2]
        return tails | {f"{head}{dot}{last}" for head, dot, _ in (tail.rpartition(".") for tail in tails)}


CONDITIONS = (
    Swept(TORQUE, "load.torque_n_m", "torque on the driving gear"),
    Swept("misalignment", "errors.misalignment_um", "misalignment"),
    Swept(CENTER_DISTANCE, "errors.center_distance_change_mm", "change of the center distance"),
)
_FIGURES = figures(FlankModification, Kind.AMOUNT, Kind.SLOPE, Kind.LENGTH)
SWEEPABLE = {
    swept.name: swept
    for swept in (
        *CONDITIONS,
        *(Swept(f.name, f"pair.*.{f.field}", f"{f.words} of both gears", f) for f in _FIGURES),
        *(
            Swept(f"{gear}.{f.name}", f"pair.{gear}.{f.field}", f"{f.words} of the {gear}", f)
            for gear in GEARS
            for f in _FIGURES
        ),
    )
}
"""By the name of their `SweepAxis`."""


def axis_of(case: Case, text: str) -> SweepAxis:
    """Return the axis that ``NAME`` or ``NAME=FIRST:LAST:STEP`` says.

    Raises
    ------
    BadInput
        There is no such name, or no such values.
    """
    typed, given, values = text.partition("=")
    swept = _named(text, typed.strip())
    numbers = number_list(f"over {typed.strip()}", values) if given else _usual(case, swept)
    if any(later <= earlier for earlier, later in pairwise(numbers)):
        raise BadInput.of("over", text, "over increasing values", "For example torque=50:300:50.")
    return SweepAxis(swept.name, tuple(value * swept.factor for value in numbers))


def _named(text: str, name: str) -> Swept:
    """Return what a name stands for."""
    for swept in SWEEPABLE.values():
        if name in swept.spellings:
            return swept
    short = [swept.name for swept in SWEEPABLE.values()]
    close = difflib.get_close_matches(name[:64], short, n=3, cutoff=0.5)
    advice = f"Did you mean {' or '.join(close)}?" if close else f"For example {', '.join(short[:4])}."
    bound = (
        "the torque, the alignment or a flank modification of a case; other bodies need tables of their own"
    )
    raise BadInput.of("over", text, bound, advice)


def _usual(case: Case, swept: Swept) -> list[float]:
    """Return the values of an axis of which only the name is given, in the unit of the boundary."""
    pair = gear_pair(case)
    if swept.what is not None:
        return _flank_range(pair, swept, swept.what)
    if swept.name == TORQUE:
        own = case.load.torque_n_m or [float(pair.torque(force)) for force in case.load.normal_force_n or ()]
        return list(own) if len(own) >= _EACH else _evenly(0.2 * own[-1], own[-1])
    if swept.name == CENTER_DISTANCE:
        changes = case.errors.center_distance_change_mm
        most = _DISTANCE * pair.center_distance / swept.factor
        return list(changes) if len(changes) > 1 else _evenly(0.0, most)
    most = max(map(abs, case.errors.misalignment_um)) or _SKEW_UM
    return _evenly(-most, most)


def _flank_range(pair: ParallelAxes, swept: Swept, what: Figure) -> list[float]:
    """Return values about the case's own, or about a usual one where the case has none."""
    variables = SweepAxis(swept.name, ()).variables
    own = max(abs(figure(pair, name)) for name in variables) or float(what.what.example)
    size = what.own(own)
    if what.what.kind is Kind.LENGTH:
        return _evenly(0.5 * size, 1.5 * size)
    return _evenly(-2.0 * size if what.what.kind is Kind.SLOPE else 0.0, 2.0 * size)


def _evenly(first: float, last: float) -> list[float]:
    """Return evenly spaced values without the noise of the steps."""
    return [float(f"{value:.6g}") for value in np.linspace(first, last, STEPS)]
