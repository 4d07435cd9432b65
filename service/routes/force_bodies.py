"""Bodies of force queries and of their answers: JSON, CBOR, or raw columns of float64."""

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


_VALIDITY_TEXTS = [validity_text(flags) for flags in range(16)]
_FLOAT64_ARRAY = 86  # RFC 8746: little-endian float64, the one tag a query may have
_DEEPEST = 2
_EMPTY_LIST = b"\x80"  # also a byte of numbers, but hardly of every other one
_BUILT_IN = (0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100, 256, 258, 260, 261, 1004, 43000)
_KEY = re.compile(HASH[:-1] + r"\Z")
COLUMNS = "position,deflection_um"
LONGEST_COLUMNS = 100
_INLINE_BYTES = (
    32_768  # beyond it a body is read and answered in a thread, so that others are not kept waiting
)


def _points_of_json(body: bytes, _columns: Sequence[str]) -> FloatArray:
    try:
        return points_of_model(QueryInput.model_validate_json(body))
    except ValidationError as error:
        _refuse(error, "valid JSON")


def _points_of_cbor(body: bytes, _columns: Sequence[str]) -> FloatArray:
    """Read a query in CBOR, of the same shape as in JSON; lists may be typed arrays; raises `BadInput`."""
    try:
        if body.count(_EMPTY_LIST) > len(body) // 4 + 16:
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
    width = 8 * len(columns)
    if not body or len(body) % width:
        bound = (
            f"{len(columns)} columns of equal length of 8-byte numbers: a multiple of {width} bytes above 0"
        )
        raise BadInput.of("body", f"{len(body)} bytes", bound, "Check the parameter columns.")
    return points_of_columns(np.frombuffer(body, "<f8").reshape(len(columns), -1), columns)


READ: dict[str, Callable[[bytes, Sequence[str]], FloatArray]] = {
    JSON: _points_of_json,
    CBOR: _points_of_cbor,
    RAW: _points_of_raw,
}
WRITE: dict[str, Callable[[ForceAnswer, SteDatabase, FloatArray], bytes]] = {
    JSON: lambda *answer: to_json(_plain(*answer)),  # the shortest decimals that give the same float64
    CBOR: lambda *answer: cbor2.dumps(_plain(*answer)),
    # force, stiffness, validity: sum of flags
    RAW: lambda answer, _table, _points: np.array(answer, dtype="<f8").tobytes(),
}


def _plain(answer: ForceAnswer, table: SteDatabase, points: FloatArray) -> dict[str, Any]:
    return {
        "force_n": answer.force_n.tolist(),
        "stiffness_n_per_um": answer.stiffness_n_per_um.tolist(),
        "validity": [_VALIDITY_TEXTS[flags] for flags in answer.validity.tolist()],
        "force_error_n": answer.error_n(table, points),
    }


def _refuse(error: ValidationError, form: str) -> NoReturn:
    faults = []
    for item in innermost(error.errors(include_url=False)):
        if item["type"] == "json_invalid":
            raise BadInput.of("body", None, form, f"{item['ctx']['error']}.") from None
        within = item["loc"] or item["type"] == "refused"
        faults.append(fault_of(item, QueryInput, item["loc"] if within else ["body"]))
    raise BadInput(faults) from None


def _typed_array(tag: Any, _immutable: bool) -> list[float]:
    if tag.tag != _FLOAT64_ARRAY or not isinstance(tag.value, bytes):
        raise ValueError("a tag that a query does not have")
    values: list[float] = np.frombuffer(tag.value, "<f8").tolist()
    return values


def _no_tag(_value: Any, _immutable: bool) -> NoReturn:
    """Refuse dates, big numbers, patterns, references: what the library would build of tagged values."""
    raise ValueError("a tag that a query does not have")


_NO_TAGS = dict.fromkeys(_BUILT_IN, _no_tag)


async def force_answer(request: Request) -> Response:
    """Answer a query: small ones at once, others in a thread."""
    key = request.path_params["key"]
    if _KEY.match(key) is None:
        raise BadInput.of("key", key, f"a text of the form {HASH}", "Content hash of the input.")
    sent = media_type(request.headers.get("content-type", ""))
    if sent not in READ:
        raise UnsupportedMediaType.of(sent, *READ)
    offered = (sent, *(kind for kind in READ if kind != sent))
    accepted = negotiated(request.headers.get("accept", "*/*"), offered)
    if accepted is None:
        raise NotAcceptable(f"An answer can be {', '.join(READ)}. Accept one of them.")
    named = request.query_params.get("columns", COLUMNS) if request.scope["query_string"] else COLUMNS
    if len(named) > LONGEST_COLUMNS:  # also of bodies that do not need it
        raise BadInput.of("columns", named, f"a text of at most {LONGEST_COLUMNS} characters")
    columns = named.split(",")
    body, context = await request.body(), context_of(request)
    opened = context.databases.at_hand(context.store, key)

    def work() -> bytes:
        table = opened or context.databases.get(context.store, key)
        points = READ[sent](body, columns)
        return WRITE[accepted](ForceAnswer.of(table.law, points), table.database, points)

    small = len(body) <= _INLINE_BYTES and opened is not None and opened.compiled
    return Response(work() if small else await run_in_threadpool(work), media_type=accepted)
