"""Loading, and at the first use compiling, what a measured run shall not pay for."""

from __future__ import annotations

from functools import lru_cache

from fe_contact.analysis.analyze import analyze
from fe_contact.geometry import Gear, GearPair


@lru_cache(maxsize=2)
def warm_up(*, across_face: bool) -> None:
    """Analyze a narrow pair once per process, in the plane and, if requested, over the face."""
    gear = Gear(teeth=20, normal_module=1e-3, face_width=2e-3, bore_diameter=10e-3)
    pair = GearPair(gear, gear, center_distance=20e-3)
    for model in ("auto", "3d") if across_face else ("auto",):
        analyze(pair, normal_forces=[10.0], level="draft", model=model, positions=8)
