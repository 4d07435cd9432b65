"""WAV files as other programs read them: samples, and quantity, unit and full scale in the RIFF comment."""

import io
import json
import struct
from collections.abc import Iterator
from pathlib import Path

from scipy.io import wavfile

from dynamics.acoustics import Recording
from dynamics.acoustics.recording import COMMENT
from dynamics.errors import InputError, ResultError


def read_wav(path: Path | str) -> Recording:
    """Read a file of `write_wav`, in its unit; `ResultError`: the file is no such WAV."""
    data = Path(path).read_bytes()
    try:
        sample_rate, samples = wavfile.read(io.BytesIO(data))
        about = json.loads(_comment(data))
        quantity, unit, full_scale = (about[name] for name in COMMENT)
        return Recording(samples * float(full_scale), sample_rate, quantity, unit)
    except (ValueError, KeyError, TypeError, struct.error, InputError) as error:
        name = Path(path).name
        raise ResultError(f"{name} is no WAV file with quantity, unit and full scale") from error


def _comment(data: bytes) -> str:
    for name, content in _chunks(data[12:]):
        if name == b"LIST" and content[:4] == b"INFO":
            return dict(_chunks(content[4:])).get(b"ICMT", b"").rstrip(b"\0").decode("ascii")
    return ""


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    at = 0
    while at + 8 <= len(data):
        (length,) = struct.unpack("<I", data[at + 4 : at + 8])
        yield data[at : at + 4], data[at + 8 : at + 8 + length]
        at += 8 + length + length % 2
