"""REXS files: read by their content, written by their name."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.rexs.archive import read_archive, write_archive
from lineofaction.gearbox.rexs.json_reader import read_json
from lineofaction.gearbox.rexs.kinds import KIND_FIELD, kind_of, texts_of
from lineofaction.gearbox.rexs.model import (
    Array,
    Attribute,
    Component,
    Document,
    Extra,
    LoadSpectrum,
    Model,
    Relation,
    Value,
)
from lineofaction.gearbox.rexs.refusal import MOST_BYTES, refused
from lineofaction.gearbox.rexs.values import coded, text_of
from lineofaction.gearbox.rexs.xml_reader import read_xml

# REXS's XML form of a model.


_STEP = "  "
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _xml_of(model: Model) -> bytes:
    """Return a model as XML in UTF-8, the same bytes at every time.

    Raises
    ------
    BadInput
        A text has a character that XML cannot hold.
    """
    text = "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *_lines(model), ""])
    if unfit := _NO_XML.search(text):
        raise refused("model", unfit[0], "of characters that XML can hold")
    return text.encode("utf-8")


def _lines(model: Model) -> Iterator[str]:
    fields = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "applicationLanguage": model.language,
    }
    yield _start("model", fields, model.extra)
    yield from _group(
        "relations", (line for relation in model.relations for line in _written_relation(relation))
    )
    yield from _group("components", (line for part in model.components for line in _written_component(part)))
    for spectrum in model.spectra:
        yield from _within(_written_spectrum(spectrum))
    yield "</model>"


def _written_relation(relation: Relation) -> Iterator[str]:
    order = None if relation.order is None else str(relation.order)
    fields = {"id": str(relation.id), "type": relation.type, "order": order}
    yield _start("relation", fields, relation.extra)
    for ref in relation.refs:
        fields = {"id": str(ref.id), "role": ref.role, "hint": ref.hint}
        yield _STEP + _start("ref", fields, ref.extra, end="/>")
    yield "</relation>"


def _written_component(component: Component) -> Iterator[str]:
    fields = {"id": str(component.id), "type": component.type, "name": component.name}
    yield _start("component", fields, component.extra)
    for attribute in component.attributes:
        yield _STEP + _written_attribute(attribute)
    yield "</component>"


def _written_spectrum(spectrum: LoadSpectrum) -> Iterator[str]:
    yield _start("load_spectrum", {"id": str(spectrum.id)}, spectrum.extra)
    for case in spectrum.cases:
        yield _STEP + _start("load_case", {"id": str(case.id)}, case.extra)
        yield from _within(_within(line for part in case.components for line in _written_component(part)))
        yield f"{_STEP}</load_case>"
    if spectrum.accumulation is not None:
        yield from _group(
            "accumulation", (line for part in spectrum.accumulation for line in _written_component(part))
        )
    yield "</load_spectrum>"


def _written_attribute(attribute: Attribute) -> str:
    fields = {
        "id": attribute.id,
        "unit": attribute.unit,
        "origin": attribute.origin,
        KIND_FIELD: _hidden(attribute),
    }
    body = _body(attribute.kind, attribute.value, attribute.code)
    return f"{_start('attribute', fields, attribute.extra)}{body}</attribute>"


def _hidden(attribute: Attribute) -> str | None:
    """Return the kind of a value whose text shows another, else None."""
    if attribute.code is not None:
        return None
    entry = kind_of(attribute.id, texts_of(attribute.value))
    rows = isinstance(attribute.value, tuple) and any(isinstance(row, tuple) for row in attribute.value)
    forms = (f"{entry}_matrix", f"array_of_{entry}_arrays") if rows else (f"{entry}_array",)
    shown = forms if isinstance(attribute.value, tuple) else (entry,)
    return None if attribute.kind in shown else attribute.kind


def _body(kind: str, value: Value, code: str | None) -> str:
    if value is None:
        return ""
    if not isinstance(value, tuple):
        return escape(text_of(value))
    rows = [row for row in value if isinstance(row, tuple)]
    if code is not None:
        return _written_coded(kind, value, rows, code)
    if kind.startswith("array_of_"):
        return (
            f"<array_of_arrays>{''.join(f'<array>{_cells(row)}</array>' for row in rows)}</array_of_arrays>"
        )
    if kind.endswith("_matrix"):
        return f"<matrix>{''.join(f'<r>{_cells(row)}</r>' for row in rows)}</matrix>"
    return f"<array>{_cells(value)}</array>"


def _written_coded(kind: str, value: tuple[object, ...], rows: list[Array], code: str) -> str:
    """Return the text of an array or a matrix in base64."""
    if kind.endswith("_array"):
        return f'<array code="{code}">{coded(code, value)}</array>'  # type: ignore[arg-type]  # of scalars
    size = f'rows="{len(rows)}" columns="{len(rows[0]) if rows else 0}"'
    numbers = tuple(number for row in rows for number in row)
    return f'<matrix code="{code}" {size}>{coded(code, numbers)}</matrix>'


def _cells(values: tuple[object, ...]) -> str:
    return "".join(f"<c>{escape(text_of(value))}</c>" for value in values)  # type: ignore[arg-type]  # scalars


def _group(name: str, lines: Iterator[str]) -> Iterator[str]:
    """Yield an element around others, a step further in."""
    yield f"{_STEP}<{name}>"
    yield from _within(_within(lines))
    yield f"{_STEP}</{name}>"


def _within(lines: Iterator[str]) -> Iterator[str]:
    return (_STEP + line for line in lines)


def _start(name: str, fields: Mapping[str, str | None], extra: Extra, end: str = ">") -> str:
    """Return the start of an element; fields without a value are left out."""
    pairs = [(key, text) for key, text in fields.items() if text is not None] + list(extra)
    return f"<{name}" + "".join(f" {key}={_quoted(text)}" for key, text in pairs) + end


def _quoted(text: str) -> str:
    """Return the text of a field in quotes; ends of lines stay what they are."""
    return quoteattr(text, {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})


# REXS's JSON form of a model.


def _json_of(model: Model) -> bytes:
    """Return a model as JSON in UTF-8, the same bytes at every time.

    Raises
    ------
    BadInput
        The model has several load spectra: the form has a place for one.
    """
    if len(model.spectra) > 1:
        raise refused("load_spectrum", f"{len(model.spectra)} spectra", "one in JSON", "Write XML.")
    table = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "applicationLanguage": model.language,
        **dict(model.extra),
        "relations": [_relation(relation) for relation in model.relations],
        "components": [_component(component) for component in model.components],
        **_spectrum(model),
    }
    text = json.dumps({"model": _given(table)}, ensure_ascii=False, indent=1, allow_nan=False)
    return f"{text}\n".encode()


def _relation(relation: Relation) -> dict[str, Any]:
    refs = [
        _given({"id": ref.id, "role": ref.role, "hint": ref.hint, **dict(ref.extra)}) for ref in relation.refs
    ]
    own = {"id": relation.id, "type": relation.type, "order": relation.order}
    return _given({**own, **dict(relation.extra), "refs": refs})


def _component(component: Component) -> dict[str, Any]:
    own = {"id": component.id, "type": component.type, "name": component.name}
    attributes = [_attribute(attribute) for attribute in component.attributes]
    return _given({**own, **dict(component.extra), "attributes": attributes})


def _spectrum(model: Model) -> dict[str, Any]:
    """Return the load spectrum and its accumulation, as far as there are."""
    tables: dict[str, Any] = {}
    for spectrum in model.spectra:
        cases = [
            {"id": case.id, **dict(case.extra), "components": [_component(part) for part in case.components]}
            for case in spectrum.cases
        ]
        tables["load_spectrum"] = {"id": spectrum.id, **dict(spectrum.extra), "load_cases": cases}
        if spectrum.accumulation is not None:
            tables["accumulation"] = {"components": [_component(part) for part in spectrum.accumulation]}
    return tables


def _attribute(attribute: Attribute) -> dict[str, Any]:
    """Return an attribute; one without a value says null."""
    own = {"id": attribute.id, "unit": attribute.unit, "origin": attribute.origin, **dict(attribute.extra)}
    if attribute.code is None or attribute.value is None:
        return {**_given(own), attribute.kind: attribute.value}
    return {**_given(own), f"{attribute.kind}_coded": _coded(attribute, attribute.code)}


def _coded(attribute: Attribute, code: str) -> dict[str, Any]:
    """Return an array or a matrix in base64."""
    value: Any = attribute.value
    if not attribute.kind.endswith("_matrix"):
        return {"code": code, "value": coded(code, value)}
    numbers = tuple(number for row in value for number in row)
    size = {"rows": len(value), "columns": len(value[0]) if value else 0}
    return {"code": code, "value": coded(code, numbers), **size}


def _given(table: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in table.items() if value is not None}


# Checks of a model: ids are unique, references lead to components, no component holds itself.


_WHOLE, _PART = "assembly", "part"
_ASSEMBLIES = ("assembly", "ordered_assembly")
_MOST_FAULTS = 20


def check(model: Model) -> None:
    """Check the model's references.

    Raises
    ------
    BadInput
        With a fault for each id given twice, reference to no component, and component that holds itself; at
        most 20.
    """
    faults = [*_repeated(model), *_dangling(model), *_cycles(model)]
    if faults:
        raise BadInput(faults[:_MOST_FAULTS])


def _repeated(model: Model) -> Iterator[Fault]:
    """Yield the ids that are given twice."""
    lists = {
        "component": [component.id for component in model.components],
        "relation": [relation.id for relation in model.relations],
        "load spectrum": [spectrum.id for spectrum in model.spectra],
    }
    for spectrum in model.spectra:
        lists[f"load spectrum {spectrum.id}, load case"] = [case.id for case in spectrum.cases]
    for place, ids in lists.items():
        yield from (
            Fault(place, number, "an id given once") for number, count in Counter(ids).items() if count > 1
        )


def _dangling(model: Model) -> Iterator[Fault]:
    """Yield the references to components that do not exist."""
    known = {component.id for component in model.components}
    bound = "the id of a component"
    for relation in model.relations:
        yield from (
            Fault(f"relation {relation.id}, {ref.role}", ref.id, bound)
            for ref in relation.refs
            if ref.id not in known
        )
    for place, part in model.all_components():
        if part.id not in known:
            yield Fault(place, part.id, bound)
        for attribute in part.attributes:
            if attribute.kind == "reference_component" and attribute.value not in {None, *known}:
                yield Fault(f"{place}, {attribute.id}", attribute.value, bound)


def _cycles(model: Model) -> Iterator[Fault]:
    """Yield the components that hold themselves, directly or by others, in order of their ids.

    Components whose parts are all settled are settled; what never settles is on a cycle or holds one.
    """
    parts: dict[int, set[int]] = {}
    for relation in model.relations:
        whole, part = relation.of_role(_WHOLE), relation.of_role(_PART)
        if relation.type in _ASSEMBLIES and whole is not None and part is not None:
            parts.setdefault(whole, set()).add(part)
    holders: dict[int, set[int]] = {}
    for whole, inner in parts.items():
        for part in inner:
            holders.setdefault(part, set()).add(whole)
    open_parts = {whole: len(inner) for whole, inner in parts.items()}
    settled = [part for part in holders if part not in parts]
    while settled:
        for whole in holders.get(settled.pop(), ()):
            open_parts[whole] -= 1
            if not open_parts[whole]:
                settled.append(whole)
    for number in sorted(whole for whole, count in open_parts.items() if count):
        yield Fault(f"component {number}", number, "no part of itself, nor whole of one that is")


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
        return write_archive(_xml_of(document.model), document.files)
    if document.files:
        raise refused("file", name, "an archive (.rexsz): other files belong to the model")
    return _json_of(document.model) if ending == ".rexsj" else _xml_of(document.model)


def _model(data: bytes) -> Model:
    """Return the model of an XML or JSON text, its references checked."""
    start = data.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    model = read_json(data) if start == b"{" else read_xml(data)
    check(model)
    return model
