"""Universal files with frequency responses, as other programs write them by pyuff."""

import gc
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pyuff

KINDS = {"displacement": (8, "m"), "velocity": (11, "m/s"), "acceleration": (12, "m/s^2")}
UNITS = {
    "type": 164, "units_code": 9, "units_description": "own", "temp_mode": 1,
    "length": 1.0, "force": 1.0, "temp": 1.0, "temp_offset": 0.0,
}  # fmt: skip


def function(
    hertz: Any,
    values: Any,
    ends: tuple[int, int, int, int] = (11, 1, 1, 1),
    kind: str = "acceleration",
    **changed: Any,
) -> dict[str, Any]:
    """Return a dataset 58: `ends` are response node and direction, reference node and direction."""
    blank = {name: value or 0 for name, value in pyuff.prepare_58(return_full_dict=True).items()}
    texts = {name: "NONE" for name in blank if name.endswith(("_lab", "_name")) or name.startswith("id")}
    number, unit = KINDS[kind]
    return {
        **blank, **texts, "type": 58, "binary": 0, "func_type": 4, "data": np.asarray(values, dtype=complex),
        **dict(zip(("rsp_node", "rsp_dir", "ref_node", "ref_dir"), ends, strict=True)),
        "x": np.asarray(hertz, dtype=float), "num_pts": len(hertz), "abscissa_spacing": 0,
        "abscissa_spec_data_type": 18, "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": number, "ordinate_axis_units_lab": unit,
        "orddenom_spec_data_type": 13, "orddenom_axis_units_lab": "N", **changed,
    }  # fmt: skip


def universal_file(file: Path, sets: Iterable[dict[str, Any]]) -> Path:
    """Write datasets; pyuff loses binary ones where it overwrites, and writes 0 in place of NaN."""
    file.write_text("")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # of its open files
        pyuff.UFF(str(file)).write_sets(list(sets), mode="add")
        gc.collect()
    return file
