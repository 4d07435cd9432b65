"""What runs do to housings over HTTP: the figures of the command line, to the last bit."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from housing_solid import housed_scene, write_block
from study_service import empty_service, without
from typer.testing import CliRunner

from service.cli.commands import app
from service.client import LineOfActionClient
from service.problems import BadInput
from service.store import stored_results

TABLE, ABSENT = "cd" * 32, "ef" * 32
OWN = ("cpu_seconds", "models_cpu_seconds", "hash", "sha256", "size", "written", "file")
"""What differs between two computations of the same."""


@dataclass(frozen=True)
class Moved:
    """A service that holds a run, the scene there, the same on disk, and the run there."""

    client: LineOfActionClient
    scene: Path
    here: Path
    key: str
    run: Path

    def printed(self, verb: str, *options: object) -> dict[str, Any]:
        """Return what a verb on the scene prints as JSON."""
        done = CliRunner().invoke(app, [verb, str(self.here), *map(str, options), "--json"])
        assert done.exit_code == 0, done.stderr
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer

    def refused(self, process: str, **options: Any) -> str:
        """Return what is said of inputs that are refused before there is a job."""
        with pytest.raises(BadInput) as caught:
            getattr(self.client, process).submit(self.scene, **options)
        return str(caught.value)


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Moved]:
    """A run at constant speed in a housing by its solid."""
    folder = tmp_path_factory.mktemp("moved")
    write_block(folder / "block.step")
    scene = housed_scene(folder)
    scene["run"]["duration_s"] = 0.2
    scene["drives"][0] |= {"time_s": [0.0], "speed_rpm": [1500.0]}
    (folder / "here.json").write_text(json.dumps(scene))
    mesh = scene["meshes"][0]
    del mesh["database_file"]
    mesh["database_hash"] = TABLE
    (folder / "scene.json").write_text(json.dumps(scene))
    data = folder / "data"
    with empty_service(data) as (client, _), pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        stored_results(data).put(TABLE, "database", Path(shutil.copy(folder / "mesh.nc", folder / "put.nc")))
        job = client.simulate.submit(folder / "scene.json")
        yield Moved(client, folder / "scene.json", folder / "here.json", job.wait().key, job.file())


@pytest.mark.parametrize("name", ["noise", "vibration"])
def test_levels_and_velocities_of_a_run_are_those_of_the_command_line(moved: Moved, name: str) -> None:
    figures = getattr(moved.client, name).submit(moved.scene, run=moved.key, orders=2).figures()
    printed = moved.printed(name, "--run", moved.run, "--orders", 2)
    served = json.loads(figures.model_dump_json(by_alias=True, exclude_unset=True))
    assert printed["forces"]["source"] == "run"
    assert without(OWN, served) == without(OWN, printed)


def test_a_run_is_part_of_the_address_of_a_result(moved: Moved) -> None:
    of_run = moved.client.vibration.submit(moved.scene, run=moved.key, orders=2).wait()
    linear = moved.client.vibration.submit(moved.scene, speed_rpm=[1500.0], orders=2).wait()
    assert of_run.key != linear.key


@pytest.mark.parametrize(
    ("process", "options", "words"),
    [
        ("noise", {"run": ABSENT}, ("run = ", "a stored run", "simulate")),
        ("noise", {"run": TABLE}, ("run = ", "a stored run")),
        ("vibration", {"run": "run.nc"}, ("run", "run.nc", "[0-9a-f]{64}")),
        ("vibration", {}, ("speed_rpm", "at least one speed")),
        ("noise", {"run": ABSENT, "speed_rpm": [500.0]}, ("speed_rpm", "left out with a run")),
        ("noise", {"run": None, "sensitivities": True, "speed_rpm": []}, ("speed_rpm", "300, 600")),
    ],
)
def test_what_names_no_run_is_refused_at_the_request(
    moved: Moved, process: str, options: dict[str, Any], words: tuple[str, ...]
) -> None:
    said = moved.refused(process, **options)
    for word in words:
        assert word in said, said


def test_sensitivities_of_a_run_are_refused_at_the_request(moved: Moved) -> None:
    assert "left out with a run" in moved.refused("noise", run=moved.key, sensitivities=True)
