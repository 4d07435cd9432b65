"""How often a walk through the packages comes back: from a bearing force to dB(A), from a relief to curves.

A package is the first two parts of a module's name. A return is a pair of packages, caller and callee, where
the callee is entered although it waits further up the stack: whoever reads the walk goes forth and back. What
dataclasses generate does not count: there is nothing to read.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from types import FrameType

import pytest
import structure
from geared_scenes import gear_pair_scene, square_wave_table
from sounding_housings import part_of_scene
from sounding_scene import ON, SPEEDS, housing, radiation, response

from dynamics.noise import Radiation, SoundModel, SurfaceHousing, scene_sound, sound_band
from dynamics.noise.sound_band import USUAL_RANGES
from fe_contact import analyze
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.schemas.case import Case
from service.live.work import live_ste

Return = tuple[str, str]
GEAR = {"face_width_mm": 8.0, "bore_diameter_mm": 8.0}
CASE = {
    "pair": {
        "normal_module_mm": 1.0,
        "center_distance_mm": 18.5,
        "pinion": {"teeth": 17, **GEAR},
        "wheel": {"teeth": 20, **GEAR},
    },
    "load": {"torque_n_m": [2.0]},
}


def returns(work: Callable[[], object]) -> set[Return]:
    """Return the returns of a piece of work: caller and callee."""
    found: set[Return] = set()
    stack: list[tuple[str, FrameType]] = []

    def note(frame, event, _argument):
        if event == "call":
            package = _package(frame)
            if package is None:
                return
            waiting = {other for other, _ in stack}
            if stack and stack[-1][0] != package and package in waiting:
                found.add((stack[-1][0], package))
            stack.append((package, frame))
        elif event == "return" and stack and stack[-1][1] is frame:
            stack.pop()

    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
    return found


def _package(frame: FrameType) -> str | None:
    """Return the package of a function of the product; None of another one, and of generated code."""
    module = str(frame.f_globals.get("__name__", ""))
    if frame.f_code.co_filename.startswith("<") or structure.house_of(module) is None:
        return None
    return ".".join(module.split(".")[:2])


@pytest.mark.law
def test_from_a_bearing_force_to_decibels():
    surface = SurfaceHousing("case", housing(), tuple(seat.name for seat in housing().seats))
    force, part = response(), part_of_scene(housing())
    scene = replace(gear_pair_scene(square_wave_table(), effects=ON), housings=(part,))
    model = SoundModel(scene, {part.name: housing()}, {part.name: radiation()})

    def heard():
        scene_sound(force, [surface], Radiation(boundary_elements=False))
        sound_band(model, SPEEDS, 2, {"housing_damping": USUAL_RANGES["housing_damping"]}, cases=1)

    walk = {pair for pair in returns(heard) if "dynamics.noise" in pair or "dynamics.acoustics" in pair}
    # a task comes back from who divides it, a hull from who keeps it
    assert walk == {
        ("model_studies.workers", "dynamics.noise"),
        ("dynamics.identity_cache", "dynamics.noise"),
    }


@pytest.mark.law
def test_from_a_relief_to_its_curves(tmp_path):
    case = Case.model_validate_json(json.dumps(CASE))
    table = analyze(
        gear_pair(case),
        torques=[2.0],
        level="draft",
        positions=8,
        receipt="minimal",
        cache=tmp_path,
        model="plane_strain",
    )
    file = tmp_path / "table.nc"
    echoed = json.loads(json.dumps(case_json(case)))
    replace(table, metadata=replace(table.metadata, case=echoed)).to_netcdf(file)

    def asked(relief):
        pinion = {"tip_relief_um": relief, "tip_relief_length_mm": 0.3}
        question = {"torque_n_m": [2.0], "pinion": pinion}
        return live_ste({"file": str(file), "cache": str(tmp_path), "key": "table", "question": question})

    asked(5.0)  # the compliance is read once
    # a relief asks its gear for the radii of its ends
    assert returns(lambda: asked(7.0)) == {("fe_contact.flank", "fe_contact.geometry")}
