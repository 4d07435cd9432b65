"""Settings of bearer tokens of an OpenID Connect issuer: from the environment (``LOA_OIDC_...``)."""

from __future__ import annotations

import ipaddress
from importlib.util import find_spec
from urllib.parse import urlsplit

from pydantic import ValidationError, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from lineofaction.gearbox.problems import BadInput, Fault

ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA")
"""Signatures that only the holder of a private key makes (RFC 7518, RFC 8037): no others can be allowed."""


class OidcSettings(BaseSettings):
    """What tokens are accepted, and what their claims mean.

    Attributes
    ----------
    issuer : str or None
        Claim ``iss`` of its tokens, and where its keys are found; None: no tokens are accepted.
    audience : str
        This service, as the claim ``aud`` names it.
    algorithms : str
        Of `ALGORITHMS`, separated by commas.
    keys_url : str or None
        Where the issuer publishes its keys, if that is on another host; None: as its configuration says.
    name_claim, project_claim, scopes_claim : str
        Claims with the caller's name, project and scopes; a path with dots leads into objects. Without a
        project claim all tokens are of the common project.
    scope_prefix : str
        Beginning of our scopes among those of others.
    """

    model_config = SettingsConfigDict(env_prefix="LOA_OIDC_", frozen=True)

    issuer: str | None = None
    audience: str = ""
    algorithms: str = "RS256,ES256"
    keys_url: str | None = None
    name_claim: str = "sub"
    project_claim: str | None = None
    scopes_claim: str = "scope"
    scope_prefix: str = "loa:"

    @property
    def allowed(self) -> list[str]:
        """The algorithms."""
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
        if parts.scheme != "https" and not (parts.scheme == "http" and _loopback(parts.hostname)):
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
    def _whole(self) -> OidcSettings:
        """Refuse an issuer whose tokens cannot be checked."""
        if self.issuer is not None and not self.audience:
            raise ValueError("given with LOA_OIDC_AUDIENCE: tokens for other services are not for this one")
        if self.issuer is not None and find_spec("jwt") is None:
            raise ValueError("left out without the extra oidc: pip install 'lineofaction[oidc]'")
        return self


def load_oidc_settings() -> OidcSettings:
    """Return the settings; raises `BadInput` of what cannot be."""
    try:
        return OidcSettings()
    except ValidationError as error:
        raise BadInput(_fault(dict(item)) for item in error.errors(include_url=False)) from None


def _fault(item: dict[str, object]) -> Fault:
    """One wrong setting."""
    location = item["loc"]
    name = str(location[0]) if isinstance(location, tuple) and location else "issuer"
    bound = str(item["msg"]).removeprefix("Value error, ")
    value = item.get("input") if isinstance(item.get("input"), str) else None
    return Fault(f"oidc_{name}", value, bound, f"It is set by LOA_OIDC_{name.upper()}.")


def _loopback(host: str) -> bool:
    """Whether only this machine answers at a host."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
