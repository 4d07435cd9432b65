"""Damaged and hostile REXS files, made from the small model."""

import io
import json
import random
import zipfile
from collections.abc import Iterator

from small_rexs import small_model

from lineofaction.gearbox.rexs.files import serialized
from lineofaction.gearbox.rexs.model import Document

XML = serialized(Document(small_model()), "a.rexs")
JSON = serialized(Document(small_model()), "a.rexsj")
ZIP = serialized(Document(small_model()), "a.rexsz")


def damaged_files(count: int = 35) -> Iterator[tuple[str, bytes]]:
    """Yield files cut off or with some bytes replaced; some are still models, of other content."""
    chance = random.Random(7)
    for form, data in (("xml", XML), ("json", JSON), ("zip", ZIP)):
        for index in range(count):
            yield f"{form} cut off {index}", data[: chance.randrange(len(data) - 3)]
            mixed = bytearray(data)
            for _ in range(chance.randint(1, 4)):
                mixed[chance.randrange(len(mixed))] = chance.randrange(256)
            yield f"{form} replaced {index}", bytes(mixed)


def hostile_files() -> Iterator[tuple[str, bytes, str]]:
    yield from _entities()
    yield from _texts()
    yield from _trees()
    yield from _archives()


def _entities() -> Iterator[tuple[str, bytes, str]]:
    laughs = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 10))
    declarations = {
        "billion laughs": f'<!ENTITY l0 "ha">{laughs}',
        "quadratic": f'<!ENTITY l9 "{"a" * 100_000}">',
        "external": '<!ENTITY l9 SYSTEM "file:///etc/passwd">',
        "network": '<!ENTITY l9 SYSTEM "http://127.0.0.1:9/x">',
        "parameter": '<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;',
        "empty": "",
    }
    for name, text in declarations.items():
        head = f"<!DOCTYPE model [{text}]>"
        yield f"entity {name}", XML.replace(b"<model", f"{head}<model".encode(), 1), "document type"
    yield "undeclared entity", XML.replace(b">543.0<", b">&l9;<"), "undefined entity"
    yield (
        "include",
        XML.replace(b"<components>", b'<components><xi:include href="/etc/passwd"/>'),
        "one of component",
    )


def _texts() -> Iterator[tuple[str, bytes, str]]:
    yield "nothing", b"", "no element found"
    yield "spaces", b"  \n ", "no element found"
    yield "other root", b"<scene/>", "root of a REXS file"
    yield "page", b"<html><body/></html>", "root of a REXS file"
    yield "list", b"[1]", "well-formed"
    yield "null", b'{"model": null}', "a table"
    yield "no fields", b"<model/>", "version"
    yield "encoding", b'<?xml version="1.0" encoding="x-none"?><model/>', "encoding"
    yield "codec", b'<?xml version="1.0" encoding="hex"?><model/>', "encoding = 'hex'"
    yield "latin", XML.replace("Ä".encode(), b"\xc4"), "well-formed"
    yield "latin JSON", JSON.replace("Ä".encode(), b"\xc4"), "UTF-8"
    changes = {
        "no number": (b'<component id="2"', b'<component id="two"', "an integer"),
        "long number": (b'<component id="2"', b'<component id="' + b"9" * 5000 + b'"', "an integer"),
        "twice": (b'<component id="2"', b'<component id="3"', "an id given once"),
        "to nothing": (b'<ref id="2"', b'<ref id="77"', "the id of a component"),
        "component to nothing": (b">2</attribute>", b">77</attribute>", "the id of a component"),
        "cycle": (b'<ref id="4" role="part"', b'<ref id="1" role="part"', "no part of itself"),
        "case of nothing": (b'<load_case id="2"', b'<load_case id="1"', "an id given once"),
        "unknown part": (b"<components>", b"<components><wheel/>", "one of component"),
        "group twice": (b"<components>", b"<components/><components>", "given once"),
        "two values": (b"</matrix></attribute>", b"</matrix>1</attribute>", "one value"),
        "base64": (b'<array code="float64">', b'<array code="float64">?', "base64"),
        "half a number": (b'<array code="float64">', b'<array code="float64">AAAA', "base64"),
        "code": (b'code="float64"', b'code="float16"', "float64"),
        "size": (b'rows="3"', b'rows="3000000000"', "size of a matrix"),
        "negative size": (b'rows="3" columns="2"', b'rows="-3" columns="-2"', "size of a matrix"),
        "not a number": (b'code="float64">', b'code="float64">AAAAAAAA+H8=', "base64"),
        "kind": (b'valueType="integer">-3', b'valueType="integer">3.5', "an integer"),
    }
    for name, (old, new, words) in changes.items():
        assert old in XML, name
        yield name, XML.replace(old, new, 1), words
    tables = {
        "NaN": (b"543.0", b"NaN", "finite"),
        "Infinity": (b"543.0", b"-Infinity", "finite"),
        "too large": (b"543.0", b"1e999", "finite"),
        "long integer": (b'"integer": 20', b'"integer": ' + b"9" * 5000, "64 bits"),
        "text as number": (b"543.0", b'"543"', "floating_point"),
        "number as text": (b'"role": "part"', b'"role": 7', "a text"),
        "field twice": (b'"id": 2,', b'"id": 2, "id": 2,', "given once"),
        "two kinds": (b'"boolean": true', b'"boolean": true, "integer": 1', "one value"),
        "no kind": (b'"boolean": true', b'"bool": true', "one value"),
        "code of kind": (b'"code": "int32"', b'"code": "float32"', "a code of"),
        "true as id": (b'"id": 1,', b'"id": true,', "an integer"),
    }
    for name, (old, new, words) in tables.items():
        assert old in JSON, name
        yield f"JSON {name}", JSON.replace(old, new, 1), words


def _trees() -> Iterator[tuple[str, bytes, str]]:
    deep = 100_000
    yield "deep XML", b"<model>" * deep, "deep"
    yield "deep JSON", b'{"model":' + b"[" * deep + b"]" * deep + b"}", "nested"
    yield "deep tables", b'{"model":' * 20_000 + b"1" + b"}" * 20_000, "nested"
    yield "many elements", b"<model>" + b"<c/>" * 300_001 + b"</model>", "smaller"
    yield "many values", b'{"model": [' + b"1," * 300_001 + b"1]}", "smaller"
    yield "many bytes", b" " * 64_000_001, "smaller"
    ring = json.loads(JSON)
    refs = [{"id": 1, "role": "part"}, {"id": 6, "role": "assembly"}]
    ring["model"]["relations"].append({"id": 70, "type": "assembly", "refs": refs})
    yield "cycle over others", json.dumps(ring).encode(), "no part of itself"


def _archives() -> Iterator[tuple[str, bytes, str]]:
    names = [
        "../a.rexs",
        "/a.rexs",
        "a/../../a.rexs",
        "..\\a.rexs",
        "C:\\a.rexs",
        "C:a.rexs",
        "\\\\host\\a.rexs",
    ]
    for name in names:
        yield f"archive {name}", archive([(name, XML)]), "inside the archive"
    yield "file outside", archive([("a.rexs", XML), ("../x", b"")]), "inside the archive"
    yield "no model", archive([("a.txt", XML)]), "one model"
    yield "two models", archive([("a.rexs", XML), ("b.rexsj", JSON)]), "one model"
    yield "zeros", archive([("a.rexs", b"\0" * 30_000_000)]), "times its archive"
    yield "zeros beside", archive([("a.rexs", XML), ("x", b"\0" * 30_000_000)]), "times its archive"
    yield "archive in archive", archive([("a.rexs", archive([("a.rexs", XML)]))]), "well-formed"
    yield "many files", archive([(f"{i}.txt", b"") for i in range(1_001)]), "at most"
    yield "false size", _false_size(), "archive"
    yield "encrypted", _encrypted(), "archive"
    yield "no archive", b"PK\3\4" + b"\0" * 100, "ZIP archive"


def archive(files: list[tuple[str, bytes]]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as target:
        for name, data in files:
            entry = zipfile.ZipInfo("x")
            entry.filename = name
            target.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def _false_size() -> bytes:
    data = bytearray(archive([("a.rexs", b"\0" * 30_000_000)]))
    place = data.rindex(b"PK\1\2")
    data[place + 24 : place + 28] = (100).to_bytes(4, "little")
    return bytes(data)


def _encrypted() -> bytes:
    data = bytearray(archive([("a.rexs", XML)]))
    data[6] |= 1
    data[data.rindex(b"PK\1\2") + 8] |= 1
    return bytes(data)
