"""A small scene as a file, for the tests of the verbs on scenes: two equal gears on one bushing each."""

from pathlib import Path

from small_table import small_table

SCENE = """
[run]
duration_s = {duration}
[effects]
flexible_shafts = "off"
[[shafts]]
name = "input"
length_mm = 100.0
diameter_mm = 40.0
[[shafts]]
name = "output"
length_mm = 100.0
diameter_mm = 40.0
origin_mm = [80.0, 0.0, 0.0]
[[gears]]
name = "pinion"
shaft = "input"
position_mm = 50.0
bore_diameter_mm = 40.0
[[gears]]
name = "wheel"
shaft = "output"
position_mm = 50.0
bore_diameter_mm = 40.0
[[bushings]]
name = "left"
shaft = "input"
position_mm = 50.0
radial_stiffness_n_per_m = 2e8
[[bushings]]
name = "right"
shaft = "output"
position_mm = 50.0
radial_stiffness_n_per_m = 2e8
[[meshes]]
name = "mesh"
driver = "pinion"
driven = "wheel"
database_file = "ste.nc"
damping_ratio = 0.08
[[drives]]
name = "motor"
shaft = "input"
speed_rpm = [{speed}]
[[loads]]
name = "brake"
shaft = "output"
torque_n_m = [100.0]
[outputs]
sample_rate_hz = {rate}
"""


def scene_file(folder: Path, *, duration: float = 0.01, speed: float = 900.0, rate: float = 20e3) -> Path:
    """Write the scene and its table into `folder`; return the scene's path."""
    small_table().to_netcdf(folder / "ste.nc")
    path = folder / "scene.toml"
    path.write_text(SCENE.format(duration=duration, speed=speed, rate=rate), encoding="utf-8")
    return path
