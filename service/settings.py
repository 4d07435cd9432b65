"""Settings of the service: from the environment (``LOA_...``) or the command line."""

from __future__ import annotations

import base64
import binascii
import os
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

import structlog
from pydantic import AfterValidator, Field, SecretStr, ValidationError, ValidationInfo, field_validator
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict

from host.directories import absolute, data_home
from lineofaction.gearbox.problems import BadInput, Fault
from service.origin import Origin, is_loopback
from service.secret_files import SecretFiles

MIN_MEMORY_MB = 256
"""Memory in MB that a worker needs to load the program."""
_SIGNING = "whsec_"
_SCHEDULER = re.compile(r"(?:tcp|tls|ws|wss|ucx)://[^\s/]+:[0-9]{1,5}")
_ENCRYPTED = ("tls", "wss")
_FORMER = {
    "LOA_DASK_SCHEDULER": "It is LOA_SCHEDULER.",
    "LOA_LEASE_S": "Remove it: one server owns a job table, by a lock that ends with it.",
}
"""Settings of earlier versions, and the advice on each."""
logger = structlog.get_logger(__name__)


class Settings(BaseSettings):
    """The settings of the service; a `SecretStr` may also be read from a file, see `service.secret_files`."""

    model_config = SettingsConfigDict(env_prefix="LOA_", frozen=True, extra="forbid")

    host: str = "127.0.0.1"
    port: int = Field(8321, ge=0, le=65535)
    """`host`, `port`: Address on which the service listens; beyond loopback only with access keys."""
    management_host: str = "127.0.0.1"
    management_port: int | None = Field(None, ge=0, le=65535)
    """`management_host`, `management_port`: Address that answers health, readiness and metrics without a key;
    None: no address.
    """
    data_directory: Annotated[Path, AfterValidator(absolute)] = Field(default_factory=data_home)
    """Jobs, results and the compliance cache."""
    database_url: SecretStr | None = None
    """Database of jobs and of the index of results; None: a SQLite file in the data directory."""
    results_url: str | None = None
    """Place of the files of results: ``s3://bucket/prefix`` or ``file:///folder``; None: the data directory.
    """
    results_access_key_id: SecretStr | None = None
    results_secret_access_key: SecretStr | None = Field(None, validate_default=True)
    """`results_access_key_id`, `results_secret_access_key`: Credentials of that bucket, both or none; None:
    the AWS_ variables.
    """
    results_cache_mb: int = Field(10_000, ge=1, le=1_000_000_000)
    """Largest size of the cache of files from another place, MB."""
    retention_days: float | None = Field(None, ge=1.0, le=100_000.0)
    """Days for which results and ended jobs are stored without a request for them; None: for ever."""
    quarantine_days: float = Field(7.0, ge=0.0, le=100_000.0)
    """Days for which a removed result can be restored."""
    workers: int = Field(1, ge=1, le=256)
    """Jobs that run at the same time on this machine."""
    processes: int = Field(1, ge=1, le=64)
    """Processes that answer requests."""
    queue_limit: int = Field(100, ge=1, le=100_000)
    """Computations that may wait; beyond it a submission is answered with 429."""
    body_limit: int = Field(4_000_000, ge=1_000, le=1_000_000_000)
    """Largest size of a request body in bytes; a larger one is answered with 413."""
    deadline_s: float = Field(3600.0, gt=0.0, le=1e6)
    """Longest run of one computation, s."""
    memory_limit_mb: int | None = Field(None, ge=MIN_MEMORY_MB, le=1_000_000_000)
    """Memory that one computation may have, MB; None: the machine's over the number of workers."""
    attempts: int = Field(2, ge=1, le=10)
    """Most starts of a computation whose worker died."""
    scheduler_unencrypted: bool = False
    """Whether the network between this machine and the scheduler is trusted with jobs in plain text."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers do the jobs; None: children of this machine do."""
    require_confinement: bool = False
    """Whether the service refuses to start on a system without every protection for readers of callers'
    files."""
    keys_file: Annotated[Path, AfterValidator(absolute)] | None = None
    """The file of access keys; None: ``keys.json`` in the data directory."""
    webhook_origins: str = ""
    """Origins that may be called about jobs, such as ``https://hooks.example.com``, separated by commas."""
    webhook_secret: SecretStr | None = Field(None, validate_default=True)
    """Secret that signs calls about jobs: ``whsec_`` and 24 to 64 bytes in base64."""

    @field_validator("keys_file", mode="before")
    @classmethod
    def _named_file(cls, name: object) -> object:
        """Return None for an empty variable, which as a name would be the current folder."""
        return name or None

    @field_validator("results_secret_access_key")
    @classmethod
    def _with_its_id(cls, secret: SecretStr | None, info: ValidationInfo) -> SecretStr | None:
        """Refuse one half of the credentials."""
        if (secret is None) != (info.data.get("results_access_key_id") is None):
            raise ValueError("set together with results_access_key_id")
        return secret

    @field_validator("webhook_origins")
    @classmethod
    def _listed_origins(cls, text: str) -> str:
        """Refuse a text that is no list of origins."""
        for entry in _entries(text):
            try:
                bare = urlsplit(entry).path in ("", "/") and Origin.of(entry) is not None
            except ValueError:
                bare = False
            if not bare:
                raise ValueError("origins such as https://hooks.example.com, separated by commas")
        return text

    @field_validator("webhook_secret")
    @classmethod
    def _signing(cls, secret: SecretStr | None, info: ValidationInfo) -> SecretStr | None:
        """Refuse a secret that is none, and origins without a secret."""
        if secret is None and not info.data.get("webhook_origins"):
            return None
        try:
            secret_bytes("" if secret is None else secret.get_secret_value())
        except ValueError:
            raise ValueError("whsec_ and 24 to 64 random bytes in base64, if there are origins") from None
        return secret

    @property
    def origins(self) -> frozenset[Origin]:
        """Origins that may be called about jobs."""
        return frozenset(map(Origin.of, _entries(self.webhook_origins)))

    @property
    def webhook_key(self) -> bytes:
        """The key of the signatures; raises ValueError without a secret."""
        return secret_bytes("" if self.webhook_secret is None else self.webhook_secret.get_secret_value())

    @field_validator("scheduler")
    @classmethod
    def _reachable_scheduler(cls, address: str | None, info: ValidationInfo) -> str | None:
        """Refuse an invalid address, and plain text to another machine; an empty variable is none."""
        if not address:
            return None
        if not _SCHEDULER.fullmatch(address):
            raise ValueError("protocol, host and port of a Dask scheduler, such as tcp://host:8786")
        plain = address.partition("://")[0] not in _ENCRYPTED
        if plain and not is_loopback(_host_of(address)) and not info.data.get("scheduler_unencrypted"):
            raise ValueError(
                "tls:// beyond this machine: who reaches the port runs code here. In a network that nobody "
                "else enters set LOA_SCHEDULER_UNENCRYPTED=true"
            )
        if find_spec("distributed") is None:
            raise ValueError("left out without the extra dask: pip install 'lineofaction[dask]'")
        return address

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Let options come before the environment, and that before files of secrets."""
        return init_settings, env_settings, SecretFiles(settings_cls)

    @property
    def database_address(self) -> str | None:
        """The database's URL, with its password."""
        return None if self.database_url is None else self.database_url.get_secret_value()

    @property
    def results_keys(self) -> tuple[str, str] | None:
        """The credentials of the bucket of results, which workers need: they do not inherit the variables."""
        key, secret = self.results_access_key_id, self.results_secret_access_key
        if key is not None and secret is not None:
            return key.get_secret_value(), secret.get_secret_value()
        environment_key, environment_secret = (
            os.environ.get(f"AWS_{name}") for name in ("ACCESS_KEY_ID", "SECRET_ACCESS_KEY")
        )
        return (environment_key, environment_secret) if environment_key and environment_secret else None

    @property
    def loopback(self) -> bool:
        """Whether only this machine reaches the service."""
        return is_loopback(self.host)

    @property
    def key_file(self) -> Path:
        """File of the access keys."""
        return self.keys_file or self.data_directory / "keys.json"


def _host_of(address: str) -> str:
    """Return the host of an address, of version 6 without brackets."""
    return address.partition("://")[2].rpartition(":")[0].strip("[]")


def _entries(text: str) -> list[str]:
    return [entry.strip() for entry in text.split(",") if entry.strip()]


def secret_bytes(secret: str) -> bytes:
    """Return the key of a written secret; raises ValueError unless it is 24 to 64 bytes in base64."""
    try:
        key = base64.b64decode(secret.removeprefix(_SIGNING), validate=True)
    except binascii.Error:
        raise ValueError("secret") from None
    if not secret.startswith(_SIGNING) or not 24 <= len(key) <= 64:
        raise ValueError("secret")
    return key


def note_former_settings() -> None:
    """Log in one line the environment variables that are no settings any more."""
    former = {name: remedy for name, remedy in _FORMER.items() if os.environ.get(name)}
    if former:
        logger.warning("settings without effect", settings=former)


def load_settings(**options: object) -> Settings:
    """Return the settings: `options` values that are not None, then the environment, then defaults.

    Raises `BadInput`: a value is out of bounds.
    """
    chosen = {name: value for name, value in options.items() if value is not None}
    try:
        return Settings(**chosen)  # type: ignore[arg-type]
    except ValidationError as error:
        raise BadInput(_fault(dict(item)) for item in error.errors(include_url=False)) from None


def _fault(item: dict[str, object]) -> Fault:
    location = item["loc"]
    name = str(location[0]) if isinstance(location, tuple) and location else "settings"
    bound = str(item["msg"]).removeprefix("Input should be ").removeprefix("Value error, ")
    return Fault(name, item.get("input"), bound, f"It is set by LOA_{name.upper()}, or by its option.")
