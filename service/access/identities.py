"""Who a request comes from, by what it presents: a key, or a token of an OpenID Connect issuer."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any
from urllib.parse import urlsplit

import httpx2
import structlog
from pydantic import ValidationError, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from lineofaction.gearbox.problems import BadInput, Fault, IssuerUnavailable, KeyExpired, Unauthorised
from service.access.keyring import PREFIX, Holder, KeyFile, Keyring, Scope
from service.origin import is_loopback
from service.project import COMMON, PROJECT
from service.settings import Settings

# The public keys of an issuer: fetched from it alone, kept, fetched anew when they change.


FRESH_S, STALE_S = 3600.0, 86_400.0
"""Keys are fetched anew after so long; while the issuer does not answer they are good for so long."""
PAUSE_S = 10.0
"""Between attempts: tokens with made-up key identifiers do not make us ask more often."""
_TIMEOUT_S = 5.0
_LARGEST = 1_000_000
_DISCOVERY = "/.well-known/openid-configuration"

Json = dict[str, Any]
logger = structlog.get_logger(__name__)
ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")
"""Signatures that only the holder of a private key makes (RFC 7518, RFC 8037): no others can be allowed."""
_LEEWAY_S = 30
_LONGEST_NAME = 200
_REQUIRED = ["exp", "iss", "aud"]


class Issuer:
    """The keys that one issuer signs with, by their identifiers; used from one event loop.

    Parameters
    ----------
    url : str
        The issuer, as its tokens name it.
    keys_url : str, optional
        Where its keys are; default: as its configuration says, on its own host.
    clock : callable
        Seconds, steady; replaced by tests.
    """

    def __init__(
        self, url: str, keys_url: str | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.url, self._keys_url, self._clock = url, keys_url, clock
        self._keys: dict[str, Json] = {}
        self._fetched = self._tried = -float("inf")
        self._lock = asyncio.Lock()
        self._renewal: asyncio.Task[None] | None = None

    async def key(self, identifier: str) -> Json:
        """Return a key (RFC 7517).

        Raises `Unauthorised`: the issuer has none of this identifier; `IssuerUnavailable`: it does not
        answer, and no key is at hand.
        """
        if not self._good(identifier):
            await self._renew(identifier)
        elif self._age > FRESH_S and (self._renewal is None or self._renewal.done()):
            self._renewal = asyncio.create_task(self._renew(identifier))  # nobody waits for it
        if self._good(identifier):
            return self._keys[identifier]
        if self._tried > self._fetched:
            raise IssuerUnavailable("The issuer of access tokens does not answer. Try again later.")
        raise Unauthorised.of("The token is signed with a key that its issuer does not publish.")

    @property
    def _age(self) -> float:
        return self._clock() - self._fetched

    def _good(self, identifier: str) -> bool:
        return identifier in self._keys and self._age <= STALE_S

    async def _renew(self, identifier: str) -> None:
        """Fetch the keys, unless another caller has just done so or it was just tried."""
        async with self._lock:
            fresh = self._good(identifier) and self._age <= FRESH_S
            if fresh or self._clock() - self._tried < PAUSE_S:
                return
            self._tried = self._clock()
            try:
                self._keys = await asyncio.to_thread(self._fetch)
            except (httpx2.HTTPError, ValueError, KeyError, TypeError) as error:
                logger.warning("keys of the issuer not fetched", issuer=self.url, error=type(error).__name__)
            else:
                self._fetched = self._tried

    def _fetch(self) -> dict[str, Json]:
        """Return the published keys that sign."""
        with httpx2.Client(timeout=_TIMEOUT_S, follow_redirects=False) as http:
            keys = _document(http, self._keys_url or self._discovered(http))["keys"]
        return {key["kid"]: key for key in keys if "kid" in key and key.get("use", "sig") == "sig"}

    def _discovered(self, http: httpx2.Client) -> str:
        """Return where the issuer says its keys are; raise ValueError if that is not its own host."""
        facts = _document(http, self.url.rstrip("/") + _DISCOVERY)
        place = str(facts["jwks_uri"])
        if facts["issuer"] != self.url or _host(place) != _host(self.url):
            raise ValueError(place)
        return place


def _host(url: str) -> tuple[str, str]:
    parts = urlsplit(url)
    return parts.scheme, parts.netloc


def _document(http: httpx2.Client, url: str) -> Json:
    """Return the JSON object at an address; raise ValueError of anything else."""
    with http.stream("GET", url) as answer:
        answer.raise_for_status()
        content = b""
        for piece in answer.iter_bytes():
            content += piece
            if len(content) > _LARGEST:
                raise ValueError(url)
    document = json.loads(content)
    if not isinstance(document, dict):
        raise TypeError(url)
    return document


# Settings of bearer tokens of an OpenID Connect issuer: from the environment (``LOA_OIDC_...``).


class _OidcSettings(BaseSettings):
    """What tokens are accepted, and what their claims mean."""

    model_config = SettingsConfigDict(env_prefix="LOA_OIDC_", frozen=True)

    issuer: str | None = None
    """Claim ``iss`` of its tokens, and where its keys are found; None: no tokens are accepted."""
    audience: str = ""
    """This service, as the claim ``aud`` names it."""
    algorithms: str = "RS256,ES256"
    """Of `ALGORITHMS`, separated by commas."""
    keys_url: str | None = None
    """Where the issuer publishes its keys, if that is on another host; None: as its configuration says."""
    name_claim: str = "sub"
    project_claim: str | None = None
    scopes_claim: str = "scope"
    """`name_claim`, `project_claim`, `scopes_claim`: Claims with the caller's name, project and scopes; a
    path with dots leads into objects. Without a project claim all tokens are of the common project.
    """
    scope_prefix: str = "loa:"
    """Beginning of our scopes among those of others."""

    @property
    def allowed(self) -> list[str]:
        return [name.strip() for name in self.algorithms.split(",")]

    @field_validator("issuer", "keys_url")
    @classmethod
    def _secure(cls, url: str | None) -> str | None:
        """Refuse an address that others could answer at; an empty variable is none."""
        if not url:
            return None
        parts = urlsplit(url)
        if not parts.hostname or "@" in parts.netloc or parts.query or parts.fragment:
            raise ValueError("an address such as https://login.example/realm")
        if parts.scheme != "https" and not (parts.scheme == "http" and is_loopback(parts.hostname)):
            raise ValueError("an https address, or http on loopback")
        return url

    @field_validator("algorithms")
    @classmethod
    def _asymmetric(cls, names: str) -> str:
        """Refuse what anybody could sign with who knows a public key, or nothing."""
        if not {name.strip() for name in names.split(",")} <= set(ALGORITHMS):
            raise ValueError(f"some of {', '.join(ALGORITHMS)}")
        return names

    @model_validator(mode="after")
    def _whole(self) -> _OidcSettings:
        """Refuse an issuer whose tokens cannot be checked."""
        if self.issuer is not None and not self.audience:
            raise ValueError("given with LOA_OIDC_AUDIENCE: tokens for other services are not for this one")
        if self.issuer is not None and find_spec("jwt") is None:
            raise ValueError("left out without the extra oidc: pip install 'lineofaction[oidc]'")
        return self


def _fault(item: dict[str, object]) -> Fault:
    location = item["loc"]
    name = str(location[0]) if isinstance(location, tuple) and location else "issuer"
    bound = str(item["msg"]).removeprefix("Value error, ")
    value = item.get("input") if isinstance(item.get("input"), str) else None
    return Fault(f"oidc_{name}", value, bound, f"It is set by LOA_OIDC_{name.upper()}.")


# Bearer tokens of an OpenID Connect issuer (RFC 9068, RFC 8725): checked, and read as a holder.


class _Tokens:
    """Finds the holders of tokens."""

    def __init__(self, settings: _OidcSettings, issuer: Issuer) -> None:
        self._settings, self._issuer = settings, issuer

    async def holder(self, token: str) -> Holder:
        """Return who presents a token; names begin with ``oidc:``, which no key's name does.

        Raises
        ------
        Unauthorised
            The token is none, not signed by its issuer, for another service, or lacks a claim; `KeyExpired`:
            its time is over.
        IssuerUnavailable
            The issuer's keys cannot be had.
        """
        import jwt  # noqa: PLC0415 (an extra)

        try:
            head = jwt.get_unverified_header(token)
            algorithm, identifier = head.get("alg"), head.get("kid")
            if algorithm not in self._settings.allowed or not isinstance(identifier, str):
                raise ValueError(head)
            key = jwt.PyJWK(await self._key(identifier, algorithm), algorithm)
            claims = jwt.decode(
                token,
                key,
                algorithms=[algorithm],
                audience=self._settings.audience,
                issuer=self._issuer.url,
                leeway=_LEEWAY_S,
                options={"require": _REQUIRED},
            )
        except jwt.ExpiredSignatureError:
            raise KeyExpired.of("This token has expired. Ask its issuer for a new one.") from None
        except (jwt.PyJWTError, ValueError):
            raise Unauthorised.of("This token is not good for this service.") from None
        return self._mapped(claims)

    async def _key(self, identifier: str, algorithm: str) -> Json:
        key = await self._issuer.key(identifier)
        if key.get("kty") == "oct" or key.get("alg", algorithm) != algorithm:
            raise ValueError(identifier)
        return key

    def _mapped(self, claims: Json) -> Holder:
        settings = self._settings
        name = _claim(claims, settings.name_claim)
        if not isinstance(name, str) or not 0 < len(name) <= _LONGEST_NAME:
            raise Unauthorised.of(f"This token names nobody in its claim {settings.name_claim!r}.")
        # our scopes among those of the token, written as a list or with spaces between
        listed = _claim(claims, settings.scopes_claim) or ()
        names = listed.split() if isinstance(listed, str) else listed
        several, prefix = isinstance(names, list | tuple), settings.scope_prefix
        scopes = tuple(scope for scope in Scope if several and prefix + scope in names)
        return Holder(name=f"oidc:{name}", project=self._project(claims), scopes=scopes)

    def _project(self, claims: Json) -> str:
        """Return the project; a token that should name one and does not is not of the common one."""
        named = self._settings.project_claim
        if not named:
            return COMMON
        project = _claim(claims, named)
        if not isinstance(project, str) or PROJECT.fullmatch(project) is None:
            raise Unauthorised.of(f"This token names no project in its claim {named!r}.")
        return project


def _claim(claims: Json, path: str) -> Any:
    """Return a claim by its name, or by the names on the way to it; None if there is none."""
    if path in claims:
        return claims[path]
    found: Any = claims
    for part in path.split("."):
        found = found.get(part) if isinstance(found, dict) else None
    return found


class Identities:
    """The callers that a service knows.

    `tokens`: of an issuer; without it there are keys only.
    """

    def __init__(self, keyring: Keyring, tokens: _Tokens | None = None) -> None:
        self._keyring, self._tokens = keyring, tokens

    def __bool__(self) -> bool:
        """Whether anybody is known."""
        return self._tokens is not None or bool(self._keyring)

    async def holder(self, presented: str | None) -> Holder:
        """Return who presents a key or a token; raises `Unauthorised`, or as `_Tokens.holder`."""
        if presented is None:
            raise Unauthorised("This service asks for an access key, sent as: Authorization: Bearer KEY")
        if self._tokens is not None and not presented.startswith(PREFIX):
            return await self._tokens.holder(presented)
        key = self._keyring.holder(presented)
        if key is None:
            raise Unauthorised.of("This key is unknown. Ask the operator of the service for one.")
        return key


def open_identities(settings: Settings) -> Identities:
    """Return the callers of a service; refuse an address that others can reach as long as nobody is known.

    Raises `BadInput`: the address is not loopback and there are neither keys nor an issuer of tokens, or
    their file or its settings cannot be used.
    """
    try:
        oidc = _OidcSettings()
    except ValidationError as error:
        raise BadInput(_fault(dict(item)) for item in error.errors(include_url=False)) from None
    tokens = None if oidc.issuer is None else _Tokens(oidc, Issuer(oidc.issuer, oidc.keys_url))
    identities = Identities(Keyring(KeyFile(settings.key_file)), tokens)
    if not settings.loopback and not identities:
        raise BadInput.of(
            "host",
            settings.host,
            "a loopback address such as 127.0.0.1 or ::1, as long as there are no access keys",
            f"Make one with: loa keys add NAME (they are read from {settings.key_file})",
        )
    return identities
