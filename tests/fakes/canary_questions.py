"""Forty and more ways to ask a service for a file beside it, each a request: path and body."""

from __future__ import annotations

import base64
import copy
import io
import json
import pickle
import tomllib
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from foreign_meshes import FOREIGN_MESHES
from foreign_netcdf import STRIKES, struck
from hostile_rexs import XML, archive
from housing_solid import housed_scene, housing
from reduced_housings import random_housing

from lineofaction.gearbox.schemas.toml import toml_text

Body = dict[str, Any]
Question = tuple[str, str, Body]
"""Its name, a path, a body."""

_SCENE, _CASE, _UNIT = "/v1/scenes/from-toml", "/v1/cases/from-toml", "/v1/units/open"
_EXAMPLES = Path(__file__).parents[2] / "examples"


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


def _text(fields: Body, *files: Body) -> Body:
    scene = tomllib.loads((_EXAMPLES / "palermo_scene.toml").read_text("utf-8"))
    scene["housings"] = [{"name": "case"} | fields]
    return {"toml": toml_text(scene), "files": list(files)}


def _reduced_housings(folder: Path, canary: Path) -> Iterator[Question]:
    for name, strike in STRIKES.items():
        file = folder / "housing.nc"
        random_housing().to_netcdf(file)
        sent = packed(file.name, struck(file, "stiffness", strike, canary))
        yield f"netCDF: {name}", _SCENE, _text({"modes_file": file.name}, sent)


def _matrices(canary: Path) -> Iterator[Question]:
    stream = io.BytesIO()
    np.savez(stream, stiffness=np.array([_Reads(canary)], dtype=object), allow_pickle=True)
    text = _text({"stiffness_file": "k.npz"})
    yield "NPZ: objects", _SCENE, text | {"files": [packed("k.npz", stream.getvalue())]}
    yield "NPZ: a pickle", _SCENE, text | {"files": [packed("k.npz", pickle.dumps(_Reads(canary)))]}
    with zipfile.ZipFile(stream := io.BytesIO(), "w") as made:
        made.writestr("stiffness.npy", pickle.dumps(_Reads(canary)))
    yield "NPZ: a pickle in it", _SCENE, text | {"files": [packed("k.npz", stream.getvalue())]}
    yield "CSV: its name", _SCENE, _text({"stiffness_file": str(canary)}, packed("k.csv", b"1"))


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


def _names(canary: Path) -> Iterator[Question]:
    case = (_EXAMPLES / "palermo_spur_20_20.toml").read_text("utf-8")
    for name in (str(canary), f"../{canary.name}", canary.as_uri(), f"..\\{canary.name}"):
        grid = case.replace("[pair.pinion]", f"[pair.pinion]\nflank_grid_csv = {json.dumps(name)}")
        yield f"a flank named {name}", _CASE, {"toml": grid, "files": []}
        yield f"a housing named {name}", _SCENE, _text({"step_file": name})
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
