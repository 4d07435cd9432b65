"""A small object store that speaks as much S3 as the store of results uses; or another one, by its address.

LOA_TEST_S3_ENDPOINT names a server to use instead (moto, MinIO), with the AWS_ variables for its keys.
"""

import hashlib
import os
import threading
import urllib.request
import uuid
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar
from urllib.parse import parse_qs, unquote, urlsplit
from xml.sax.saxutils import escape

import pytest

KEYS = {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_REGION": "us-east-1"}


def _date() -> str:
    """Return this instant as S3 writes it."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S.000Z")


@dataclass
class Objects:
    """What is kept, and how the server misbehaves."""

    kept: dict[str, bytes] = field(default_factory=dict)
    parts: dict[str, dict[int, bytes]] = field(default_factory=dict)
    down: bool = False
    requests: list[str] = field(default_factory=list)


class _Handler(BaseHTTPRequestHandler):
    """Requests by path: /bucket/key."""

    objects: ClassVar[Objects]
    protocol_version = "HTTP/1.1"

    def _named(self) -> tuple[str, dict[str, list[str]]]:
        parts = urlsplit(self.path)
        self.objects.requests.append(f"{self.command} {self.path}")
        return unquote(parts.path), parse_qs(parts.query, keep_blank_values=True)

    def _answer(self, status: int, body: bytes = b"", **headers: str) -> None:
        if self.objects.down:
            status, body = 503, b"<Error><Code>SlowDown</Code></Error>"
        self.send_response(status)
        self.send_header("Content-Length", headers.pop("length", str(len(body))))
        self.send_header("Last-Modified", formatdate(usegmt=True))
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def _body(self) -> bytes:
        return self.rfile.read(int(self.headers.get("Content-Length", 0)))

    def do_PUT(self) -> None:
        key, query = self._named()
        body, tag = self._body(), f'"{uuid.uuid4().hex}"'
        source = self.headers.get("x-amz-copy-source")
        if "uploadId" in query:
            self.objects.parts[query["uploadId"][0]][int(query["partNumber"][0])] = body
        elif source is not None:
            name = "/" + unquote(source).lstrip("/")
            if name not in self.objects.kept:
                return self._answer(404, b"<Error><Code>NoSuchKey</Code></Error>")
            self.objects.kept[key] = self.objects.kept[name]
            copied = f"<LastModified>{_date()}</LastModified><ETag>{tag}</ETag>"
            copied = f"<CopyObjectResult>{copied}</CopyObjectResult>"
            return self._answer(200, copied.encode(), ETag=tag)
        elif self.headers.get("If-None-Match") == "*" and key in self.objects.kept:
            return self._answer(412, b"<Error><Code>PreconditionFailed</Code></Error>")
        elif not self.objects.down:
            self.objects.kept[key] = body
        return self._answer(200, ETag=tag)

    def do_POST(self) -> None:
        key, query = self._named()
        body = self._body()
        if "uploads" in query:
            upload = uuid.uuid4().hex
            self.objects.parts[upload] = {}
            begun = f"<UploadId>{upload}</UploadId>"
            begun = f"<InitiateMultipartUploadResult>{begun}</InitiateMultipartUploadResult>"
            return self._answer(200, begun.encode())
        if "delete" in query:
            names = [piece.partition("<")[0] for piece in body.decode().split("<Key>")[1:]]
            for name in names:
                self.objects.kept.pop(f"{key.rstrip('/')}/{name}", None)
            gone = "".join(f"<Deleted><Key>{name}</Key></Deleted>" for name in names)
            return self._answer(200, f"<DeleteResult>{gone}</DeleteResult>".encode())
        parts = self.objects.parts.pop(query["uploadId"][0])
        self.objects.kept[key] = b"".join(parts[number] for number in sorted(parts))
        tag = f'"{hashlib.md5(self.objects.kept[key]).hexdigest()}"'
        ended = f"<CompleteMultipartUploadResult><ETag>{tag}</ETag></CompleteMultipartUploadResult>"
        return self._answer(200, ended.encode())

    def do_GET(self) -> None:
        key, query = self._named()
        if "list-type" in query:
            return self._list(key, query.get("prefix", [""])[0])
        if key not in self.objects.kept:
            return self._answer(404, b"<Error><Code>NoSuchKey</Code></Error>")
        body = self.objects.kept[key]
        return self._answer(200, body, ETag=f'"{hashlib.md5(body).hexdigest()}"', length=str(len(body)))

    def do_HEAD(self) -> None:
        self.do_GET()

    def _list(self, bucket: str, prefix: str) -> None:
        lines = []
        for name, body in sorted(self.objects.kept.items()):
            key = name.removeprefix(bucket.rstrip("/") + "/")
            if key.startswith(prefix):
                facts = (
                    f"<Key>{escape(key)}</Key><LastModified>{_date()}</LastModified><Size>{len(body)}</Size>"
                )
                lines.append(f'<Contents>{facts}<ETag>"x"</ETag></Contents>')
        text = f"<ListBucketResult><IsTruncated>false</IsTruncated>{''.join(lines)}</ListBucketResult>"
        self._answer(200, text.encode())

    def do_DELETE(self) -> None:
        key, _ = self._named()
        self.objects.kept.pop(key, None)
        self._answer(204)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 (the parent's name)
        """Say nothing."""


@pytest.fixture
def s3_objects(monkeypatch: pytest.MonkeyPatch) -> Iterator[Objects]:
    """A running store of our own, its address and keys in the environment."""

    class Handler(_Handler):
        objects = Objects()

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, args=(0.05,))
    thread.start()
    for name, value in {**KEYS, "AWS_ENDPOINT_URL": f"http://127.0.0.1:{server.server_port}"}.items():
        monkeypatch.setenv(name, value)
    yield Handler.objects
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def s3_url(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """The URL of a new place in a bucket: of our own store, or of the one that is named."""
    bucket = f"loa-{uuid.uuid4().hex[:8]}"
    endpoint = os.environ.get("LOA_TEST_S3_ENDPOINT")
    if endpoint is None:
        request.getfixturevalue("s3_objects")
    else:
        for name, value in {**KEYS, "AWS_ENDPOINT_URL": endpoint}.items():
            monkeypatch.setenv(name, value)
        urllib.request.urlopen(urllib.request.Request(f"{endpoint}/{bucket}", method="PUT")).close()
    return f"s3://{bucket}/of/results"
