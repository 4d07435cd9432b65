"""REXS files: every form gives the model back, the same bytes at every time; files they name stay inside."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from small_rexs import small_document, small_model

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, read_rexs, serialized
from lineofaction.gearbox.rexs.model import Document

FORMS = ("a.rexs", "a.rexsj", "a.rexsz", "a.rexs.zip")
FORMS_IN_TURN = ("a.rexs", "a.rexsj", "a.rexsz", "a.rexs")


@pytest.mark.parametrize("name", FORMS)
def test_every_form_gives_the_model_back(name: str) -> None:
    model = small_model()
    assert parsed(serialized(Document(model), name)).model == model


@pytest.mark.parametrize("name", FORMS)
def test_the_same_model_is_the_same_bytes(name: str) -> None:
    assert serialized(Document(small_model()), name) == serialized(Document(small_model()), name)


def test_the_forms_in_turn_give_the_model_back() -> None:
    document = Document(small_model())
    for name in FORMS_IN_TURN:
        document = parsed(serialized(document, name))
    assert document == Document(small_model())


def test_the_form_is_known_by_the_content_not_the_name(tmp_path: Path) -> None:
    path = tmp_path / "model.txt"
    for name in FORMS:
        path.write_bytes(b"" if name.endswith(("z", "p")) else b"\xef\xbb\xbf")
        with path.open("ab") as stream:
            stream.write(serialized(Document(small_model()), name))
        assert read_rexs(path).model == small_model()


def test_an_archive_keeps_the_files_beside_the_model() -> None:
    document = small_document()
    assert parsed(serialized(document, "a.rexsz")) == document
    with pytest.raises(BadInput, match="archive"):
        serialized(document, "a.rexs")


def test_json_holds_one_spectrum() -> None:
    model = small_model()
    two = replace(model, spectra=(*model.spectra, replace(model.spectra[0], id=2)))
    assert parsed(serialized(Document(two), "a.rexs")).model == two
    with pytest.raises(BadInput, match="2 spectra"):
        serialized(Document(two), "a.rexsj")


def test_a_load_case_of_json_has_the_types_of_the_components() -> None:
    text = serialized(Document(small_model()), "a.rexsj").decode()
    head, mark, cases = text.partition('"load_spectrum"')
    shorter = head + mark + cases.replace('"type": "shaft",', "", 1)
    assert shorter != text
    assert parsed(shorter.encode()).model == small_model()
