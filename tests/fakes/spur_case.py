"""The spur pair of the verbs' tests as a case file writes it."""

import json
from collections.abc import Sequence


def spur_case(pinion: str = "", wheel: str = "", torques: Sequence[float] = (), **accuracy: object) -> str:
    """Return the text of a case with lines of its gears; with loads at a draft, if not stated."""
    stated = "\n".join(
        f"{name} = {json.dumps(value)}" for name, value in ({"level": "draft"} | accuracy).items()
    )
    loads = f"[load]\ntorque_n_m = {list(torques)}\n[accuracy]\n{stated}\n" if torques else ""
    return f"""
[pair]
normal_module_mm = 4.0
center_distance_mm = 80.0
[pair.pinion]
teeth = 20
face_width_mm = 25.0
bore_diameter_mm = 40.0
{pinion}
[pair.wheel]
teeth = 20
face_width_mm = 25.0
bore_diameter_mm = 40.0
{wheel}
{loads}"""
