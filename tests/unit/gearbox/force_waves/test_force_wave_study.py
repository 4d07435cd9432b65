"""The study of force waves: file of inputs, bounds in its units, mesh orders beside those of the machine."""

import numpy as np
import pytest
from small_inputs import small_inputs

from dynamics.mechanism.passing import MESH, SHAFT, Excitation
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.studies.force_waves import EXAMPLE, Inputs
from lineofaction.gearbox.studies.force_waves.run import mesh_orders, waves_at

INPUTS = {name: value for name, value in small_inputs("force-waves").items() if name != "scene"}
STUDY = """force_wave_table = "motor.csv"
bore_radius_mm = 80.0
active_length_mm = 150.0
speed_rpm = 300.0
torque_n_m = 1.0
"""


def test_a_file_of_inputs_names_its_table(tmp_path):
    (tmp_path / "motor.csv").write_text(EXAMPLE, "utf-8")
    (tmp_path / "motor.toml").write_text(STUDY, "utf-8")
    inputs = read_model(Inputs, tmp_path / "motor.toml")
    assert inputs == Inputs(**INPUTS)
    (tmp_path / "inline.toml").write_text(STUDY.replace('"motor.csv"', f'"""{EXAMPLE}"""'), "utf-8")
    assert read_model(Inputs, tmp_path / "inline.toml") == inputs


def test_a_text_that_ends_like_the_name_of_a_file_is_a_text(tmp_path):
    text = f"{EXAMPLE}# from motor.csv"
    (tmp_path / "motor.toml").write_text(STUDY.replace('"motor.csv"', f'"""{text}"""'), "utf-8")
    assert read_model(Inputs, tmp_path / "motor.toml").force_wave_table == text


@pytest.mark.parametrize(
    ("content", "said"), [(None, "No such file"), (EXAMPLE.encode("utf-16"), "a text file in UTF-8")]
)
def test_a_named_table_that_cannot_be_read_is_refused_by_its_field(tmp_path, content, said):
    if content is not None:
        (tmp_path / "motor.csv").write_bytes(content)
    (tmp_path / "motor.toml").write_text(STUDY, "utf-8")
    with pytest.raises(BadInput, match=said) as caught:
        read_model(Inputs, tmp_path / "motor.toml")
    assert "force_wave_table" in caught.value.faults[0].field


def over(speeds=(500, 3000), torques=(-20, 40)):
    heading = EXAMPLE.partition("\n")[0]
    rows = [f"24,0,{speed},{torque},10,0,1,0" for speed in speeds for torque in torques]
    return INPUTS | {"force_wave_table": "\n".join((heading, *rows))}


@pytest.mark.parametrize(
    ("inputs", "field", "bound"),
    [
        ({"speed_rpm": 499.0}, "speed_rpm", "from 500 to 3000 rpm"),
        ({"speed_rpm": 3001.0}, "speed_rpm", "from 500 to 3000 rpm"),
        ({"speed_rpm": 500.0, "torque_n_m": -21.0}, "torque_n_m", "from -20 to 40 N m"),
    ],
)
def test_a_point_outside_the_table_is_refused_in_the_units_of_the_file(inputs, field, bound):
    with pytest.raises(BadInput) as caught:
        waves_at(Inputs(**(over() | inputs)))
    (fault,) = caught.value.faults
    assert (fault.field, fault.bound) == (field, f"{bound}, the {field.partition('_')[0]}s of the table")


@pytest.mark.parametrize("speed", [500.0, 3000.0])
def test_the_ends_of_the_table_belong_to_it(speed):
    for torque in (-20.0, 40.0):
        waves = waves_at(Inputs(**(over() | {"speed_rpm": speed, "torque_n_m": torque})))
        assert waves.frequency[0] == pytest.approx(24 * speed / 60.0)


def beside(temporal, rate, tolerance, harmonics=10):
    parts = (Excitation(SHAFT, "rotor", "", 1.0, 4), Excitation(MESH, "mesh", "", rate, harmonics))
    return [
        (line.temporal_order, line.harmonic) for line in mesh_orders(np.array(temporal), parts, tolerance)
    ]


def test_mesh_orders_fall_together_within_the_tolerance_alone():
    assert beside([0, 8, 48, 120], 20.0, 1e-9) == [(120, 6)]
    assert beside([49], 16.5, 0.0103) == [(49, 3)]  # 49.5 is 1.0204 % above
    assert beside([50], 16.5, 0.0099) == []  # 49.5 is 1 % below
    assert beside([50], 16.5, 0.0101) == [(50, 3)]
    assert beside([3], 20.0, 0.02) == []  # harmonic 3 of a shaft
    assert beside([300], 20.0, 0.02) == []  # harmonic 15 is beyond the compared ones
    assert beside([300], 20.0, 0.02, harmonics=15) == [(300, 15)]


def test_a_distance_has_the_sign_of_the_mesh_order_against_the_machine():
    parts = (Excitation(MESH, "mesh", "", 16.5, 10),)
    (above,), (below,) = (list(mesh_orders(np.array([k]), parts, 0.02)) for k in (49, 50))
    assert above.distance == pytest.approx(0.5 / 49.0) and below.distance == pytest.approx(-0.01)
    assert above.mesh_order == below.mesh_order == 49.5
