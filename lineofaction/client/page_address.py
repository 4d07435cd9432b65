"""The address of the service's page: the case and the result that it shows.

The fragment is written and read by the page's `address.js`, a case in it by `packed.js`. An address comes
from mails and chats: nothing in it is trusted, and requests go to the service of the client alone.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn, Self
from urllib.parse import unquote, urlsplit

from lineofaction.client.steps import Steps
from lineofaction.client.surface import Surface, operation
from lineofaction.gearbox import schemas
from lineofaction.gearbox.problems import BadInput, NotFound
from lineofaction.gearbox.registry import RESULTS, studies_of
from lineofaction.gearbox.shallow_json import shallow_json
from service.origin import Origin

LONGEST_WORD = 1_500_000
"""Characters of a design that the page writes into its address."""

_FIELD = "address"
_HASH = r"[0-9a-f]{64}"
_JOB = r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}"
_PACKED, _VARIANT, _ANY = r"[\w-]+", r"[\w.-]+", r"(?s).+"
_VIEWS = {
    **dict.fromkeys(("case", "live"), _PACKED),
    **dict.fromkeys(("unit", "toml", "a", "b", "c"), _VARIANT),
    **dict.fromkeys(("name", "see"), _ANY),
    "tab": "[a-z]+",
    "at": r"\d(\.\d+)?",
    "motion": r"\d+",
    "on": "[abc]",
}
"""Pattern of each word of an address that says how the page looks at a result. `a`, `b` and `c` are the
variants of a design that the page compares; `unit` is a file that the page has open.
"""
_JOBS = ("analyze", "simulate", "modes", "scene", "job", *studies_of("case"), *studies_of("case or scene"))
_NAMES = {"database": _HASH} | dict.fromkeys(_JOBS, _JOB)
_PATTERNS = _VIEWS | _NAMES
_BOUNDS = {
    _HASH: "a content hash: 64 digits 0-9a-f",
    _JOB: "the identifier of a job",
    _PACKED: "base64url: letters, digits, - and _",
}
_COPY = "Copy the whole address from the page's address bar."


@dataclass(frozen=True)
class PageAddress:
    """The parts of an address of the page: service, results, typed design, views."""

    origin: Origin
    """Origin of the page's service."""
    names: Mapping[str, str]
    """The database by its hash and jobs by their identifiers, the newest last."""
    case: schemas.Case | None
    """The design as typed; None: the design of the result or of a job."""
    views: Mapping[str, str]
    """Words that say how the page looks at the results."""

    @classmethod
    def of(cls, text: str) -> Self:
        """Read an address; raises `BadInput`: it is none of the page, or a word of it is not."""
        page, _, fragment = text.partition("#")
        origin, names, views = _origin(page), dict[str, str](), dict[str, str]()
        for part in filter(None, fragment.split("&")):
            name, value = _word(part)
            words = names if name in _NAMES else views
            words[name] = value
        # the file of a unit is in the browser alone, so its address holds nothing to read
        if "unit" in views and not names and "case" not in views:
            remedy = "Save the file from the page and read it with: loa open FILE"
            raise BadInput.of("unit", None, "beside a case, a database or a job", remedy)
        return cls(origin, names, _unpacked(views["case"]) if "case" in views else None, views)

    @property
    def result(self) -> str | None:
        """The content hash of the shown result, or else the identifier of its newest job."""
        return self.names.get("database") or next(reversed([*self.names.values()]), None)

    @property
    def differing(self) -> str:
        """Changes on the page since its result, such as "its design was edited"; empty without any."""
        parts = {"its design was edited": "case" in self.views, "its sliders moved": "live" in self.views}
        return " and ".join(part for part, holds in parts.items() if holds) if self.names else ""


def _origin(page: str) -> Origin:
    base, _, _ = page.partition("?")
    try:
        origin = Origin.of(base)
    except ValueError:
        hidden = re.sub(r"//[^/]*@", "//...@", base)
        bound = "http:// or https://, a host without user or password, and the page's fragment"
        raise BadInput.of(_FIELD, hidden, bound, _COPY) from None
    if urlsplit(base).path not in ("", "/"):
        raise BadInput.of(_FIELD, base, f"that of the page: {origin}/#...", _COPY)
    return origin


def _word(part: str) -> tuple[str, str]:
    """Return name and value of a part of the fragment."""
    if len(part) > LONGEST_WORD:
        remedy = "Save the case from the page as a file."
        raise BadInput.of(_FIELD, part, f"made of words of at most {LONGEST_WORD} characters", remedy)
    name, _, value = (unquote(piece) for piece in part.partition("="))
    pattern = _PATTERNS.get(name)
    if pattern is None:
        remedy = f"{_COPY} Was it made by another version of the page?"
        raise BadInput.of(_FIELD, unquote(part), "made of words of the page, such as database=HASH", remedy)
    if not re.fullmatch(pattern, value, re.ASCII):
        raise BadInput.of(name, value, _BOUNDS.get(pattern, "as the page writes it"), _COPY)
    return name, value


def _unpacked(word: str) -> schemas.Case:
    """Return a packed case; raises `BadInput`: it is no base64url of JSON, or no case."""
    try:
        content = base64.b64decode(word + "=" * (-len(word) % 4), altchars=b"-_", validate=True)
        table = shallow_json(content.decode(), parse_constant=_no_number, object_pairs_hook=_table)
    except (ValueError, RecursionError):  # of base64, UTF-8, JSON, or a number with too many digits
        table = None
    if not isinstance(table, dict):
        raise BadInput.of("case", word, "a case as the page packs it: base64url of a JSON object", _COPY)
    try:
        return schemas.validated(schemas.Case, table)
    except BadInput as error:
        raise error.within("case") from None


def _table(fields: list[tuple[str, Any]]) -> dict[str, Any]:
    if not all(name.isprintable() for name, _ in fields):  # they are named in errors
        raise ValueError("control characters in a name")
    return dict(fields)


def _no_number(name: str) -> NoReturn:
    raise ValueError(name)


class PageCalls(Surface):
    """Operations on an address of this service's page: the case and the result that the page shows there."""

    @operation
    def case_at(self, address: str) -> Steps[schemas.Case]:
        """Return the case that the page shows at an address.

        A case that was typed on the page is in the address itself; the service is not asked for it.

        Raises `BadInput`: it is no address of this service's page, or it shows no case; `NotFound`: the
        service has nothing of what it names; `Unreachable`, `ServiceError`.
        """
        page = self._at(address)
        if page.case is not None:
            return page.case
        if not page.names:
            return schemas.validated(schemas.Case, (yield from self._example())["case"])
        missing = None
        for name, value in reversed([*page.names.items()]):
            try:
                case = yield from self._case_of(name, value)
            except NotFound as error:
                missing = error
            else:
                if case is not None:
                    return schemas.validated(schemas.Case, case)
        if missing is not None:
            raise missing
        remedy = "Open it in a browser, and save the case there."
        raise BadInput.of(_FIELD, "&".join(page.names), "one that shows a case", remedy)

    @operation
    def result_at(self, address: str) -> Steps[str]:
        """Return the name of an address's result: a content hash, for `fetch`, or a job's identifier.

        Raises `BadInput`: it is no address of this service's page, or names nothing computed; `Unreachable`,
        `ServiceError`.
        """
        page = self._at(address)
        if page.result is not None:
            return page.result
        example = None if page.case else (yield from self._example())
        if example is None or not example["stored"]:
            remedy = "Fetch its case with -o case.toml, then: loa analyze case.toml -o ste.nc"
            views = "&".join(page.views) or str(page.origin)
            raise BadInput.of(_FIELD, views, "one with a result, database=HASH or a job", remedy)
        return str(example["hash"])

    def _at(self, address: str) -> PageAddress:
        page = PageAddress.of(address)
        service = self.session.exchange.base_url
        try:
            same = Origin.of(service) == page.origin
        except ValueError:
            same = False
        if not same:
            remedy = (
                "No access key leaves its service: set the service to that of the address if it is meant."
            )
            raise BadInput.of("service", service, f"that of the address, {page.origin}", remedy)
        return page

    def _example(self) -> Steps[dict[str, Any]]:
        """Return the first example, which a page without an address begins with."""
        return self.session.exchange.read(lambda examples: dict(examples[0]), "GET", "/v1/examples")

    def _case_of(self, name: str, value: str) -> Steps[Any]:
        """Return the case of a database or a job; of a scene the case of its first mesh. None without one."""
        read = self.session.exchange.read
        if name == "database":
            return (yield from read(lambda figures: figures.get("case"), "GET", f"{RESULTS}/{value}"))
        inputs = yield from read(lambda job: dict(job["inputs"]), "GET", f"/v1/jobs/{value}/inputs")
        if "case" in inputs:
            return inputs["case"]
        mesh: dict[str, Any] = next(iter((inputs.get("scene") or {}).get("meshes") or ()), {})
        key = mesh.get("database_hash")
        if mesh.get("case") or not (isinstance(key, str) and re.fullmatch(_HASH, key)):
            return mesh.get("case")
        return (yield from self._case_of("database", key))
