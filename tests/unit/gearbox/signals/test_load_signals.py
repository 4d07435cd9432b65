"""Speeds and torques of a scene from recordings: the numbers that a hand would write, or a refusal."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import MDF, Signal, h5py, pyuff
from repository import EXAMPLES

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import SceneInput, read_model
from lineofaction.gearbox.schemas.files import READERS, SENT, written_out
from lineofaction.gearbox.schemas.named_files import in_folder

TIME = 3.0 + np.arange(2001) / 1000.0
SPEED = 100.0 + 40.0 * (TIME - 3.0)  # rad/s
TORQUE = 80.0 - 5.0 * (TIME - 3.0)
RPM = np.pi / 30.0


def _csv(file: Path) -> Path:
    columns = np.stack([TIME, SPEED / RPM, TORQUE], axis=1)
    np.savetxt(file, columns, delimiter=",", header="time_s,speed_rpm,torque_n_m", comments="")
    return file


def _mf4(file: Path) -> Path:
    with MDF(version="4.10") as content:
        content.append([Signal(SPEED / (2 * np.pi), TIME, name="speed", unit="Hz")])
        content.append([Signal(TORQUE / 1e3, TIME, name="torque", unit="kNm")])
        content.save(file, overwrite=True)
    return file


def _h5(file: Path) -> Path:
    with h5py.File(file, "w") as content:
        content["time_s"] = TIME
        content["speed"], content["torque_n_m"] = SPEED, TORQUE
        content["speed"].attrs["unit"] = "rad/s"
    return file


def _uff(file: Path) -> Path:
    blank = {name: value or 0 for name, value in pyuff.prepare_58(return_full_dict=True).items()}
    texts = {name: "NONE" for name in blank if name.endswith(("_lab", "_name")) or name.startswith("id")}
    step = {"abscissa_spacing": 1, "abscissa_min": 3.0, "abscissa_inc": 1e-3, "num_pts": TIME.size, "x": TIME}
    sets = [
        blank | texts | step | {"type": 58, "binary": 0, "id1": name, "data": values}
        | {"abscissa_spec_data_type": 17, "ordinate_spec_data_type": kind, "ordinate_axis_units_lab": unit}
        for name, values, kind, unit in (("speed", SPEED / RPM, 19, "rpm"), ("torque", TORQUE, 9, "N m"))
    ]  # fmt: skip
    pyuff.UFF(str(file)).write_sets(sets, mode="overwrite")
    return file


FORMS = {"csv": _csv, "mf4": _mf4, "h5": _h5, "uff": _uff}


def _scene(drive: dict[str, Any], load: dict[str, Any] | None = None) -> dict[str, Any]:
    return {
        "drives": [{"name": "motor", "shaft": "input", **drive}],
        "loads": [{"name": "brake", "shaft": "output", **(load or {"torque_n_m": [1.0]})}],
    }


@pytest.mark.parametrize("form", FORMS)
def test_a_recording_is_what_a_hand_would_write(form, tmp_path):
    name = FORMS[form](tmp_path / f"drive.{form}").name
    signal = {"file": name, "start_s": 3.5, "end_s": 4.5}
    scene = written_out(
        _scene({"signal": signal}, {"signal": signal | {"scale": -1.0}}), in_folder(tmp_path), READERS
    )
    drive, load = scene["drives"][0], scene["loads"][0]
    assert set(drive) == {"name", "shaft", "time_s", "speed_rpm"}
    assert drive["time_s"][0] == 0.0 and drive["time_s"][-1] == pytest.approx(1.0)
    np.testing.assert_allclose(
        drive["speed_rpm"], (120.0 + 40.0 * np.array(drive["time_s"])) / RPM, rtol=1e-6
    )
    np.testing.assert_allclose(load["torque_n_m"], -(77.5 - 5.0 * np.array(load["time_s"])), rtol=1e-6)


def test_means_keep_the_turns_and_take_the_noise(tmp_path):
    _csv(tmp_path / "a.csv")
    noisy = SPEED + np.random.default_rng(4).standard_normal(TIME.size)
    columns = np.stack([TIME, noisy / RPM], axis=1)
    np.savetxt(tmp_path / "n.csv", columns, delimiter=",", header="time_s,speed_rpm", comments="")
    signal = {"file": "n.csv", "average_s": 0.05}
    drive = written_out(_scene({"signal": signal}), in_folder(tmp_path), READERS)["drives"][0]
    time, speed = np.array(drive["time_s"]), np.array(drive["speed_rpm"]) * RPM
    np.testing.assert_allclose(time, 0.025 + 0.05 * np.arange(40), atol=1e-9)
    assert np.sum(speed) * 0.05 == pytest.approx(np.trapezoid(noisy, TIME), rel=1e-9)
    assert np.std(speed - (100.0 + 40.0 * time)) < 0.3  # 1 / sqrt(50) = 0.14


@pytest.mark.parametrize(
    ("drive", "field", "bound"),
    [
        (
            {"signal": {"file": "a.csv"}, "speed_rpm": [1.0]},
            r"drives\[0\]\.speed_rpm",
            "left out beside signal",
        ),
        ({"signal": {"file": "a.csv", "unit": "N m"}}, "unit of", "a unit of speed"),
        ({"signal": {"file": "a.csv", "channel": "speed"}}, r"signal\.channel", "one channel of that name"),
        ({"signal": {"file": "b.csv"}}, r"signal\.file", "Check the path"),
        ({"signal": {"file": "../a.exe"}}, r"signal\.file", "ends in"),
        ({"signal": {"file": "a.csv", "start_s": 4.0, "end_s": 9.0}}, r"signal\.start_s", "3 to 5 s"),
        ({"signal": {"file": "a.csv", "average_s": 1e-5}}, r"signal\.average_s", "half the stretch"),
        ({"signal": {"file": "a.csv", "average_s": "0.1"}}, r"signal\.average_s", "number"),
        ({"signal": {"path": "a.csv"}}, r"signal\.", "file|path"),
        ({"signal": "a.csv"}, "signal", "must be"),
    ],
)
def test_what_a_scene_may_not_name_is_refused(drive, field, bound, tmp_path):
    _csv(tmp_path / "a.csv")
    with pytest.raises(BadInput, match=rf"(?s){field}.*({bound})"):
        written_out(_scene(drive), in_folder(tmp_path), READERS)


def test_more_samples_than_a_course_holds_are_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as content:
        content["speed_rpm"] = np.full(100_001, 900.0)
        content.attrs["sample_rate_hz"] = 51_200.0
    with pytest.raises(BadInput, match=r"at most 100000 samples\. Give average_s"):
        written_out(_scene({"signal": {"file": "a.h5"}}), in_folder(tmp_path), READERS)


def test_a_scene_file_is_driven_by_a_recording(tmp_path):
    text = (EXAMPLES / "palermo_scene.toml").read_text("utf-8")
    for name in EXAMPLES.glob("palermo*"):
        (tmp_path / name.name).write_bytes(name.read_bytes())
    _csv(tmp_path / "a.csv")
    stated, count = re.subn(
        r"(?s)time_s = \[0\.0, 5\.0\]\nspeed_rpm = \[.*?\]", 'signal = {file = "a.csv"}', text
    )
    assert count == 1
    (tmp_path / "scene.toml").write_text(stated, "utf-8")
    (drive,) = read_model(SceneInput, tmp_path / "scene.toml").drives
    assert drive.speed_rpm is not None and len(drive.time_s) == TIME.size
    np.testing.assert_allclose(np.array(drive.speed_rpm) * RPM, SPEED, rtol=1e-12)
    (tmp_path / "scene.toml").write_text(stated.replace("a.csv", "b.csv"), "utf-8")
    with pytest.raises(BadInput, match=r"signal\.file.*scene\.toml:\d+"):
        read_model(SceneInput, tmp_path / "scene.toml")


def test_a_service_opens_no_recordings(tmp_path):
    _csv(tmp_path / "a.csv")
    with pytest.raises(BadInput, match=r"drives\[0\]\.signal.*a service opens no recordings"):
        written_out(_scene({"signal": {"file": "a.csv"}}), in_folder(tmp_path), SENT)
