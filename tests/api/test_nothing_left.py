"""Drafts and canaries: no temporary folder keeps a byte of a request, and no answer a byte of the service."""

import base64
import copy
import io
import json
import os
import pickle
import signal
import sys
import tempfile
import tomllib
import zipfile
import zlib
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from foreign_meshes import FOREIGN_MESHES
from foreign_netcdf import SECRET, STRIKES, struck, write_canary
from hostile_rexs import XML, archive
from housing_solid import housed_scene, housing, write_block
from reduced_housings import random_housing
from running_service import until
from study_service import empty_service

from host import kill, processes_in
from lineofaction.gearbox.schemas.toml import toml_text
from service.store.places import stored_results

Body = dict[str, Any]
Question = tuple[str, str, Body]
"""Its name, a path, a body."""

_SCENE, _CASE, _UNIT = "/v1/scenes/from-toml", "/v1/cases/from-toml", "/v1/units/open"
_EXAMPLES = Path(__file__).parents[2] / "examples"
_STEP_FILE = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('{entity}','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));
ENDSEC;
DATA;
#1=DOCUMENT_FILE('{entity}','','',#2,'',$);
#2=DOCUMENT_TYPE('');
#3=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{entity}',#4,#5,(#1));
#4=IDENTIFICATION_ROLE('',$);
#5=EXTERNAL_SOURCE(IDENTIFIER(''));
ENDSEC;
END-ISO-10303-21;
"""
_STEP = {"a document": "{canary}", "an address": "file://{canary}"}
TABLE = "cd" * 32
SLOW = "1," * 2_000_000
MIN = 40


class _Reads:
    """An object whose pickle reads a file when it is opened."""

    def __init__(self, file: Path) -> None:
        self._file = file

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return open, (str(self._file),)


def questions(folder: Path, canary: Path, table: str) -> Iterator[Question]:
    """Yield the questions for a canary; files are made in a folder, `table` is the hash of a stored one."""
    yield from _reduced_housings(folder, canary)
    yield from _matrices(canary)
    yield from _solids(folder, canary, table)
    yield from _names(canary)
    yield from _units(canary)


def packed(name: str, content: bytes) -> Body:
    return {"name": name, "content": base64.b64encode(zlib.compress(content)).decode()}


def _housing_text(fields: Body, *files: Body) -> Body:
    scene = tomllib.loads((_EXAMPLES / "palermo_scene.toml").read_text("utf-8"))
    scene["housings"] = [{"name": "case"} | fields]
    return {"toml": toml_text(scene), "files": list(files)}


def _reduced_housings(folder: Path, canary: Path) -> Iterator[Question]:
    for name, strike in STRIKES.items():
        file = folder / "housing.nc"
        random_housing().to_netcdf(file)
        sent = packed(file.name, struck(file, "stiffness", strike, canary))
        yield f"netCDF: {name}", _SCENE, _housing_text({"modes_file": file.name}, sent)


def _matrices(canary: Path) -> Iterator[Question]:
    stream = io.BytesIO()
    np.savez(stream, stiffness=np.array([_Reads(canary)], dtype=object), allow_pickle=True)
    text = _housing_text({"stiffness_file": "k.npz"})
    yield "NPZ: objects", _SCENE, text | {"files": [packed("k.npz", stream.getvalue())]}
    yield "NPZ: a pickle", _SCENE, text | {"files": [packed("k.npz", pickle.dumps(_Reads(canary)))]}
    with zipfile.ZipFile(stream := io.BytesIO(), "w") as made:
        made.writestr("stiffness.npy", pickle.dumps(_Reads(canary)))
    yield "NPZ: a pickle in it", _SCENE, text | {"files": [packed("k.npz", stream.getvalue())]}
    yield "CSV: its name", _SCENE, _housing_text({"stiffness_file": str(canary)}, packed("k.csv", b"1"))


def _solids(folder: Path, canary: Path, table: str) -> Iterator[Question]:
    scene = copy.deepcopy(housed_scene(folder))
    del scene["meshes"][0]["database_file"]
    scene["meshes"][0]["database_hash"] = table
    for name, (suffix, content) in FOREIGN_MESHES.items():
        own = {"step_file": None, "element_size_mm": None, "mesh_unit": "mm"}
        own["mesh_file"] = packed(f"housing{suffix}", content(canary))
        yield f"mesh: {name}", *_modes(scene, housing(**own))
    for name, entity in _STEP.items():
        step = _STEP_FILE.format(entity=entity.format(canary=canary)).encode()
        yield f"STEP: {name}", *_modes(scene, housing(step_file=packed("housing.step", step)))


def _modes(scene: Body, part: Body) -> tuple[str, Body]:
    return "/v1/processes/modes/execution", {"inputs": {"scene": scene | {"housings": [part]}}}


def _names(canary: Path) -> Iterator[Question]:
    case = (_EXAMPLES / "palermo_spur_20_20.toml").read_text("utf-8")
    for name in (str(canary), f"../{canary.name}", canary.as_uri(), f"..\\{canary.name}"):
        grid = case.replace("[pair.pinion]", f"[pair.pinion]\nflank_grid_csv = {json.dumps(name)}")
        yield f"a flank named {name}", _CASE, {"toml": grid, "files": []}
        yield f"a housing named {name}", _SCENE, _housing_text({"step_file": name})
        yield f"a file sent as {name}", _CASE, {"toml": grid, "files": [packed(name, b"roll_length_mm")]}


def _units(canary: Path) -> Iterator[Question]:
    """Yield gear units with entities, references and files in their archive that lead elsewhere."""
    unit = XML.decode()
    entity = f'<!DOCTYPE model [<!ENTITY c SYSTEM "{canary.as_uri()}">]><model'
    forms = {
        "an entity": unit.replace("<model", entity, 1).replace(">543.0<", ">&c;<"),
        "an inclusion": unit.replace("<components>", f'<components><include href="{canary.as_uri()}"/>', 1),
        "a style": f'<?xml-stylesheet href="{canary.as_uri()}"?>{unit.partition("?>")[2]}',
    }
    contents = {name: text.encode() for name, text in forms.items()}
    contents["a name in its archive"] = archive([("../" + canary.name, b""), ("a.rexs", XML)])
    contents["a link in its archive"] = _linked(canary)
    for name, content in contents.items():
        yield f"REXS: {name}", _UNIT, {"rexs_base64": base64.b64encode(content).decode()}


def _linked(canary: Path) -> bytes:
    """Return an archive whose model is a symbolic link."""
    link = zipfile.ZipInfo("a.rexs")
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(stream := io.BytesIO(), "w") as made:
        made.writestr(link, str(canary))
    return stream.getvalue()


class Place:
    """A service, the folders in which it drafts, and requests that end badly.

    Parameters
    ----------
    http : TestClient
    folder : Path
        Holds the data directory, the common temporary folder and the solid.
    """

    def __init__(self, http: TestClient, folder: Path) -> None:
        self.http, self.folder = http, folder
        self.drafts = [
            folder / "temporary",
            *(folder / "data" / name for name in ("reading", "live", "work")),
        ]
        self._scene = copy.deepcopy(housed_scene(folder))
        del self._scene["meshes"][0]["database_file"]
        self._scene["meshes"][0]["database_hash"] = TABLE

    def refused(self, number: int) -> None:
        """Have files refused."""
        answer = self.http.post("/v1/cases/from-toml", json=_text(number, packed("a.csv", b"1")))
        assert answer.status_code == 422

    def reader_killed(self, number: int) -> None:
        future = self.http.app.state.context.reader.ask(_order(number))
        readers: list[int] = []
        until(lambda: bool(readers.extend(processes_in(self.drafts[1])) or readers) or future.done())
        for pid in readers:
            os.kill(pid, signal.SIGKILL)
        assert future.exception(timeout=60.0) is not None

    def dismissed(self, number: int) -> None:
        self.http.delete(self._meshing(number))

    def worker_killed(self, number: int) -> None:
        """Kill a worker while its solid is meshed, and dismiss what is begun again."""
        job = self._meshing(number)
        for pid in processes_in(self.drafts[3]):
            kill(pid)
        self.http.delete(job)

    def is_empty(self) -> bool:
        """Whether no draft is left, once jobs have ended."""
        until(lambda: self.http.get("/v1/jobs?status=running&status=accepted").json()["jobs"] == [])
        until(lambda: not list(self.drafts[3].iterdir()))
        return not [file for place in self.drafts if place.is_dir() for file in place.iterdir()]

    def _meshing(self, number: int) -> str:
        """Submit a job, each its own, and return its address once it drafts."""
        solid = (self.folder / "block.step").read_bytes() + f"/* {number} */".encode()
        part = housing(step_file=packed("block.step", solid), element_size_mm=3.0)
        inputs = {"scene": self._scene | {"housings": [part]}}
        headers = {"Prefer": "respond-async"}
        answer = self.http.post("/v1/processes/modes/execution", json={"inputs": inputs}, headers=headers)
        until(lambda: bool(list(self.drafts[3].glob("*/drafts/*"))))
        return f"/v1/jobs/{answer.json()['jobID']}"


def _text(number: int, *files: Any) -> dict[str, Any]:
    """Return a text that names no file of those sent."""
    return {"toml": f'[pair.pinion]\nflank_grid_csv = "{number}.csv"', "files": list(files)}


def _order(number: int) -> Any:
    """Return an order that takes a second to read."""
    from service.live.order import LiveOrder  # noqa: PLC0415 (what the route makes)

    text = _text(number, packed(f"{number}.csv", SLOW.encode()))
    return LiveOrder("service.reading.texts:case_of_toml", text)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drafts")
    (folder / "temporary").mkdir()
    write_block(folder / "block.step")
    with pytest.MonkeyPatch.context() as patched, empty_service(folder / "data") as (_, http):
        patched.setattr(tempfile, "tempdir", str(folder / "temporary"))
        made = Place(http, folder)
        stored_results(folder / "data").put(TABLE, "database", folder / "mesh.nc")
        yield made


ENDS: list[Callable[[Place, int], None]] = [
    Place.refused,
    Place.reader_killed,
    Place.dismissed,
    Place.worker_killed,
]


@pytest.mark.law
@pytest.mark.parametrize("count", [8, pytest.param(200, marks=pytest.mark.nightly)])
def test_nothing_is_left_of_requests_that_end_badly(place, count):
    for number, end in enumerate(islice(cycle(ENDS), count)):
        end(place, 1000 * count + number)
    assert place.is_empty()


# A canary beside the service: no question brings it, or a path of the service, into an answer or a log.


@pytest.mark.law
def test_no_question_brings_the_canary(place):
    http, folder = place.http, place.folder
    data = folder / "data"
    canary = write_canary(data)
    answers = {question[0]: _answered(http, question) for question in questions(folder, canary, TABLE)}
    assert len(answers) >= MIN
    assert {name for name, text in answers.items() if SECRET in text} == set()
    places = [data / "reading", data / "work", folder / "temporary"]
    hidden = [str(place).encode() for place in (*places, sys.prefix, Path(__file__).parents[2])]
    assert {name for name, text in answers.items() if any(place in text for place in hidden)} == set()
    written = [file for file in data.rglob("*") if file.is_file() and file.parent != data]
    assert [file for file in written if SECRET in file.read_bytes()] == []
    for left in places:
        assert list(left.iterdir()) == [], left


def _answered(http: TestClient, question: Question) -> bytes:
    """Return all that a question brings: the answer, and of a job its outcome."""
    _, path, body = question
    answer = http.post(path, json=body, headers={"Prefer": "respond-async"})
    assert answer.status_code < 500, (question[0], answer.text)
    if answer.status_code != 201:
        return answer.content
    job = f"/v1/jobs/{answer.json()['jobID']}"
    until(lambda: http.get(job).json()["status"] in ("failed", "successful", "dismissed"))
    return answer.content + http.get(job).content + http.get(f"{job}/results").content
