"""REXS's XML form of a model."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from xml.sax.saxutils import escape, quoteattr

from lineofaction.gearbox.rexs.kinds import KIND_FIELD, kind_of, texts_of
from lineofaction.gearbox.rexs.model import (
    Array,
    Attribute,
    Component,
    Extra,
    LoadSpectrum,
    Model,
    Relation,
    Value,
)
from lineofaction.gearbox.rexs.refusal import refused
from lineofaction.gearbox.rexs.values import coded, text_of

_STEP = "  "
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def xml_of(model: Model) -> bytes:
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
    """Yield the lines of a model."""
    fields = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "applicationLanguage": model.language,
    }
    yield _start("model", fields, model.extra)
    yield from _group("relations", (line for relation in model.relations for line in _relation(relation)))
    yield from _group("components", (line for part in model.components for line in _component(part)))
    for spectrum in model.spectra:
        yield from _within(_spectrum(spectrum))
    yield "</model>"


def _relation(relation: Relation) -> Iterator[str]:
    """Yield the lines of a relation."""
    order = None if relation.order is None else str(relation.order)
    fields = {"id": str(relation.id), "type": relation.type, "order": order}
    yield _start("relation", fields, relation.extra)
    for ref in relation.refs:
        fields = {"id": str(ref.id), "role": ref.role, "hint": ref.hint}
        yield _STEP + _start("ref", fields, ref.extra, end="/>")
    yield "</relation>"


def _component(component: Component) -> Iterator[str]:
    """Yield the lines of a component."""
    fields = {"id": str(component.id), "type": component.type, "name": component.name}
    yield _start("component", fields, component.extra)
    for attribute in component.attributes:
        yield _STEP + _attribute(attribute)
    yield "</component>"


def _spectrum(spectrum: LoadSpectrum) -> Iterator[str]:
    """Yield the lines of a load spectrum."""
    yield _start("load_spectrum", {"id": str(spectrum.id)}, spectrum.extra)
    for case in spectrum.cases:
        yield _STEP + _start("load_case", {"id": str(case.id)}, case.extra)
        yield from _within(_within(line for part in case.components for line in _component(part)))
        yield f"{_STEP}</load_case>"
    if spectrum.accumulation is not None:
        yield from _group(
            "accumulation", (line for part in spectrum.accumulation for line in _component(part))
        )
    yield "</load_spectrum>"


def _attribute(attribute: Attribute) -> str:
    """Return an attribute on one line."""
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
    """Return the text of a value."""
    if value is None:
        return ""
    if not isinstance(value, tuple):
        return escape(text_of(value))
    rows = [row for row in value if isinstance(row, tuple)]
    if code is not None:
        return _coded(kind, value, rows, code)
    if kind.startswith("array_of_"):
        return (
            f"<array_of_arrays>{''.join(f'<array>{_cells(row)}</array>' for row in rows)}</array_of_arrays>"
        )
    if kind.endswith("_matrix"):
        return f"<matrix>{''.join(f'<r>{_cells(row)}</r>' for row in rows)}</matrix>"
    return f"<array>{_cells(value)}</array>"


def _coded(kind: str, value: tuple[object, ...], rows: list[Array], code: str) -> str:
    """Return the text of an array or a matrix in base64."""
    if kind.endswith("_array"):
        return f'<array code="{code}">{coded(code, value)}</array>'  # type: ignore[arg-type]  # of scalars
    size = f'rows="{len(rows)}" columns="{len(rows[0]) if rows else 0}"'
    numbers = tuple(number for row in rows for number in row)
    return f'<matrix code="{code}" {size}>{coded(code, numbers)}</matrix>'


def _cells(values: tuple[object, ...]) -> str:
    """Return the cells of an array or a row."""
    return "".join(f"<c>{escape(text_of(value))}</c>" for value in values)  # type: ignore[arg-type]  # scalars


def _group(name: str, lines: Iterator[str]) -> Iterator[str]:
    """Yield an element around others, a step further in."""
    yield f"{_STEP}<{name}>"
    yield from _within(_within(lines))
    yield f"{_STEP}</{name}>"


def _within(lines: Iterator[str]) -> Iterator[str]:
    """Yield lines a step further in."""
    return (_STEP + line for line in lines)


def _start(name: str, fields: Mapping[str, str | None], extra: Extra, end: str = ">") -> str:
    """Return the start of an element; fields without a value are left out."""
    pairs = [(key, text) for key, text in fields.items() if text is not None] + list(extra)
    return f"<{name}" + "".join(f" {key}={_quoted(text)}" for key, text in pairs) + end


def _quoted(text: str) -> str:
    """Return the text of a field in quotes; ends of lines stay what they are."""
    return quoteattr(text, {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})
