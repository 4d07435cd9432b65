"""Flanks of single teeth: slope and form of profile and helix, and measured surfaces (ISO 1328-1)."""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bounds import Declared, Kind, between, declared, described, inside, integers, required
from fe_contact.errors import InputError, declared_fields
from fe_contact.flank.flank_grid import FlankGrid
from fe_contact.flank.over_flank import SURFACE, check_reach
from fe_contact.geometry.tooth_surfaces import ToothSurfaces
from fe_contact.types import FloatArray, IntArray

if TYPE_CHECKING:
    from fe_contact.flank.tooth import Tooth

_LARGEST = 1e-3  # m; larger deviations are micrometers stated as meters
MAX_TEETH = 4000
"""Largest number of a tooth."""
MAX_NODES = 250_000
"""Most nodes of the surfaces of all teeth of a gear."""

_TOOTH = "Number of the tooth in the order of meshing; 1 is that of pair 0 at position 0"
_SLOPE = "Slope deviation {} over the {}; > 0: half of it in excess at {}, half missing at the other end"
_FORM = "Form deviation {} over the {}, the height of its shape; > 0: in excess in the middle"
_GRID = replace(
    SURFACE,
    description="Surface removed from this tooth alone, in addition to its deviations and the modifications",
    omit_default=True,
)


def _deviation(text: str, example: float) -> Declared:
    return Declared(
        Kind.LENGTH, "m", between(-_LARGEST, _LARGEST), text, example, written="µm", omit_default=True
    )


def _waves(along: str) -> Declared:
    text = f"Waves of the form deviation over the {along}, a crest in its middle; 0: a parabola"
    return Declared(Kind.COUNT, "", integers(0, 50), text, 0, omit_default=True)


@described
@dataclass(frozen=True)
class ToothFlank:
    """Deviation of the loaded flank of one tooth from the designed flank; > 0 is material in excess.

    Raises
    ------
    InputError
        A value out of its bounds.
    """

    tooth: int = required(Declared(Kind.COUNT, "", integers(1, MAX_TEETH), _TOOTH, 1))
    profile_slope: float = declared(
        0.0, _deviation(_SLOPE.format("f_Halpha", "usable profile", "the tip"), 3e-6)
    )
    profile_form: float = declared(0.0, _deviation(_FORM.format("f_falpha", "usable profile"), 2e-6))
    profile_form_waves: int = declared(0, _waves("usable profile"))
    helix_slope: float = declared(
        0.0, _deviation(_SLOPE.format("f_Hbeta", "face width", "the end of larger z"), 3e-6)
    )
    helix_form: float = declared(0.0, _deviation(_FORM.format("f_fbeta", "face width"), 2e-6))
    helix_form_waves: int = declared(0, _waves("face width"))
    flank_grid: FlankGrid | None = declared(None, _GRID)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def neutral(self) -> bool:
        """Whether the flank is as designed."""
        return not (any(self._amounts) or self._surface)

    @property
    def varies_along_face(self) -> bool:
        """Whether the deviation differs over the face width."""
        across = bool(self._surface) and self._surface[0].varies_along_face
        return bool(self.helix_slope or self.helix_form or across)

    @cached_property
    def largest(self) -> float:
        """Bound of the deviation, m."""
        surface = (abs(value) for grid in self._surface for row in grid.removed for value in row)
        slopes = 0.5 * (abs(self.profile_slope) + abs(self.helix_slope))
        return slopes + abs(self.profile_form) + abs(self.helix_form) + max(surface, default=0.0)

    @property
    def shape(self) -> Hashable:
        """Key of a flank's shape: equal for teeth whose flanks are alike."""
        return None if self.neutral else replace(self, tooth=1)

    @property
    def hollow(self) -> float:
        """Largest second derivative of the deviation by u of `coordinates` where the profile is hollow, m.

        A slope has none, cosine waves have 0.5 (pi waves)^2 times the form, a hollow parabola twice the form.
        """
        waves = math.pi * self.profile_form_waves
        return 0.5 * waves**2 * abs(self.profile_form) if waves else 2.0 * max(-self.profile_form, 0.0)

    def excess(self, gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> FloatArray:
        """Return the material in excess, m, at roll lengths and distances from mid-face in m."""
        return flanks_excess(gear, (self,), np.array(self.tooth - 1), roll_length, face_position)

    @property
    def _amounts(self) -> tuple[float, ...]:
        return self.profile_slope, self.profile_form, self.helix_slope, self.helix_form

    @property
    def _surface(self) -> tuple[FlankGrid, ...]:
        """The measured surface, or nothing where it is neutral."""
        return () if self.flank_grid is None or self.flank_grid.neutral else (self.flank_grid,)


def coordinates(gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> tuple[FloatArray, ...]:
    """Return u, v of points on the flank: from -1 at the form circle to 1 at the tip, and over the face."""
    form, tip = gear.form_roll_length, gear.tip_roll_length
    u = (2.0 * roll_length - form - tip) / (tip - form)
    return np.clip(u, -1.0, 1.0), 2.0 * face_position / gear.face_width


def tooth_shapes(gear: Tooth, roll_length: FloatArray, face_position: FloatArray) -> dict[str, FloatArray]:
    """Return the excess by 1 m of each slope, and of each form without waves, by field of `ToothFlank`."""
    u, v = np.broadcast_arrays(*coordinates(gear, roll_length, face_position))
    zeros = np.zeros(u.shape)
    return {
        "profile_slope": 0.5 * u,
        "profile_form": _form(zeros + 1.0, zeros, u),
        "helix_slope": 0.5 * v,
        "helix_form": _form(zeros + 1.0, zeros, v),
    }


def flanks_excess(
    gear: Tooth, flanks: Sequence[ToothFlank], tooth: IntArray, roll_length: FloatArray, face: FloatArray
) -> FloatArray:
    """Return how far flanks of teeth stand towards the mate, m.

    Parameters
    ----------
    tooth : ndarray of int
        Teeth in the order of meshing, the first is 0; those without an entry are as designed.
    roll_length, face : ndarray
        Points of these flanks, m; `face` from mid-face. All arrays broadcast.
    """
    return tooth_surfaces(gear, flanks).excess(tooth, roll_length, face)


def tooth_surfaces(gear: Tooth, flanks: Sequence[ToothFlank]) -> ToothSurfaces:
    """Lay out flanks of a gear; teeth without an entry, also beyond the last one, are as designed."""
    teeth = max((flank.tooth for flank in flanks), default=0)
    amounts = np.zeros((teeth, 6))  # slope, form and waves of the profile, then of the helix
    grids: list[FlankGrid | None] = [None] * teeth
    for flank in flanks:
        amounts[flank.tooth - 1] = (
            *(flank.profile_slope, flank.profile_form, flank.profile_form_waves),
            *(flank.helix_slope, flank.helix_form, flank.helix_form_waves),
        )
        grids[flank.tooth - 1] = flank.flank_grid
    return ToothSurfaces.of(gear, amounts, grids)


def _form(height: FloatArray, waves: FloatArray, at: FloatArray) -> FloatArray:
    """Return form deviations of a height at coordinates `at` from -1 to 1.

    The mean of a shape is zero, and so is its slope: a measurement would find the same form and no slope.
    """
    shape = 1.0 / 3.0 - at**2
    if waves.any():
        shape = np.where(waves == 0.0, shape, 0.5 * np.cos(math.pi * waves * at))
    return np.asarray(height * shape)


def repeats_after(values: tuple[Hashable, ...]) -> int:
    """Return the least number of entries after which a closed sequence repeats; 1 for an empty one."""
    count = len(values)
    periods = (n for n in range(1, count) if count % n == 0 and values == values[:n] * (count // n))
    return next(periods, max(count, 1))


def flanks_period(flanks: Collection[ToothFlank], teeth: int) -> int:
    """Return the number of teeth after which their flanks repeat."""
    shapes: list[Hashable] = [None] * teeth
    for flank in flanks:
        shapes[flank.tooth - 1] = flank.shape
    return repeats_after(tuple(shapes))


def check_flanks(gear: Tooth, flanks: Sequence[ToothFlank], teeth: int) -> None:
    """Refuse entries of teeth that the gear lacks or that come twice, and surfaces that miss the flank."""
    seen: set[int] = set()
    nodes = 0
    for index, flank in enumerate(flanks):
        with inside(f"tooth_flanks[{index}]"):
            if flank.tooth > teeth:
                raise InputError("tooth", flank.tooth, f"at most {teeth}, the number of teeth")
            if flank.tooth in seen:
                raise InputError("tooth", flank.tooth, "another tooth in every entry", "Add both up.")
            if flank.flank_grid is not None:
                check_reach(flank.flank_grid, gear)
                nodes += len(flank.flank_grid.roll_length) * len(flank.flank_grid.face_position)
        seen.add(flank.tooth)
    if nodes > MAX_NODES:
        raise InputError("tooth_flanks", f"{nodes} nodes", f"at most {MAX_NODES} nodes of all surfaces")


def turned_back(flanks: Sequence[ToothFlank], teeth: int) -> tuple[ToothFlank, ...]:
    """Return the flanks in the order of the other sense of rotation: tooth 1 stays, 2 becomes the last."""
    return tuple(replace(flank, tooth=(1 - flank.tooth) % teeth + 1) for flank in flanks)
