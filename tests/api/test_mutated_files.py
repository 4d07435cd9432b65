"""Spoiled files of every format: a refusal that names the file or an answer, and nothing left behind."""

import base64
import io
import json
import random
import re
import subprocess
import sys
import tomllib
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from fastapi.testclient import TestClient
from housing_solid import housing, write_block
from machine_texts import CHART, machine_text
from reduced_housings import random_housing
from repository import EXAMPLES
from service_fakes import REGISTRY

from host import child_environment, processes_in
from lineofaction.gearbox.schemas.toml import toml_text
from service.app import create_app
from service.settings import Settings

_NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
FATAL = (11, 23)
"""Seeds of STEP files over which the native reader crashes."""
ALONE = """
import importlib, json, sys, tempfile
from pathlib import Path
for line in sys.stdin:
    order = json.loads(line)
    module, _, name = order["entry"].partition(":")
    folder = Path(tempfile.mkdtemp(dir="."))
    print(json.dumps(getattr(importlib.import_module(module), name)(order["inputs"], folder, str)))
"""
"""Does the works of orders in one process that is not confined."""


class Request(NamedTuple):
    """A request that has a file read: a path, a body, and the name of the file, "" if the body has none."""

    path: str
    body: dict[str, Any]
    name: str = ""


Asked = Callable[[bytes], Request]
"""From the content of a file to the request that has it read."""


def mutated(content: bytes, seed: int) -> bytes:
    """Return bytes with one kind of damage: bits turned, the end lost, a block doubled, numbers swapped."""
    draw = random.Random(seed)
    spoiled = bytearray(content)
    match draw.randrange(4):
        case 0:
            for _ in range(draw.choice((1, 3, 10, 30))):
                spoiled[draw.randrange(len(spoiled))] ^= 1 << draw.randrange(8)
        case 1:
            del spoiled[draw.randrange(len(spoiled)) :]
        case 2:
            first = draw.randrange(len(spoiled))
            block = spoiled[first : first + draw.choice((7, 60, 500))]
            to = draw.randrange(len(spoiled))
            spoiled[to:to] = block
        case _:
            for _ in range(draw.choice((1, 5))):
                _swap_numbers(spoiled, draw)
    return bytes(spoiled)


def _swap_numbers(content: bytearray, draw: random.Random) -> None:
    """Swap two numbers of a text, or two words of 8 bytes where none are written as text."""
    numbers = list(_NUMBER.finditer(bytes(content)))
    if len(numbers) > 1:
        first, second = sorted(draw.sample(numbers, 2), key=lambda found: found.start())
        swapped = (second.group(), content[first.end() : second.start()], first.group())
        content[first.start() : second.end()] = b"".join(map(bytes, swapped))
    elif len(content) >= 16:
        one, other = (draw.randrange(len(content) - 7) for _ in range(2))
        content[one : one + 8], content[other : other + 8] = (
            content[other : other + 8],
            content[one : one + 8],
        )


def corpus(folder: Path) -> Iterator[tuple[str, bytes, Asked]]:
    """Yield format, content and request of good files; some are made in a folder."""
    yield "STEP", write_block(folder / "block.step").read_bytes(), _solid("block.step", "step_file")
    for suffix, content in _meshes(folder).items():
        yield f"mesh {suffix}", content, _solid(f"cube{suffix}", "mesh_file")
    for file in (EXAMPLES / "two_stage_gearbox.rexs", EXAMPLES / "two_stage" / "two_stage.rexs"):
        yield f"REXS {file.stem}", file.read_bytes(), _unit
    stream = io.BytesIO()
    np.savez(stream, stiffness=np.diag([1e8] * 3))
    yield "NPZ", stream.getvalue(), _scene("stiffness_file", "k.npz")
    random_housing().to_netcdf(folder / "housing.nc")
    yield "netCDF", (folder / "housing.nc").read_bytes(), _scene("modes_file", "housing.nc")
    yield "P40", machine_text(CHART).encode(), _sheet


def _meshes(folder: Path) -> dict[str, bytes]:
    """Return a cube of tetrahedra in every format of meshes."""
    import meshio  # noqa: PLC0415 (an extra)

    points = [(x, y, z) for z in (0.0, 100.0) for y in (0.0, 100.0) for x in (0.0, 100.0)]
    cells = [(0, 1, 2, 4), (3, 1, 2, 7), (5, 1, 4, 7), (6, 2, 4, 7), (1, 2, 4, 7)]
    mesh = meshio.Mesh(np.array(points), [("tetra", np.array(cells))])
    formats = {".msh": "gmsh", ".inp": "abaqus", ".bdf": "nastran", ".vtu": "vtu", ".vtk": "vtk"}
    contents = {}
    for suffix, title in formats.items():
        file = folder / f"cube{suffix}"
        meshio.write(file, mesh, file_format=title)
        contents[suffix] = file.read_bytes()
    return contents


def _packed(name: str, content: bytes) -> dict[str, str]:
    return {"name": name, "content": base64.b64encode(zlib.compress(content)).decode()}


def _solid(name: str, field: str) -> Asked:
    fields: dict[str, Any] = {"step_file": None}
    if field == "mesh_file":
        fields |= {"element_size_mm": None, "mesh_unit": "mm"}

    def ask(content):
        own = housing(**fields | {field: _packed(name, content)})
        return Request("/v1/scenes/housing-surface", {"housings": [own]}, name)

    return ask


def _unit(content: bytes) -> Request:
    return Request("/v1/units/open", {"rexs_base64": base64.b64encode(content).decode()})


def _scene(field: str, name: str) -> Asked:
    scene = tomllib.loads((EXAMPLES / "palermo_scene.toml").read_text("utf-8"))
    text = toml_text(scene | {"housings": [{"name": "case", "bushings": ["input left"], field: name}]})
    return lambda content: Request(
        "/v1/scenes/from-toml", {"toml": text, "files": [_packed(name, content)]}, name
    )


def _sheet(content: bytes) -> Request:
    gear = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0}
    pair = {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": gear, "wheel": gear}
    case = {"pair": pair, "load": {"torque_n_m": [20.0]}}
    sheet = {"csv": content.decode("utf-8", "replace"), "gear": "pinion"}
    return Request("/v1/cases/as-made", {"inputs": {"case": case}, "measured": sheet})


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("service")


@pytest.fixture(scope="module")
def http(place):
    app = create_app(Settings(data_directory=place), REGISTRY)
    yield TestClient(app, raise_server_exceptions=False, headers={"Host": "localhost"})
    app.state.context.reader.stop()
    app.state.context.live.stop()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return list(corpus(tmp_path_factory.mktemp("corpus")))


def answered(http: TestClient, content: bytes, ask: Asked) -> Any:
    request = ask(content)
    return http.post(request.path, json=request.body)


def left(place: Path) -> list[Any]:
    """Return what readers left: folders, and processes in them."""
    return [*(place / "reading").iterdir(), *processes_in(place / "reading")]


@pytest.mark.law
def test_good_files_read_the_same_as_without_confinement(http, files, tmp_path, monkeypatch):
    pool, orders, answers = http.app.state.context.reader, [], []
    ask = pool.ask
    monkeypatch.setattr(pool, "ask", lambda order, *rest: orders.append(order) or ask(order, *rest))
    for name, content, request in files:
        answer = answered(http, content, request)
        assert answer.status_code == (422 if name == "netCDF" else 200), (name, answer.text)
        answers.append(answer.json())
    read = [pair for pair in zip(orders, answers, strict=True) if "errors" not in pair[1]]
    lines = b"".join(order.frame().body + b"\n" for order, _ in read)
    alone = subprocess.run(
        [sys.executable, "-c", ALONE],
        input=lines,
        cwd=tmp_path,
        env=child_environment(),
        capture_output=True,
        check=False,
    )
    assert list(map(json.loads, alone.stdout.splitlines())) == [answer for _, answer in read], alone.stderr


@pytest.mark.law
@pytest.mark.parametrize("seed", FATAL)
def test_a_step_file_that_ends_its_reader_is_named(http, place, files, seed):
    _, content, ask = files[0]
    answer = answered(http, mutated(content, seed), ask)
    assert answer.status_code == 422, answer.text
    (fault,) = answer.json()["errors"]
    assert (fault["field"], fault["value"]) == ("housings[0].step_file", "block.step")
    assert "ended its reader (SIG" in fault["bound"]
    assert left(place) == []


@pytest.mark.law
@pytest.mark.parametrize("count", [12, pytest.param(480, marks=pytest.mark.nightly)])
def test_spoiled_files_are_refused_or_read(http, place, files, count):
    """As many of every format, of a mesh and a gear unit in turn of one of their files.

    All by one warm process, which is replaced after 500 forks.
    """
    formats = sorted({name.split()[0] for name, _, _ in files})
    fates: Counter[tuple[str, int]] = Counter()
    for number in range(count):
        form, turn = formats[number % len(formats)], number // len(formats)
        members = [file for file in files if file[0].split()[0] == form]
        _, content, ask = members[turn % len(members)]
        answer = answered(http, mutated(content, number), ask)
        fates[form, answer.status_code] += 1
        assert answer.status_code < 500, (form, number, answer.text)
    assert {status for _, status in fates} <= {200, 413, 422}, fates
    assert left(place) == []
