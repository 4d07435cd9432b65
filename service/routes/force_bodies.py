"""Bodies of force queries and of their answers: JSON, CBOR, or raw columns of float64.

A query asks an STE database for the forces at many points, which are read to an array (N, columns).
`force_answer` is the route; `READ` and `WRITE` are the formats by media type.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

import cbor2
import numpy as np
from pydantic import ValidationError
from pydantic_core import to_json
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.force_query import (
    ForceAnswer,
    check_columns,
    points_of_columns,
    points_of_model,
)
from lineofaction.gearbox.problems import BadInput, NotAcceptable, UnsupportedMediaType
from lineofaction.gearbox.schemas.faults import fault_of, innermost
from lineofaction.gearbox.schemas.model import HASH
from lineofaction.gearbox.schemas.query import QueryInput, validity_text
from service.routes.context import context_of
from service.routes.media_types import CBOR, JSON, RAW, media_type, negotiated

if TYPE_CHECKING:
    from fe_contact.ste import SteDatabase


_VALIDITY_TEXTS = [
    validity_text(flags) for flags in range(16)
]  # words of a validity by the sum of its four flags
_FLOAT64_ARRAY = 86  # RFC 8746: little-endian float64, the one tag a query may have
_DEEPEST = 2  # levels of nesting in CBOR: a map of arrays
_EMPTY_LIST = b"\x80"  # CBOR of []; the byte also occurs in numbers, but hardly in every fourth byte
# The tags that cbor2 decodes itself, each to an object of its own kind.
_BUILT_IN_TAGS = (0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100, 256, 258, 260, 261, 1004, 43000)
_KEY = re.compile(HASH[:-1] + r"\Z")  # \Z in place of $, which also matches before a last line feed
COLUMNS = "position,deflection_um"
"""Columns of a raw body whose request names none."""
LONGEST_COLUMNS = 100
"""Most characters of the parameter that names the columns."""
_INLINE_BYTES = 32_768  # a longer body is read and answered in a thread: other requests do not wait for it


def _points_of_json(body: bytes, _columns: Sequence[str]) -> FloatArray:
    try:
        return points_of_model(QueryInput.model_validate_json(body))
    except ValidationError as error:
        _refuse(error, "valid JSON")


def _points_of_cbor(body: bytes, _columns: Sequence[str]) -> FloatArray:
    """Read a query in CBOR, of the same shape as in JSON; lists may be typed arrays; raises `BadInput`."""
    try:
        if body.count(_EMPTY_LIST) > len(body) // 4 + 16:  # 16: short bodies may have more by chance
            raise ValueError("lists of nothing, which cost more than numbers")
        query = cbor2.loads(
            body,
            tag_hook=_typed_array,
            semantic_decoders=_NO_TAGS,
            max_depth=_DEEPEST,
            allow_duplicate_keys=False,
        )
        return points_of_model(QueryInput.model_validate(query))
    except ValidationError as error:
        _refuse(error, "valid CBOR")
    except (cbor2.CBORError, ValueError, MemoryError, RecursionError, OverflowError):
        remedy = "Send a map of the names of the JSON body to numbers, arrays and typed arrays (tag 86)."
        raise BadInput.of("body", f"{len(body)} bytes", "valid CBOR without other tags", remedy) from None


def _points_of_raw(body: bytes, columns: Sequence[str]) -> FloatArray:
    """Read columns of little-endian float64, one after the other; raises `BadInput`."""
    check_columns(columns)
    row_bytes = 8 * len(columns)
    if not body or len(body) % row_bytes:
        form = f"{len(columns)} columns of equal length of 8-byte numbers"
        bound = f"{form}: a multiple of {row_bytes} bytes above 0"
        raise BadInput.of("body", f"{len(body)} bytes", bound, "Check the parameter columns.")
    return points_of_columns(np.frombuffer(body, "<f8").reshape(len(columns), -1), columns)


READ: dict[str, Callable[[bytes, Sequence[str]], FloatArray]] = {
    JSON: _points_of_json,
    CBOR: _points_of_cbor,
    RAW: _points_of_raw,
}


def _json_answer(answer: ForceAnswer, table: SteDatabase, points: FloatArray) -> bytes:
    """Return the answer in JSON; its decimals are the shortest that give the same float64."""
    return to_json(_plain(answer, table, points))


def _cbor_answer(answer: ForceAnswer, table: SteDatabase, points: FloatArray) -> bytes:
    return cbor2.dumps(_plain(answer, table, points))


def _raw_answer(answer: ForceAnswer, _table: SteDatabase, _points: FloatArray) -> bytes:
    """Return the columns force, stiffness and validity (sum of flags), one after the other."""
    return np.array(answer, dtype="<f8").tobytes()


WRITE: dict[str, Callable[[ForceAnswer, SteDatabase, FloatArray], bytes]] = {
    JSON: _json_answer,
    CBOR: _cbor_answer,
    RAW: _raw_answer,
}


def _plain(answer: ForceAnswer, table: SteDatabase, points: FloatArray) -> dict[str, Any]:
    """Return the members of an answer in JSON and CBOR."""
    return {
        "force_n": answer.force_n.tolist(),
        "stiffness_n_per_um": answer.stiffness_n_per_um.tolist(),
        "validity": [_VALIDITY_TEXTS[flags] for flags in answer.validity.tolist()],
        "force_error_n": answer.error_n(table, points),
    }


def _refuse(error: ValidationError, form: str) -> NoReturn:
    """Raise `BadInput` with all faults of a body; or with one, if the body is not of the `form` at all."""
    faults = []
    for item in innermost(error.errors(include_url=False)):
        if item["type"] == "json_invalid":
            raise BadInput.of("body", None, form, f"{item['ctx']['error']}.") from None
        # A fault without a location is one of the whole body, unless a validator of ours has named the field.
        has_field = item["loc"] or item["type"] == "refused"
        faults.append(fault_of(item, QueryInput, item["loc"] if has_field else ["body"]))
    raise BadInput(faults) from None


def _typed_array(tag: Any, _immutable: bool) -> list[float]:
    """Return the numbers of a typed array; cbor2 calls it for the tags that it does not decode itself."""
    if tag.tag != _FLOAT64_ARRAY or not isinstance(tag.value, bytes):
        raise ValueError("a tag that a query does not have")
    values: list[float] = np.frombuffer(tag.value, "<f8").tolist()
    return values


def _no_tag(_value: Any, _immutable: bool) -> NoReturn:
    """Refuse a tag that cbor2 would decode itself, for example to a date, a pattern or a reference."""
    raise ValueError("a tag that a query does not have")


_NO_TAGS = dict.fromkeys(_BUILT_IN_TAGS, _no_tag)


async def force_answer(request: Request) -> Response:
    """Answer a query: a small one on an open database at once, any other in a thread."""
    key = request.path_params["key"]
    if _KEY.match(key) is None:
        raise BadInput.of("key", key, f"a text of the form {HASH}", "Content hash of the input.")
    body_type = media_type(request.headers.get("content-type", ""))
    if body_type not in READ:
        raise UnsupportedMediaType.of(body_type, *READ)
    # the answer has the type of the query unless the caller prefers another one
    offered = (body_type, *(kind for kind in READ if kind != body_type))
    answer_type = negotiated(request.headers.get("accept", "*/*"), offered)
    if answer_type is None:
        raise NotAcceptable(f"An answer can be {', '.join(READ)}. Accept one of them.")
    column_text = COLUMNS
    if request.scope["query_string"]:  # parameters are parsed only where there are any: it takes time
        column_text = request.query_params.get("columns", COLUMNS)
    if len(column_text) > LONGEST_COLUMNS:  # of any body, though only a raw one needs columns
        raise BadInput.of("columns", column_text, f"a text of at most {LONGEST_COLUMNS} characters")
    columns = column_text.split(",")
    body = await request.body()
    context = context_of(request)
    # the database of the key if it is in memory, else None
    opened = context.databases.at_hand(context.store, key)

    def work() -> bytes:
        table = opened or context.databases.get(context.store, key)
        points = READ[body_type](body, columns)
        return WRITE[answer_type](ForceAnswer.of(table.law, points), table.database, points)

    small = len(body) <= _INLINE_BYTES and opened is not None and opened.compiled
    return Response(work() if small else await run_in_threadpool(work), media_type=answer_type)
