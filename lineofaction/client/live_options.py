"""What a live question may ask beside the torques."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict


class LiveOptions(TypedDict, total=False):
    """Options of `ste`, in the words of a case file; what is left out is as in the case.

    Attributes
    ----------
    misalignment_um, center_distance_change_mm : float
        Default: 0.
    pinion, wheel : mapping
        Flank modifications of a gear (``tip_relief_um`` ...).
    derivatives : bool
        Also return the derivatives of each curve by its flanks, the misalignment and the torque.
    flanks : bool
        Also return pressure over the driving gear's flank, load over the face, K_Hbeta.
    condense : bool
        Compute the compliance first if the service has none in its cache.
    caller : str, optional
        Name of the caller: a later request replaces its waiting one (`Superseded`).
    """

    misalignment_um: float
    center_distance_change_mm: float
    pinion: Mapping[str, Any]
    wheel: Mapping[str, Any]
    derivatives: bool
    flanks: bool
    condense: bool
    caller: str | None
