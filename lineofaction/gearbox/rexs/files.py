"""REXS files: read by their content, written by their name."""

from __future__ import annotations

from pathlib import Path

from lineofaction.gearbox.rexs.archive import read_archive, write_archive
from lineofaction.gearbox.rexs.integrity import check
from lineofaction.gearbox.rexs.json_reader import read_json
from lineofaction.gearbox.rexs.json_writer import json_of
from lineofaction.gearbox.rexs.model import Document, Model
from lineofaction.gearbox.rexs.refusal import MOST_BYTES, refused
from lineofaction.gearbox.rexs.xml_reader import read_xml
from lineofaction.gearbox.rexs.xml_writer import xml_of

ENDINGS = (".rexs", ".rexsj", ".rexsz", ".rexs.zip")


def read_rexs(path: Path) -> Document:
    """Return what a REXS file holds: XML, JSON or ZIP by its content. No other file is opened.

    Raises
    ------
    BadInput
        It is missing, too large, damaged, or says what a model cannot be; the message names the place.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise refused("file", str(path), f"a file that can be read ({error.strerror})") from None
    return parsed(data)


def parsed(data: bytes) -> Document:
    """Return the document of a file's bytes.

    Raises
    ------
    BadInput
        As `read_rexs`.
    """
    if len(data) > MOST_BYTES:
        raise refused("file", f"more than {MOST_BYTES} bytes", "smaller")
    if data.startswith(b"PK"):
        _, text, files = read_archive(data)
        return Document(_model(text), files)
    return Document(_model(data))


def serialized(document: Document, name: str) -> bytes:
    """Return a document in the form that the ending of a file's name says.

    Raises
    ------
    BadInput
        The ending is none of REXS, the form has no place for something, or the model is unsound.
    """
    ending = next((end for end in reversed(ENDINGS) if name.lower().endswith(end)), None)
    if ending is None:
        raise refused("file", name, "a name that ends in one of " + ", ".join(ENDINGS))
    check(document.model)
    if ending in (".rexsz", ".rexs.zip"):
        return write_archive(xml_of(document.model), document.files)
    if document.files:
        raise refused("file", name, "an archive (.rexsz): other files belong to the model")
    return json_of(document.model) if ending == ".rexsj" else xml_of(document.model)


def _model(data: bytes) -> Model:
    """Return the model of an XML or JSON text, its references checked."""
    start = data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    model = read_json(data) if start == b"{" else read_xml(data)
    check(model)
    return model
