"""The unrolled flank: its axis across the face."""

from __future__ import annotations

from fe_contact.analysis import LoadDistribution
from lineofaction.report.drawing.figure import Axis


def face_axis(flanks: LoadDistribution) -> Axis:
    """Return the axis across the face."""
    low, high = (1e3 * end for end in flanks.scene.common_face)
    return Axis("face position, mm (0 = mid-face of the pinion; right: +z end)", limits=(low, high))
