"""The drawing of a pair: the answer to an outline."""

from __future__ import annotations

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.plan import Point


class OutlineBody(BaseModel):
    """Both gears at position 0, seen from +z, x to the right, and the main figures of the pair."""

    class GearOutline(BaseModel):
        """One tooth of a gear with half a space on either side, in mm, center at the origin, tooth on +y."""

        teeth: int
        tooth_mm: list[Point]
        radius_mm: dict[str, float] = Field(description="tip, root, base, reference, held")
        angle_deg: float = Field(description="Angle by which the outline is turned counter-clockwise")
        centre_mm: Point
        turn: float = Field(description="Sense of rotation, 1 counter-clockwise")
        face_mm: Point = Field(description="Ends of the face along z, from the pinion's mid-face")
        twist_deg_per_mm: float = Field(description="Counter-clockwise turn of the section along z, helix")

    class PathOfContact(BaseModel):
        """The usable path of contact."""

        points_mm: dict[str, Point] = Field(description="A to E")
        base_pitch_mm: float

    pinion: GearOutline
    wheel: GearOutline
    internal: bool
    path_of_contact: PathOfContact
    figures: dict[str, float] = Field(description="Contact ratios, working pressure angle ..., by name")
