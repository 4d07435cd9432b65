"""Recordings as WAV files of 32-bit floats that say what they hold and the value of full scale."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.io import wavfile

from bounds import at_least
from dynamics.acoustics.recording import Recording
from dynamics.checks import positive
from dynamics.errors import InputError, ResultError

COMMENT = ("quantity", "unit", "full_scale")


def common_full_scale(*recordings: Recording) -> float:
    """Return the largest magnitude of several recordings, for files that are compared by ear.

    Raises
    ------
    InputError
        Their units differ, or all are silent.
    """
    units = {recording.unit for recording in recordings}
    if len(units) != 1:
        raise InputError("unit", ", ".join(sorted(units)), "the same of all recordings")
    return positive("peak", max(recording.peak for recording in recordings), "All recordings are silent.")


def write_wav(path: Path | str, recording: Recording, full_scale: float) -> None:
    """Write a recording to a file; parameters and errors are those of `wav_file`."""
    Path(path).write_bytes(wav_file(recording, full_scale))


def wav_file(recording: Recording, full_scale: float) -> bytes:
    """Return the content of a WAV file whose sample 1.0 is `full_scale` in the recording's unit.

    Quantity, unit and full scale stand in the file as JSON (RIFF comment ICMT). Files of the same full scale
    play at their true relative level.

    Parameters
    ----------
    full_scale : float
        At least the recording's peak; `common_full_scale` of those to compare.

    Raises
    ------
    InputError
        The recording would be clipped.
    """
    positive("full_scale", full_scale)
    if full_scale < recording.peak:
        bound = at_least(recording.peak, note=f" {recording.unit}, the recording's peak")
        raise InputError("full_scale", full_scale, bound)
    sound = io.BytesIO()
    wavfile.write(sound, recording.sample_rate, (recording.samples / full_scale).astype(np.float32))
    words = (recording.quantity, recording.unit, full_scale)
    comment = json.dumps(dict(zip(COMMENT, words, strict=True))).encode("ascii")
    information = b"INFO" + _chunk(b"ICMT", comment + b"\0")
    body = sound.getvalue()[8:] + _chunk(b"LIST", information)
    return _chunk(b"RIFF", body)


def read_wav(path: Path | str) -> Recording:
    """Read a file of `write_wav`, in its unit.

    Raises
    ------
    ResultError
        The file is no such WAV.
    """
    data = Path(path).read_bytes()
    try:
        sample_rate, samples = wavfile.read(io.BytesIO(data))
        about = json.loads(_comment(data))
        quantity, unit, full_scale = (about[name] for name in COMMENT)
        return Recording(samples * float(full_scale), sample_rate, quantity, unit)
    except (ValueError, KeyError, TypeError, struct.error, InputError) as error:
        name = Path(path).name
        raise ResultError(f"{name} is no WAV file with quantity, unit and full scale") from error


def _chunk(name: bytes, content: bytes) -> bytes:
    return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)


def _comment(data: bytes) -> str:
    """Return the comment of a file, empty without one."""
    for name, content in _chunks(data[12:]):
        if name == b"LIST" and content[:4] == b"INFO":
            return dict(_chunks(content[4:])).get(b"ICMT", b"").rstrip(b"\0").decode("ascii")
    return ""


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield names and contents of the chunks in a row."""
    at = 0
    while at + 8 <= len(data):
        (length,) = struct.unpack("<I", data[at + 4 : at + 8])
        yield data[at : at + 4], data[at + 8 : at + 8 + length]
        at += 8 + length + length % 2
