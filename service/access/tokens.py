"""Bearer tokens of an OpenID Connect issuer (RFC 9068, RFC 8725): their settings, check and holder."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any
from urllib.parse import urlsplit

from pydantic import field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from lineofaction.gearbox.problems import Fault, KeyExpired, Unauthorised
from service.access.holder import Holder, Scope
from service.access.issuer import Issuer
from service.origin import is_loopback
from service.project import COMMON, PROJECT

Json = dict[str, Any]
ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")
"""Signatures that only the holder of a private key makes (RFC 7518, RFC 8037). Other algorithms cannot be
allowed."""
_LEEWAY_S = 30
_LONGEST_NAME = 200
_REQUIRED = ["exp", "iss", "aud"]


class OidcSettings(BaseSettings):
    """Settings of the accepted tokens and the meaning of their claims."""

    model_config = SettingsConfigDict(env_prefix="LOA_OIDC_", frozen=True)

    issuer: str | None = None
    """Claim ``iss`` of accepted tokens, and the address of the issuer's keys; None: no tokens are accepted.
    """
    audience: str = ""
    """Claim ``aud`` that names this service."""
    algorithms: str = "RS256,ES256"
    """Accepted signatures among `ALGORITHMS`, separated by commas."""
    keys_url: str | None = None
    """Address of the issuer's keys on another host; None: the address in the issuer's configuration."""
    name_claim: str = "sub"
    project_claim: str | None = None
    scopes_claim: str = "scope"
    """`name_claim`, `project_claim`, `scopes_claim`: Claims with the caller's name, project and scopes; a
    path with dots leads into objects. Without a project claim all tokens are of the common project.
    """
    scope_prefix: str = "loa:"
    """Beginning of this service's scopes among the scopes of others."""

    @property
    def allowed(self) -> list[str]:
        """Signatures that are accepted."""
        return [name.strip() for name in self.algorithms.split(",")]

    @field_validator("issuer", "keys_url")
    @classmethod
    def _secure(cls, url: str | None) -> str | None:
        """Refuse an address at which others could answer; an empty text counts as no address."""
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
        """Refuse algorithms by which anybody with a public key, or without a key, could sign."""
        if not {name.strip() for name in names.split(",")} <= set(ALGORITHMS):
            raise ValueError(f"some of {', '.join(ALGORITHMS)}")
        return names

    @model_validator(mode="after")
    def _complete(self) -> OidcSettings:
        """Refuse an issuer whose tokens cannot be checked."""
        if self.issuer is not None and not self.audience:
            raise ValueError("given with LOA_OIDC_AUDIENCE: tokens for other services are not for this one")
        if self.issuer is not None and find_spec("jwt") is None:
            raise ValueError("left out without the extra oidc: pip install 'lineofaction[oidc]'")
        return self


def fault_of_error(item: dict[str, object]) -> Fault:
    """Return an error of the validation of settings as a fault of a variable."""
    location = item["loc"]
    name = str(location[0]) if isinstance(location, tuple) and location else "issuer"
    bound = str(item["msg"]).removeprefix("Value error, ")
    value = item.get("input") if isinstance(item.get("input"), str) else None
    return Fault(f"oidc_{name}", value, bound, f"It is set by LOA_OIDC_{name.upper()}.")


class Tokens:
    """Finds the holders of tokens."""

    def __init__(self, settings: OidcSettings, issuer: Issuer) -> None:
        self._settings, self._issuer = settings, issuer

    async def holder(self, token: str) -> Holder:
        """Return the holder of a token; its name begins with ``oidc:``, as no name of a key does.

        Raises
        ------
        Unauthorised
            The text is no token, or the token is not signed by its issuer, is for another service, or lacks a
            claim; `KeyExpired`: it has expired.
        IssuerUnavailable
            The issuer does not give its keys.
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
        return self._holder(claims)

    async def _key(self, identifier: str, algorithm: str) -> Json:
        key = await self._issuer.key(identifier)
        if key.get("kty") == "oct" or key.get("alg", algorithm) != algorithm:
            raise ValueError(identifier)
        return key

    def _holder(self, claims: Json) -> Holder:
        settings = self._settings
        name = _claim(claims, settings.name_claim)
        if not isinstance(name, str) or not 0 < len(name) <= _LONGEST_NAME:
            raise Unauthorised.of(f"This token names nobody in its claim {settings.name_claim!r}.")
        # our scopes among those of the token, written as a list or with spaces between
        listed = _claim(claims, settings.scopes_claim) or ()
        names = listed.split() if isinstance(listed, str) else listed
        is_list, prefix = isinstance(names, list | tuple), settings.scope_prefix
        scopes = tuple(scope for scope in Scope if is_list and prefix + scope in names)
        return Holder(name=f"oidc:{name}", project=self._project(claims), scopes=scopes)

    def _project(self, claims: Json) -> str:
        """Return the project; where a claim names projects, a token without it is refused."""
        claim = self._settings.project_claim
        if not claim:
            return COMMON
        project = _claim(claims, claim)
        if not isinstance(project, str) or PROJECT.fullmatch(project) is None:
            raise Unauthorised.of(f"This token names no project in its claim {claim!r}.")
        return project


def _claim(claims: Json, path: str) -> Any:
    """Return a claim by its name, or by the names on the way to it; None if there is none."""
    if path in claims:
        return claims[path]
    value: Any = claims
    for part in path.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return value
