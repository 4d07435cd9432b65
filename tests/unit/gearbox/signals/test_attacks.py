"""Recordings that lie, point elsewhere, or swell: each is refused in a sentence that names the file."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from foreign_netcdf import SECRET, write_canary
from recordings import WRITERS
from scipy.io import savemat

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals import recording as recordings
from lineofaction.gearbox.signals.recording import read_recording

TIME = np.arange(256) / 1024.0
VALUES = np.sin(40.0 * TIME)
Attack = Callable[[Path], Path]


def _text(name: str, text: str) -> Attack:
    def write(folder):
        file = folder / name
        file.write_text(text)
        return file

    return write


def _h5(change: Callable[[Any, Path], None]) -> Attack:
    def write(folder):
        file = folder / "a.h5"
        with h5py.File(file, "w") as content:
            content["time_s"] = TIME
            content["case_g"] = VALUES
            change(content, folder)
        return file

    return write


def _link(content: Any, folder: Path) -> None:
    content["further"] = h5py.ExternalLink(str(write_canary(folder).with_suffix(".h5")), "values")


def _external(content: Any, folder: Path) -> None:
    content.create_dataset("far_g", (256,), "f8", external=[(str(write_canary(folder)), 0, 2048)])


def _virtual(content: Any, folder: Path) -> None:
    layout = h5py.VirtualLayout((256,), "f8")
    layout[:] = h5py.VirtualSource(str(write_canary(folder).with_suffix(".h5")), "values", shape=(256,))
    content.create_virtual_dataset("far_g", layout)


def _own_group(content: Any, _folder: Path) -> None:
    content["inner/again"] = content["/"]  # a hard link to what holds it


def _huge(content: Any, _folder: Path) -> None:
    content.create_dataset("far_g", (1 << 40,), "f8", chunks=(1 << 16,), compression="gzip")


def _packed_twice(content: Any, _folder: Path) -> None:
    made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    made.set_chunk((256,))
    made.set_deflate(9)
    made.set_deflate(9)
    space = h5py.h5s.create_simple((256,))
    h5py.h5d.create(content.id, b"far_g", h5py.h5t.IEEE_F64LE, space, made)


def _many(content: Any, _folder: Path) -> None:
    for index in range(5000):
        content[f"channel_{index}_g"] = VALUES[:4]


def _without_time(content: Any, _folder: Path) -> None:
    content["other/case_g"] = VALUES


def _wav_of_more_than_it_has(folder: Path) -> Path:
    file = WRITERS["wav"](folder / "a.wav", TIME, VALUES, 900.0 + 0.0 * TIME)
    content = bytearray(file.read_bytes())
    content[40:44] = struct.pack("<I", 0x7FFF_FFF0)
    file.write_bytes(bytes(content))
    return file


def _wav_without_samples(folder: Path) -> Path:
    file = WRITERS["wav"](folder / "a.wav", TIME, VALUES, 900.0 + 0.0 * TIME)
    file.write_bytes(file.read_bytes()[:36] + b"data" + struct.pack("<I", 0))
    return file


def _uff_of_more_than_it_has(folder: Path) -> Path:
    file = WRITERS["uff"](folder / "a.uff", TIME, VALUES, 900.0 + 0.0 * TIME)
    file.write_text(file.read_text().replace(f"{256:10d}", f"{2_000_000_000:10d}"))
    return file


def _uff_of_words(folder: Path) -> Path:
    file = WRITERS["uff"](folder / "a.uff", TIME, VALUES, 900.0 + 0.0 * TIME)
    lines = file.read_text().splitlines()
    lines[14] = lines[14].replace("e", "x")
    file.write_text("\n".join(lines))
    return file


def _mat_in_itself(folder: Path) -> Path:
    """A compressed element inside a compressed element, ten times; a thousand times the size of the file."""
    inner = struct.pack("<II", 14, 1 << 30) + bytes(1 << 20)
    for _ in range(10):
        packed = zlib.compress(inner)
        inner = struct.pack("<II", 15, len(packed)) + packed
    head = b"MATLAB 5.0 MAT-file".ljust(116) + bytes(8) + struct.pack("<H", 0x0100) + b"IM"
    file = folder / "a.mat"
    file.write_bytes(head + inner)
    return file


def _mat_bomb(folder: Path) -> Path:
    file = folder / "a.mat"
    savemat(file, {"case_g": np.zeros((1, 60_000_000))}, do_compression=True)
    return file


def _mat_of_objects(folder: Path) -> Path:
    file = folder / "a.mat"
    rows = np.array([["a", 1], [b"cos\nsystem\n(S'touch pwned'\ntR.", 2]], dtype=object)
    savemat(file, {"case_g": rows, "time_s": {"nested": [1.0, 2.0]}})
    return file


def _mdf_cut(folder: Path) -> Path:
    file = WRITERS["mf4"](folder / "a.mf4", TIME, VALUES, 900.0 + 0.0 * TIME)
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    return file


def _mdf_of_more_than_it_has(folder: Path) -> Path:
    """Every count of the channel groups (cycles) is a billion."""
    file = WRITERS["mf4"](folder / "a.mf4", TIME, VALUES, 900.0 + 0.0 * TIME)
    content = file.read_bytes().replace(struct.pack("<Q", 256), struct.pack("<Q", 1 << 30))
    file.write_bytes(content)
    return file


def _mdf_of_nothing(folder: Path) -> Path:
    file = folder / "a.mf4"
    file.write_bytes(b"MDF     4.10    " + bytes(200))
    return file


ATTACKS: dict[str, tuple[Attack, str]] = {
    "words for numbers": (_text("a.csv", "time_s,case_g\n0,1\n1,ten\n"), "numbers alone"),
    "markup for numbers": (_text("a.csv", "time_s,case_g\n0,<script>alert(1)</script>\n"), "numbers alone"),
    "ragged rows": (_text("a.csv", "time_s,case_g\n0,1,5\n1,2,5\n"), "2 values in each row"),
    "one name twice": (_text("a.csv", "time_s,case_g,case_g\n0,1,2\n"), "each name once"),
    "no time": (_text("a.csv", "case_g,b\n0,1\n"), "first column is time_s"),
    "bytes for text": (lambda folder: _bytes(folder / "a.csv"), "UTF-8"),
    "link out of the file": (_h5(_link), "links"),
    "values in another file": (_h5(_external), "lie in other files"),
    "virtual dataset": (_h5(_virtual), "lie in other files"),
    "group in itself": (_h5(_own_group), "groups inside each other"),
    "terabytes of nothing": (_h5(_huge), "samples"),
    "packed twice": (_h5(_packed_twice), "packed in another way"),
    "thousands of channels": (_h5(_many), "4096 entries|1024 channels"),
    "vectors without times": (_h5(_without_time), "a time for each sample"),
    "WAV longer than its file": (_wav_of_more_than_it_has, "can be read|memory"),
    "WAV of nothing": (_wav_without_samples, "samples and a sample rate|can be read"),
    "UFF longer than its file": (_uff_of_more_than_it_has, "as many values as they say"),
    "UFF of words": (_uff_of_words, "can be read|as many values"),
    "MAT in itself": (_mat_in_itself, "can be read|memory"),
    "MAT bomb": (_mat_bomb, "at most 1024 channels and 20000000 samples|a time for each|memory"),
    "MDF cut": (_mdf_cut, "can be read"),
    "MDF longer than its file": (_mdf_of_more_than_it_has, "samples|can be read|memory"),
    "MDF of nothing": (_mdf_of_nothing, "can be read|no channels"),
    "no file": (lambda folder: folder / "none.mf4", "Check the path"),
    "another kind": (_text("a.exe", "MZ"), "ends in"),
}


def _bytes(file: Path) -> Path:
    file.write_bytes(b"time_s,case_g\n\xff\xfe\x00\n")
    return file


@pytest.mark.parametrize("attack", ATTACKS)
def test_what_lies_points_elsewhere_or_swells_is_refused(attack, tmp_path):
    write, bound = ATTACKS[attack]
    file = write(tmp_path)
    with pytest.raises(BadInput, match=bound) as caught:
        recording = read_recording(file, "measured")
        recording.channel("measured", "", ("acceleration",)).series("measured")
    message = str(caught.value)
    assert file.name in message or "a.mf4" in message
    assert SECRET.decode() not in message and len(message) < 1200
    assert not (tmp_path / "pwned").exists()


def test_objects_of_a_mat_file_are_no_channels(tmp_path):
    """What pickles and structures hold is neither run nor read."""
    assert read_recording(_mat_of_objects(tmp_path), "measured").channels == ()
    assert not (tmp_path / "pwned").exists() and not Path("pwned").exists()


@pytest.mark.parametrize(
    ("time", "values", "bound"),
    [
        (TIME, np.where(TIME > 0.1, np.nan, VALUES), "finite real numbers"),
        (TIME, np.where(TIME > 0.1, np.inf, VALUES), "finite real numbers"),
        (np.where(TIME > 0.1, TIME - 0.05, TIME), VALUES, "whose time rises; at sample"),
        (np.round(TIME, 2), VALUES, "whose time rises; at sample"),
        (TIME[:1], VALUES[:1], "at least two samples"),
    ],
)
def test_samples_that_are_no_series_are_refused(time, values, bound, tmp_path):
    file = WRITERS["csv"](tmp_path / "a.csv", time, values, 900.0 + 0.0 * time)
    channel = read_recording(file, "measured").channel("measured", "acceleration_m_per_s2")
    with pytest.raises(BadInput, match=bound):
        channel.series("measured")


def test_names_with_controls_and_markup_come_as_one_printable_line(tmp_path):
    name = "<b>\x1b[31mcase\r\n[red]" + "x" * 500 + "_g"
    with h5py.File(tmp_path / "a.h5", "w") as content:
        content["time_s"] = TIME
        content.create_dataset(name.encode(), data=VALUES)
    (channel,) = read_recording(tmp_path / "a.h5", "measured").channels
    assert channel.name.isprintable() and len(channel.name) <= 80
    assert channel.name.startswith("<b> [31mcase")


def test_a_reader_that_takes_too_long_is_ended(tmp_path, monkeypatch):
    monkeypatch.setattr(recordings, "SECONDS", 0.05)
    file = WRITERS["csv"](tmp_path / "a.csv", TIME, VALUES, 900.0 + 0.0 * TIME)
    with pytest.raises(BadInput, match=r"is read within .* no answer within"):
        read_recording(file, "measured")


def test_a_missing_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(recordings, "find_spec", lambda _module: None)
    with pytest.raises(BadInput, match=r"pip install 'lineofaction\[mdf\]'"):
        read_recording(tmp_path / "a.mf4", "measured")
