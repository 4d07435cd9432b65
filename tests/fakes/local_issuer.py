"""An issuer of tokens on loopback: its own keys, its configuration, and tokens of every kind."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import jwt
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa

Json = dict[str, Any]
AUDIENCE = "gears"


class LocalIssuer:
    """Signs tokens and publishes the keys for them; `asked` are the paths that were fetched."""

    def __init__(self, url: str) -> None:
        self.url, self.asked, self.answers = url, list[str](), True
        self.changes: Json = {}
        self._keys: dict[str, rsa.RSAPrivateKey] = {}
        self.rotate("key-1")

    def rotate(self, kid: str) -> None:
        self._keys = {kid: rsa.generate_private_key(public_exponent=65537, key_size=2048)}

    @property
    def kid(self) -> str:
        (kid,) = self._keys
        return kid

    @property
    def public_pem(self) -> bytes:
        form = serialization.PublicFormat.SubjectPublicKeyInfo
        return self._keys[self.kid].public_key().public_bytes(serialization.Encoding.PEM, form)

    def claims(self, **changes: Any) -> Json:
        """Return good claims, and others; those that are None are left out."""
        instant = int(time.time())
        claims = {"iss": self.url, "aud": AUDIENCE, "sub": "ada", "iat": instant, "exp": instant + 300}
        claims |= {"scope": "openid loa:read loa:submit", "team": "axle"}
        return {name: value for name, value in (claims | changes).items() if value is not None}

    def token(self, algorithm: str = "RS256", kid: str | None = None, **changes: Any) -> str:
        head = {"kid": kid or self.kid}
        return jwt.encode(self.claims(**changes), self._keys[self.kid], algorithm, headers=head)

    def unsigned(self) -> str:
        return f"{_packed({'alg': 'none', 'kid': self.kid})}.{_packed(self.claims())}."

    def confused(self) -> str:
        """Return a token whose HMAC has the public key as its secret."""
        text = f"{_packed({'alg': 'HS256', 'kid': self.kid})}.{_packed(self.claims())}"
        return f"{text}.{_base64(hmac.new(self.public_pem, text.encode(), hashlib.sha256).digest())}"

    def foreign(self) -> str:
        """Return a token that names our key and is signed by another."""
        other = rsa.generate_private_key(public_exponent=65537, key_size=2048)
        return jwt.encode(self.claims(), other, "RS256", headers={"kid": self.kid})

    def pointing(self) -> str:
        """Return a token with its own key, and the address of one, in its head."""
        other = rsa.generate_private_key(public_exponent=65537, key_size=2048)
        own = json.loads(jwt.algorithms.RSAAlgorithm.to_jwk(other.public_key()))
        head = {"kid": "own", "jwk": own, "jku": f"{self.url}/elsewhere"}
        return jwt.encode(self.claims(), other, "RS256", headers=head)

    def document(self, path: str) -> Json | None:
        if path == "/.well-known/openid-configuration":
            return {"issuer": self.url, "jwks_uri": f"{self.url}/keys"} | self.changes
        if path != "/keys":
            return None
        public = jwt.algorithms.RSAAlgorithm.to_jwk(self._keys[self.kid].public_key())
        return {"keys": [json.loads(public) | {"kid": self.kid, "use": "sig"}]}


@contextmanager
def local_issuer() -> Iterator[LocalIssuer]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            issuer.asked.append(self.path)
            document = issuer.document(self.path) if issuer.answers else None
            content = json.dumps(document).encode()
            self.send_response(200 if document else 500)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_arguments: object) -> None:
            """Log nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    issuer = LocalIssuer(f"http://127.0.0.1:{server.server_port}")
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield issuer
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def _packed(content: Json) -> str:
    return _base64(json.dumps(content).encode())


def _base64(content: bytes) -> str:
    return base64.urlsafe_b64encode(content).decode().rstrip("=")
