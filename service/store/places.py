"""The database and the store of results by the settings of a service."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote, urlsplit

from sqlalchemy import Engine

from lineofaction.gearbox.problems import BadInput
from service.store.database import open_database
from service.store.deployment import Deployment
from service.store.files import DirectoryFiles, ResultFiles
from service.store.object_files import Keys, object_files
from service.store.results import ResultStore

DATABASE_FILE = "service.sqlite3"
RESULTS_DIRECTORY = "results"
CACHE_DIRECTORY = "cache"
DEFAULT_CACHE_MB = 10_000


def result_files(
    data_directory: Path,
    results_url: str | None = None,
    cache_mb: int = DEFAULT_CACHE_MB,
    keys: Keys | None = None,
) -> ResultFiles:
    """Return the place of result files: in the data directory, ``file:///FOLDER``, or ``s3://BUCKET/PREFIX``.

    `keys` are the credentials of the bucket; None: those of the AWS_ variables.

    Raises `BadInput`: the URL has none of these forms.
    """
    if results_url is None:
        return DirectoryFiles(data_directory / RESULTS_DIRECTORY)
    parts = urlsplit(results_url)
    if "@" in parts.netloc:
        remedy = "Credentials come from results_access_key_id and results_secret_access_key."
        raise BadInput.of("results_url", "(not shown)", "an address without credentials", remedy)
    if parts.scheme == "file" and parts.netloc in ("", "localhost") and parts.path.startswith("/"):
        return DirectoryFiles(Path(unquote(parts.path)))
    if parts.scheme == "s3" and parts.netloc:
        cache = data_directory / CACHE_DIRECTORY / RESULTS_DIRECTORY
        return object_files(results_url, cache, cache_mb * 1_000_000, keys)
    raise BadInput.of("results_url", results_url, "s3://bucket/prefix or file:///folder")


def result_store(
    engine: Engine,
    data_directory: Path,
    results_url: str | None = None,
    cache_mb: int = DEFAULT_CACHE_MB,
    keys: Keys | None = None,
) -> ResultStore:
    """Return the store whose index is in a database; parameters of `result_files`.

    Raises `BadInput` as `result_files`, or the files are not those of the database: see
    `service.store.deployment`; `StoreUnavailable`, `DatabaseUnavailable`: the place, or the database, does
    not answer.
    """
    store = ResultStore(engine, result_files(data_directory, results_url, cache_mb, keys))
    Deployment(engine, store).confirm_files()
    return store


def stored_results(
    data_directory: Path,
    database_url: str | None = None,
    results_url: str | None = None,
) -> ResultStore:
    """Return the store of a data directory, or of the URLs, for an occasional reader."""
    engine = open_database(database_url or data_directory / DATABASE_FILE, pooled=False)
    return result_store(engine, data_directory, results_url)
