"""Recordings as other programs write them: two channels, an acceleration and a speed, in every format."""

import warnings
import wave
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from scipy.io import savemat

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pyuff
    from asammdf import MDF, Signal

FULL_SCALE = 400.0
"""m/s^2 at which the WAV file clips."""
_STEPS = 1 << 23  # of 24 bits


def universal(file: Path, time: Any, acceleration: Any, rpm: Any, direction: int = 2) -> Path:
    """Text, dataset 58, units by the labels of the axes."""
    blank = {name: value or 0 for name, value in pyuff.prepare_58(return_full_dict=True).items()}
    texts = {name: "NONE" for name in blank if name.endswith(("_lab", "_name")) or name.startswith("id")}
    sets = [
        {
            **blank, **texts, "type": 58, "binary": 0, "id1": name, "func_type": 1, "rsp_dir": turned,
            "rsp_node": 1, "data": values, "x": time, "num_pts": len(time), "abscissa_spacing": 1,
            "abscissa_min": float(time[0]), "abscissa_inc": float(time[1] - time[0]),
            "abscissa_spec_data_type": 17, "abscissa_axis_lab": "Time",
            "ordinate_spec_data_type": kind, "ordinate_axis_units_lab": unit,
        }
        for name, values, kind, unit, turned in (
            ("acceleration", acceleration, 12, "m/s^2", direction),
            ("speed", rpm, 19, "rpm", 0),
        )
    ]  # fmt: skip
    pyuff.UFF(str(file)).write_sets(sets, mode="overwrite")
    return file


def wav(file: Path, time: Any, acceleration: Any, rpm: Any) -> Path:
    """24 bits by the standard library; the second channel is a tacho of `PULSES` a turn."""
    turns = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (rpm[1:] + rpm[:-1]) / 60.0)])
    tacho = 0.5 * np.sin(2.0 * np.pi * PULSES * turns)
    words = np.round(np.stack([acceleration / FULL_SCALE, tacho], axis=1) * _STEPS).astype("<i4")
    with wave.open(str(file), "wb") as stream:
        stream.setnchannels(2)
        stream.setsampwidth(3)
        stream.setframerate(round(1.0 / (time[1] - time[0])))
        stream.writeframes(words.view(np.uint8).reshape(-1, 4)[:, :3].tobytes())
    return file


PULSES = 30


def matlab(file: Path, time: Any, acceleration: Any, rpm: Any) -> Path:
    savemat(file, {"time_s": time, "acceleration_m_per_s2": acceleration, "speed_rpm": rpm, "note": "run 3"})
    return file


def hdf5(file: Path, time: Any, acceleration: Any, rpm: Any) -> Path:
    with h5py.File(file, "w") as content:
        content["test/time_s"] = time
        content["test/case"] = acceleration / 9.80665
        content["test/case"].attrs["unit"] = "g"
        content["test/speed_rpm"] = rpm
    return file


def mdf(file: Path, time: Any, acceleration: Any, rpm: Any) -> Path:
    with MDF(version="4.10") as content:
        content.append([Signal(acceleration, time, name="case", unit="m/s²")])
        content.append([Signal(rpm[::8], time[::8], name="speed", unit="1/min")])  # a slower group
        content.save(file, overwrite=True, compression=2)
    return file


def table(file: Path, time: Any, acceleration: Any, rpm: Any) -> Path:
    heading = "time_s,acceleration_m_per_s2,speed_rpm"
    np.savetxt(file, np.stack([time, acceleration, rpm], axis=1), delimiter=",", header=heading, comments="")
    return file


WRITERS: dict[str, Callable[..., Path]] = {
    "uff": universal,
    "wav": wav,
    "mat": matlab,
    "h5": hdf5,
    "mf4": mdf,
    "csv": table,
}
