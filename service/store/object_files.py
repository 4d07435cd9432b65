"""Files of results in an object store that speaks S3, read through a cache on disk."""

from __future__ import annotations

import contextlib
import hashlib
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from fe_contact.cache_reads import CacheReads
from lineofaction.gearbox.problems import BadInput, StoreUnavailable
from service.folder_size import evict
from service.store.files import PARTIAL, KeptFile, WrongContent, digest_of, install_file

if TYPE_CHECKING:
    from obstore.store import ClientConfig, RetryConfig, S3Store


Keys = tuple[str, str]
"""Access key and secret of a bucket."""
RETRIES: RetryConfig = {"max_retries": 4, "retry_timeout": timedelta(seconds=10.0)}
_ENDPOINTS = ("AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT")


class ObjectFiles:
    """Objects below a prefix of a bucket.

    An object becomes visible with all its bytes (S3), a file of the cache once its digest has been compared.

    Parameters
    ----------
    store : S3Store
    address : str
        URL of bucket and prefix.
    cache : Path
        Directory of files under their digests, shared by all processes of a machine.
    cache_bytes : int
        Largest size of the cache in bytes.
    """

    def __init__(self, store: S3Store, address: str, cache: Path, cache_bytes: int) -> None:
        self._store, self.address = store, address
        self.folder: Path | None = None
        self._cache, self._cache_bytes = cache, cache_bytes
        self.reads = CacheReads()

    def put(self, name: str, file: Path, sha256: str) -> None:
        """Send the file, in parts if it is long, and keep it in the cache."""
        import obstore  # noqa: PLC0415 (an extra)

        with _answering():
            obstore.put(self._store, name, file)
        cached = self._cached(name, sha256)
        cached.parent.mkdir(parents=True, exist_ok=True)
        install_file(file, cached)
        evict(self._cache, self._cache_bytes)

    def has(self, name: str) -> bool:
        """Whether there is an object of this name."""
        import obstore  # noqa: PLC0415 (an extra)

        with _answering(), contextlib.suppress(FileNotFoundError):
            obstore.head(self._store, name)
            return True
        return False

    def local(self, name: str, sha256: str) -> Path:
        """Return the cached file, fetched if it is missing or damaged; raises as `ResultFiles.local`."""
        cached = self._cached(name, sha256)
        with contextlib.suppress(FileNotFoundError):
            if digest_of(cached) == sha256:
                os.utime(cached)
                self.reads.note(hit=True)
                return cached
        self.reads.note(hit=False)
        self._fetch(name, sha256, cached)
        evict(self._cache, self._cache_bytes)
        return cached

    def digest(self, name: str) -> str:
        """Read the object, not the cache; raises as `ResultFiles.digest`."""
        digest = hashlib.sha256()
        for piece in self._pieces(name):
            digest.update(piece)
        return digest.hexdigest()

    def note(self, name: str) -> str | None:
        """Read an object as text."""
        with contextlib.suppress(FileNotFoundError):
            return b"".join(bytes(piece) for piece in self._pieces(name)).decode()
        return None

    def put_note(self, name: str, text: str, *, replace: bool = False) -> None:
        """Send the text; without `replace` the store keeps one that it has (``If-None-Match: *``)."""
        import obstore  # noqa: PLC0415 (an extra)
        from obstore.exceptions import AlreadyExistsError  # noqa: PLC0415 (an extra)

        with _answering(), contextlib.suppress(AlreadyExistsError):
            obstore.put(self._store, name, text.encode(), mode="overwrite" if replace else "create")

    def _pieces(self, name: str) -> Iterator[memoryview]:
        import obstore  # noqa: PLC0415 (an extra)

        with _answering():
            for piece in obstore.get(self._store, name).stream():
                yield memoryview(piece)

    def _fetch(self, name: str, sha256: str, cached: Path) -> None:
        """Fetch an object into the cache, if its bytes have the digest."""
        cached.parent.mkdir(parents=True, exist_ok=True)
        draft = cached.with_name(f"{cached.name}.{uuid.uuid4().hex[:8]}{PARTIAL}")
        digest = hashlib.sha256()
        try:
            with draft.open("wb") as stream:
                for piece in self._pieces(name):
                    digest.update(piece)
                    stream.write(piece)
            if digest.hexdigest() != sha256:
                raise WrongContent
            draft.replace(cached)
        finally:
            draft.unlink(missing_ok=True)

    def _cached(self, name: str, sha256: str) -> Path:
        return self._cache / sha256[:2] / f"{sha256}{PurePosixPath(name).suffix}"

    def move(self, name: str, target: str) -> None:
        """Move an object: copy, then delete."""
        import obstore  # noqa: PLC0415 (an extra)

        with _answering(), contextlib.suppress(FileNotFoundError):
            obstore.copy(self._store, name, target)
            obstore.delete(self._store, name)

    def delete(self, name: str) -> None:
        """Delete an object."""
        import obstore  # noqa: PLC0415 (an extra)

        with _answering(), contextlib.suppress(FileNotFoundError):
            obstore.delete(self._store, name)

    def files(self) -> Iterator[KeptFile]:
        """List the objects, page by page."""
        import obstore  # noqa: PLC0415 (an extra)

        with _answering():
            for page in obstore.list(self._store):
                for entry in page:
                    yield KeptFile(entry["path"], entry["size"], entry["last_modified"].timestamp())


@contextmanager
def _answering() -> Iterator[None]:
    """Raise `StoreUnavailable` where the store does not answer or refuses us; FileNotFoundError passes."""
    from obstore.exceptions import BaseError  # noqa: PLC0415 (an extra)

    try:
        yield
    except (BaseError, PermissionError) as error:
        raise StoreUnavailable("The store of results cannot be reached. Try again later.") from error


def object_files(url: str, cache: Path, cache_bytes: int, keys: Keys | None = None) -> ObjectFiles:
    """Return the place ``s3://bucket/prefix``.

    Endpoint and region are read from the AWS_ variables, and keys, too, unless they are passed. Raises
    `BadInput`: the library is not installed, or does not accept the URL or a variable.
    """
    try:
        from obstore.exceptions import BaseError  # noqa: PLC0415 (an extra)
        from obstore.store import S3Store  # noqa: PLC0415 (an extra)
    except ModuleNotFoundError:
        tip = "Install it: pip install 'lineofaction[s3]'."
        raise BadInput.of("results_url", url, "one whose library is installed", tip) from None
    plain = any(os.environ.get(name, "").startswith("http://") for name in _ENDPOINTS)
    client: ClientConfig = {"allow_http": plain, "timeout": "60s"}
    credentials = {} if keys is None else dict(zip(("access_key_id", "secret_access_key"), keys, strict=True))
    try:
        store = S3Store.from_url(url, client_options=client, retry_config=RETRIES, **credentials)  # type: ignore[arg-type]
    except (BaseError, ValueError) as error:
        raise BadInput.of("results_url", url, f"of a bucket we can use ({error})") from None
    return ObjectFiles(store, url, cache, cache_bytes)
