"""An effect of the dynamics is two product files, a bearing law is three: everything else follows."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import structure
from repository import ROOT

COPIED = ("dynamics", "lineofaction")
EFFECT = '''"""An effect of rotors that is made up: it is on wherever a rotor has gears."""

from dynamics.effects.effect import RotorEffect, Verdict


class Settling(RotorEffect):
    """Nothing that moves."""

    name = "settling"
    cost = "nothing"

    def called_for(self, rotor):
        """Call for it."""
        return Verdict(False, True, "nobody asks for it", 0.0)
'''
LAW = '''"""A bearing law that is made up: a spring along the axis."""

from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from dynamics.bearings.bearing_law import SceneBearingLaw
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray


class AxialSpringLaws(NamedTuple):
    stiffness: FloatArray

    @classmethod
    def packed(cls, laws):
        return cls(np.array([law.stiffness for law in laws], dtype=float))


@dataclass(frozen=True)
class AxialSpring(SceneBearingLaw):
    bushing: str
    stiffness: float
    arrays: ClassVar[type] = AxialSpringLaws

    @property
    def acts_at(self):
        return self.bushing

    def rows(self, duty):
        return np.eye(5)[[2]]

    def array_entry(self, duty):
        return self

    def row_stiffness(self, duty):
        return np.array([self.stiffness])

    def tangent_error(self, duty):
        return 0.0

    def scaled(self, factor):
        return replace(self, stiffness=factor * self.stiffness)

    @property
    def holds_axially(self):
        return True


@routine
def axial_spring(laws: AxialSpringLaws, entry: int, local: LocalState, row: int) -> None:
    local.force[row] = local.elastic[row] = laws.stiffness[entry] * local.coordinate[row]
    local.tangent[row, 0] = laws.stiffness[entry]


@routine
def axial_spring_energy(laws: AxialSpringLaws, entry: int, local: LocalState, row: int) -> float:
    return 0.5 * laws.stiffness[entry] * local.coordinate[row] ** 2
'''
LAW_ROWS = {
    "from dynamics.bearings.ball_elements": """\
from dynamics.bearings.axial_spring import AxialSpring, AxialSpringLaws, axial_spring, axial_spring_energy
PLACE""",
    "  # p = 1 to 5: a linear bearing in a housing that moves\n": "PLACE    AXIAL_SPRING = 12\n",
    "    linear_bearing: LinearBearingLaws\n": "PLACE    axial_spring: AxialSpringLaws\n",
    "    Law.LINEAR_BEARING: Compiled(": """\
    Law.AXIAL_SPRING: Compiled(axial_spring, axial_spring_energy),
PLACE""",
    "    spring_curves: tuple[SpringCurve, ...] = ()\n": """\
PLACE    axial_springs: tuple[AxialSpring, ...] = ()
""",
    "    SpringCurveLaws: Law.SPRING_CURVE,\n": "PLACE    AxialSpringLaws: Law.AXIAL_SPRING,\n",
}
"""Rows of dynamics/forces/laws.py, each by the text beside which it stands, PLACE."""
TABLE_ROWS = {
    "    class SpringCurveInput(BearingLawInput):\n": """\
    class AxialSpringInput(BearingLawInput):
        stiffness_n_per_m: float = Field(gt=0.0)

PLACE""",
    "    spring_curves: Listed[SpringCurveInput] = Field(\n": """\
    axial_spring: AxialSpringInput | None = Field(default=None)
PLACE""",
    '        return {"rolling_contacts": contact, ': """\
        spring = {} if self.axial_spring is None else {"axial_spring": self.axial_spring}
        return {"axial_springs": spring, "rolling_contacts": contact, """,
}
"""Rows of the schema of bearings, in the same way."""
SCENE = """
import json, sys, tomllib
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from changed_scenes import changed, changed_scene
from dynamics.assembly.model import decide_model
from dynamics.effects import EFFECTS
example = tomllib.loads(Path(sys.argv[2]).read_text("utf-8"))
"""
EFFECT_FOUND = """
scene = changed_scene(example, {"effects.settling": "on"})
entries = decide_model(scene, EFFECTS).ledger.of("settling")
print(json.dumps([[entry.part, entry.on] for entry in entries]))
"""
LAW_FOUND = """
import numpy as np
from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
law = {"bushings[0].axial_spring": {"stiffness_n_per_m": 2e7}, "bushings[0].axial_stiffness_n_per_m": 0.0}
pull = {"forces[0]": {"name": "pull", "shaft": "input", "position_mm": 100.0, "force_n": [0.0, 0.0, 300.0]}}
plain = {"bushings[0].axial_stiffness_n_per_m": 2e7}
base = {"forces": [], "effects.axial": "on", "effects.lateral": "on"}
systems = [assemble(changed_scene(example, base | way | pull)) for way in (law, plain)]
rest = [static_equilibrium(system).displacement for system in systems]
print(json.dumps({
    "laws": len(systems[0].bearings), "plain": len(systems[1].bearings),
    "rest": [float(np.max(np.abs(q))) for q in rest], "apart": float(np.max(np.abs(rest[0] - rest[1]))),
}))
"""


def _tree(folder: Path) -> Path:
    """Return a tree whose dynamics and gearbox can be changed."""
    for name in {house.partition(".")[0] for house in structure.HOUSES} - set(COPIED):
        (folder / name).symlink_to(ROOT / name)
    for name in COPIED:
        shutil.copytree(ROOT / name, folder / name)
    return folder


def _with_rows(file: Path, rows: dict[str, str]) -> None:
    code = file.read_text("utf-8")
    for place, row in rows.items():
        assert code.count(place) == 1, place
        code = code.replace(place, row.replace("PLACE", place))
    file.write_text(code, "utf-8")


def _found(tree: Path, code: str) -> object:
    scene = ROOT / "examples/palermo_scene.toml"
    done = subprocess.run(
        [sys.executable, "-P", "-c", SCENE + code, str(ROOT / "tests/fakes"), str(scene)],
        cwd=tree, capture_output=True, text=True, check=False, timeout=600,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(tree), "HOME": str(tree)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_an_effect_is_its_file_and_a_row(tmp_path):
    tree = _tree(tmp_path)
    (tree / "dynamics/effects/settling.py").write_text(EFFECT, "utf-8")
    rows = {
        "from dynamics.effects.tilt": "from dynamics.effects.settling import Settling\nPLACE",
        "    Lateral(),\n": "PLACE    Settling(),\n",
    }
    _with_rows(tree / "dynamics/effects/registry.py", rows)
    assert _found(tree, EFFECT_FOUND) == [["input", True], ["output", True]]


@pytest.mark.nightly
def test_a_bearing_law_is_its_file_its_rows_and_its_table(tmp_path):
    """A shaft under a force along its axis rests on the law as on a linear bearing of that stiffness."""
    tree = _tree(tmp_path)
    (tree / "dynamics/bearings/axial_spring.py").write_text(LAW, "utf-8")
    _with_rows(tree / "dynamics/forces/laws.py", LAW_ROWS)
    _with_rows(tree / "lineofaction/gearbox/schemas/bearings.py", TABLE_ROWS)
    found = _found(tree, LAW_FOUND)
    assert isinstance(found, dict)
    assert (found["laws"], found["plain"]) == (1, 0)
    assert found["apart"] < 1e-9 * max(found["rest"])
