"""Bearer tokens of an OpenID Connect issuer (RFC 9068, RFC 8725): checked, and read as a holder."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.problems import KeyExpired, Unauthorised
from service.access.holder import Holder, Scope
from service.access.issuer import Issuer
from service.access.oidc_settings import OidcSettings
from service.project import COMMON, PROJECT

_LEEWAY_S = 30
_LONGEST_NAME = 200
_REQUIRED = ["exp", "iss", "aud"]

Json = dict[str, Any]


class Tokens:
    """Finds the holders of tokens.

    Parameters
    ----------
    settings : OidcSettings
        With an issuer.
    issuer : Issuer
    """

    def __init__(self, settings: OidcSettings, issuer: Issuer) -> None:
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
            algorithm, identifier = self._head(jwt.get_unverified_header(token))
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

    def _head(self, head: Json) -> tuple[str, str]:
        """Return algorithm and key identifier of a token; raise ValueError of what is not allowed."""
        algorithm, identifier = head.get("alg"), head.get("kid")
        if algorithm not in self._settings.allowed or not isinstance(identifier, str):
            raise ValueError(head)
        return algorithm, identifier

    async def _key(self, identifier: str, algorithm: str) -> Json:
        """Return the issuer's key; raise ValueError if that is for another algorithm."""
        key = await self._issuer.key(identifier)
        if key.get("kty") == "oct" or key.get("alg", algorithm) != algorithm:
            raise ValueError(identifier)
        return key

    def _mapped(self, claims: Json) -> Holder:
        """Return the holder that claims describe."""
        settings = self._settings
        name = _claim(claims, settings.name_claim)
        if not isinstance(name, str) or not 0 < len(name) <= _LONGEST_NAME:
            raise Unauthorised.of(f"This token names nobody in its claim {settings.name_claim!r}.")
        return Holder(name=f"oidc:{name}", project=self._project(claims), scopes=self._scopes(claims))

    def _project(self, claims: Json) -> str:
        """Return the project; a token that should name one and does not is not of the common one."""
        named = self._settings.project_claim
        if not named:
            return COMMON
        project = _claim(claims, named)
        if not isinstance(project, str) or PROJECT.fullmatch(project) is None:
            raise Unauthorised.of(f"This token names no project in its claim {named!r}.")
        return project

    def _scopes(self, claims: Json) -> tuple[Scope, ...]:
        """Return our scopes among those of a token, written as a list or with spaces between."""
        listed = _claim(claims, self._settings.scopes_claim) or ()
        names = listed.split() if isinstance(listed, str) else listed
        prefix = self._settings.scope_prefix
        return tuple(scope for scope in Scope if isinstance(names, list | tuple) and prefix + scope in names)


def _claim(claims: Json, path: str) -> Any:
    """Return a claim by its name, or by the names on the way to it; None if there is none."""
    if path in claims:
        return claims[path]
    found: Any = claims
    for part in path.split("."):
        found = found.get(part) if isinstance(found, dict) else None
    return found
