"""Bearer tokens of an issuer: what is let in, what is refused, and when the issuer is asked."""

import base64
import hashlib
import hmac
import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import jwt
import pytest
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from fastapi.testclient import TestClient
from httpx2 import Response
from service_fakes import EXECUTION, REGISTRY

from lineofaction.gearbox.problems import BadInput, IssuerUnavailable, KeyExpired, MissingScope, Unauthorised
from service.access import identities as issuer_module
from service.access.identities import open_identities
from service.access.issuer import FRESH_S, PAUSE_S, STALE_S
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

Json = dict[str, Any]
AUDIENCE = "gears"


@cache
def _key(_name: str) -> rsa.RSAPrivateKey:
    """Return a key of its own for each name: to make one takes a tenth of a second."""
    return rsa.generate_private_key(public_exponent=65537, key_size=2048)


class LocalIssuer:
    """Signs tokens and publishes the keys for them; `asked` are the paths that were fetched."""

    def __init__(self, url: str) -> None:
        self.url, self.asked, self.answers = url, list[str](), True
        self.changes: Json = {}
        self._keys: dict[str, rsa.RSAPrivateKey] = {}
        self.rotate("key-1")

    def rotate(self, kid: str) -> None:
        self._keys = {kid: _key(kid)}

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
        other = _key("another")
        return jwt.encode(self.claims(), other, "RS256", headers={"kid": self.kid})

    def pointing(self) -> str:
        """Return a token with its own key, and the address of one, in its head."""
        other = _key("another")
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
        def do_GET(self):
            issuer.asked.append(self.path)
            document = issuer.document(self.path) if issuer.answers else None
            content = json.dumps(document).encode()
            self.send_response(200 if document else 500)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_arguments):
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


@pytest.fixture
def issuer(monkeypatch):
    with local_issuer() as found:
        monkeypatch.setenv("LOA_OIDC_ISSUER", found.url)
        monkeypatch.setenv("LOA_OIDC_AUDIENCE", AUDIENCE)
        monkeypatch.setenv("LOA_OIDC_PROJECT_CLAIM", "team")
        yield found


class Clock:
    """A clock that tests move."""

    def __init__(self) -> None:
        self.s = 1e6

    def __call__(self) -> float:
        return self.s


@pytest.fixture
def clock(monkeypatch):
    found = Clock()
    monkeypatch.setattr(issuer_module.Issuer.__init__, "__defaults__", (None, found))
    return found


@pytest.fixture
def http(issuer, clock, tmp_path):
    settings = Settings(data_directory=tmp_path / "data")
    with TestClient(create_app(settings, REGISTRY, works=False), raise_server_exceptions=False) as found:
        yield found


def ask(http: TestClient, token: str, path: str = "/v1/jobs") -> Response:
    return http.get(path, headers={"Authorization": f"Bearer {token}"})


def test_claims_are_name_project_and_scopes(http, issuer):
    bearing = {"Authorization": f"Bearer {issuer.token()}"}
    job = http.post(EXECUTION, json={"inputs": {"wish": {}}}, headers=bearing).headers["location"]
    assert http.get(job, headers=bearing).status_code == 200
    assert http.delete(job, headers=bearing).json()["type"] == MissingScope.type, "no loa:dismiss"
    assert ask(http, issuer.token(team="drum"), job).status_code == 404
    assert ask(http, issuer.token(scope=["loa:read"]), job).status_code == 200, "a list as well"
    for scope in ("read submit", "openid", None, 3):
        assert ask(http, issuer.token(scope=scope), job).status_code == 403, scope


BAD: dict[str, Callable[[LocalIssuer], str]] = {
    "wrong audience": lambda i: i.token(aud="others"),
    "no audience": lambda i: i.token(aud=None),
    "wrong issuer": lambda i: i.token(iss="https://login.example"),
    "no issuer": lambda i: i.token(iss=None),
    "no end": lambda i: i.token(exp=None),
    "algorithm none": lambda i: i.unsigned(),
    "HMAC with the public key": lambda i: i.confused(),
    "signed by another": lambda i: i.foreign(),
    "its own key in its head": lambda i: i.pointing(),
    "an algorithm that is not allowed": lambda i: i.token("RS512"),
    "an unknown key": lambda i: i.token(kid="key-0"),
    "not yet": lambda i: i.token(nbf=4_000_000_000),
    "no name": lambda i: i.token(sub=None),
    "no project": lambda i: i.token(team=None),
    "the common project": lambda i: i.token(team=""),
    "a project that is none": lambda i: i.token(team="../axle"),
    "changed": lambda i: i.token()[:-6] + "AAAAAA",
    "no token": lambda i: "a.b.c",
    "nothing of the kind": lambda i: "\xff",
}


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD)
def test_what_is_not_good_is_refused(http, issuer, bad):
    assert ask(http, issuer.token()).status_code == 200
    header = b"Bearer " + bad(issuer).encode("latin-1")
    answer = http.get("/v1/jobs", headers={"Authorization": header})
    assert (answer.status_code, answer.json()["type"]) == (401, Unauthorised.type)
    assert answer.headers["www-authenticate"] == 'Bearer error="invalid_token"'
    assert "/elsewhere" not in issuer.asked, "an address in a token is not followed"


def test_an_expired_token_says_so(http, issuer):
    answer = ask(http, issuer.token(exp=1_700_000_000))
    assert (answer.status_code, answer.json()["type"]) == (401, KeyExpired.type)


def test_keys_are_fetched_once_and_anew_when_they_rotate(http, issuer, clock):
    old = issuer.token()
    assert [ask(http, old).status_code for _ in range(5)] == [200] * 5
    assert issuer.asked == ["/.well-known/openid-configuration", "/keys"]
    issuer.rotate("key-2")
    assert ask(http, issuer.token()).status_code == 401, "just asked"
    clock.s += PAUSE_S
    assert ask(http, issuer.token()).status_code == 200
    assert ask(http, old).status_code == 401, "no longer published"


def test_made_up_keys_do_not_make_us_ask_the_issuer(http, issuer, clock):
    for number in range(20):
        assert ask(http, issuer.token(kid=f"made-up-{number}")).status_code == 401
        clock.s += PAUSE_S / 10
    assert len(issuer.asked) <= 2 * 3


def test_an_issuer_that_is_down_holds_nobody_up_for_a_day(http, issuer, clock):
    token = issuer.token()
    assert ask(http, token).status_code == 200
    issuer.answers = False
    clock.s += FRESH_S + 1.0
    assert ask(http, token).status_code == 200
    assert ask(http, issuer.token(kid="newer")).json()["type"] == IssuerUnavailable.type
    clock.s += STALE_S
    refused = ask(http, token)
    assert (refused.status_code, refused.json()["type"]) == (503, IssuerUnavailable.type)
    assert refused.headers["retry-after"]
    issuer.answers = True
    clock.s += PAUSE_S
    assert ask(http, token).status_code == 200


@pytest.mark.parametrize(
    ("field", "value"),
    [("issuer", "https://login.example"), ("jwks_uri", "http://localhost:{port}/keys"), ("jwks_uri", 3)],
)
def test_keys_come_from_the_issuer_alone(http, issuer, field, value):
    port = issuer.url.rpartition(":")[2]
    issuer.changes = {field: value.format(port=port) if isinstance(value, str) else value}
    assert ask(http, issuer.token()).json()["type"] == IssuerUnavailable.type
    assert "/keys" not in issuer.asked


def test_keys_of_the_file_are_good_beside_tokens(http, issuer, tmp_path):
    key = KeyFile(tmp_path / "data" / "keys.json").add("bench", scopes=["operate"])
    assert ask(http, key, "/metrics").status_code == 200
    assert ask(http, "loa_guessed").status_code == 401
    assert http.get("/v1/jobs").status_code == 401
    assert issuer.asked == []


def test_claims_inside_claims(issuer, tmp_path, monkeypatch):
    for name, claim in (
        ("NAME", "user.mail"),
        ("PROJECT", "https://x.example/team"),
        ("SCOPES", "realm.roles"),
    ):
        monkeypatch.setenv(f"LOA_OIDC_{name}_CLAIM", claim)
    monkeypatch.setenv("LOA_OIDC_SCOPE_PREFIX", "")
    settings = Settings(data_directory=tmp_path)
    claims = {"user": {"mail": "a@b"}, "https://x.example/team": "axle", "realm": {"roles": ["read"]}}
    with TestClient(create_app(settings, REGISTRY, works=False)) as http:
        assert ask(http, issuer.token(**claims)).status_code == 200
        assert ask(http, issuer.token(**claims | {"user": "a@b"})).status_code == 401
        assert ask(http, issuer.token(**claims | {"realm": []})).status_code == 403


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ISSUER", "http://login.example"),
        ("ISSUER", "https://user:word@login.example"),
        ("ISSUER", "login.example"),
        ("KEYS_URL", "ftp://127.0.0.1/keys"),
        ("ALGORITHMS", "RS256,HS256"),
        ("ALGORITHMS", "none"),
        ("ALGORITHMS", ""),
        ("AUDIENCE", ""),
    ],
)
def test_settings_that_let_others_in_are_refused(issuer, tmp_path, monkeypatch, name, value):
    monkeypatch.setenv(f"LOA_OIDC_{name}", value)
    with pytest.raises(BadInput, match="oidc_"):
        open_identities(Settings(data_directory=tmp_path))


def test_an_issuer_is_enough_to_be_reached_by_others(issuer, tmp_path):
    assert open_identities(Settings(host="0.0.0.0", data_directory=tmp_path))
