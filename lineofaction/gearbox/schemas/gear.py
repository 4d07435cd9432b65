"""Gear of the case file: toothing and flank modifications (ISO 21771 names, units in the names)."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping
from typing import Annotated, Self, TypeVar

from pydantic import Field, model_validator

from fe_contact.flank.drawing_starts import RELIEFS, DrawingStarts, starts_of
from fe_contact.flank.modification import FlankModification
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.tooth_flank import MAX_NODES
from fe_contact.geometry.toothing import MATING, Toothing
from fe_contact.material import Material
from fe_contact.shaft import Shaft
from lineofaction.gearbox.schemas.declared import (
    Figure,
    as_fields,
    declared_in,
    figures,
    parts_in,
    parts_of,
    with_fields,
)
from lineofaction.gearbox.schemas.flank_grid import Deviation
from lineofaction.gearbox.schemas.model import BoundaryModel, Json, Listed, refuse

PitchDeviations = Annotated[Listed[Deviation], Field(max_length=4000)]
SHARED = tuple(figure for figure in figures(Toothing) if figure.name in MATING)
"""Figures that a case has once, for both gears."""
_STARTS = {f"{relief}_length_mm": relief for relief in RELIEFS}
"""Relief by the field of its length."""


@with_fields(declared_in(Material))
class MaterialInput(BoundaryModel):
    """Linear elastic, isotropic material."""


@with_fields(declared_in(Shaft))
class GearShaftInput(BoundaryModel):
    """A round shaft on two bearings that carries a gear."""


def of_gear(kind: type[Toothing]) -> tuple[Figure, ...]:
    """Return the figures of a kind of gear that a case has in the gear's table."""
    return tuple(figure for figure in figures(kind) if figure not in SHARED)


@with_fields(as_fields(of_gear(Toothing)))
class _ToothingFigures(BoundaryModel):
    """The figures of all gears."""

    teeth: int
    face_width_mm: float


def _start_fields(relief: str) -> tuple[str, ...]:
    """Return the fields of a gear that state where a relief starts."""
    return tuple(figure.field for figure in figures(DrawingStarts) if figure.name in starts_of(relief))


def _replaced_starts(names: Iterable[str]) -> set[str]:
    """Return the fields of starts that the lengths of reliefs among some fields replace."""
    reliefs = [_STARTS[name] for name in names if name in _STARTS]
    return {field for relief in reliefs for field in _start_fields(relief)}


@with_fields({**declared_in(FlankModification), **declared_in(DrawingStarts), **parts_in(parts_of(Gear))})
class ToothingInput(_ToothingFigures):
    """Fields of all gears. Modifications: > 0 is material removed, normal to the involute, transverse."""

    pitch_deviation_um: PitchDeviations = Field(
        default=(),
        description="Cumulative pitch deviation F_pi (ISO 1328-1) of the loaded flank of every tooth in µm, "
        "in the order of meshing; > 0: towards the mate; left out: none",
        examples=[[0.0, 3.0, 1.0, -4.0, -2.0]],
    )
    single_pitch_deviation_um: PitchDeviations = Field(
        default=(),
        description="Single pitch deviation f_pi (ISO 1328-1) of the loaded flank of every tooth to the one "
        "before it in µm, in the order of meshing, instead of F_pi; its mean is taken out; left out: none",
        examples=[[4.0, 3.0, -2.0, -5.0, 2.0]],
        exclude_if=operator.not_,
    )
    shaft: GearShaftInput | None = Field(
        default=None,
        description="Steel shaft that bends under the tooth forces; left out: rigid",
        examples=[{"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 60.0}],
    )
    material: MaterialInput | None = Field(
        default=None,
        description="Material of this gear; left out: the case's",
        examples=[{"youngs_modulus_gpa": 210.0}],
    )

    @model_validator(mode="after")
    def _a_deviation_per_tooth(self) -> Self:
        for field in ("pitch_deviation_um", "single_pitch_deviation_um"):
            count = len(getattr(self, field))
            if count not in (0, self.teeth):
                bound = f"a list of {self.teeth} values, one per tooth"
                refuse(field, f"{count} values", bound, "In the order in which the teeth mesh.")
        if self.pitch_deviation_um and self.single_pitch_deviation_um:
            bound = "left out when pitch_deviation_um is given"
            refuse("single_pitch_deviation_um", "given", bound, "One follows from the other.")
        return self

    @model_validator(mode="after")
    def _few_nodes(self) -> Self:
        """Refuse surfaces of teeth with so many nodes that their checks take long."""
        grids = [flank.flank_grid for flank in getattr(self, "tooth_flanks", ()) if flank.flank_grid]
        nodes = sum(len(grid.roll_length_mm) * len(grid.face_position_mm) for grid in grids)
        if nodes > MAX_NODES:
            refuse("tooth_flanks", f"{nodes} nodes", f"at most {MAX_NODES} nodes of all surfaces")
        return self


ToothingT = TypeVar("ToothingT", bound=ToothingInput)


@with_fields(as_fields(of_gear(Gear)))
class GearInput(ToothingInput):
    """One external gear."""


def with_figures(gear: Json, figures: Json) -> Json:
    """Return the table of a gear with figures of its flanks; a length replaces where the relief starts."""
    replaced = _replaced_starts(figures)
    return {name: value for name, value in gear.items() if name not in replaced} | figures


def with_flank(gear: ToothingT, figures: Mapping[str, object]) -> ToothingT:
    """Return a gear with figures of its flanks, which are within the bounds of their fields.

    A length replaces where the relief starts.
    """
    fields = type(gear).model_fields
    defaults = {field: fields[field].get_default() for field in _replaced_starts(figures)}
    return gear.model_copy(update=defaults | dict(figures))


def has_extent(gear: ToothingInput, relief: str) -> bool:
    """Whether a gear states where a relief starts, or how long it is."""
    return any(getattr(gear, field) for field in (f"{relief}_length_mm", *_start_fields(relief)))
