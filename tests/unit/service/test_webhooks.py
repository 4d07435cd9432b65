"""Calls about jobs: claims on each database, addresses that may be called, settings, signatures."""

import base64
import socket
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from running_service import Bench

from lineofaction.gearbox.problems import BadInput
from service.origin import Origin
from service.settings import Settings, load_settings, secret_bytes
from service.webhooks import calls, requests
from service.webhooks.calls import Calls
from service.webhooks.deliverer import signed_headers

SECRET = "whsec_" + base64.b64encode(bytes(32)).decode()


def succeeded(machine: Bench, text: str) -> str:
    job = machine.submit(text=text)
    claim = machine.claimed()
    machine.claims.succeed(claim)
    return job.id


def test_a_call_is_claimed_once_and_an_origin_has_one_at_a_time(machine):
    made = Calls(machine.engine)
    jobs = [succeeded(machine, str(n)) for n in range(4)]
    for n, job in enumerate(jobs):
        for _ in range(2):  # a request that is sent again
            made.enter(job, {"success": f"https://host{n % 2}.example/"})
    with ThreadPoolExecutor(8) as pool:
        claims = [claim for claim in pool.map(lambda _: made.claim(), range(16)) if claim is not None]
    assert sorted(claim.uri for claim in claims) == ["https://host0.example/", "https://host1.example/"]
    made.deliver(claims[0], "taken")
    following = made.claim()
    assert following is not None and following.uri == claims[0].uri and following.job != claims[0].job
    assert made.claim() is None


def test_a_call_whose_maker_died_is_made_again_and_late_news_of_it_are_ignored(machine, monkeypatch):
    monkeypatch.setattr(calls, "LEASE_S", -1.0)  # over at once
    made, job = Calls(machine.engine), succeeded(machine, "a")
    made.enter(job, {"success": "https://host.example/"})
    first, again = made.claim(), made.claim()
    assert (first.id, first.attempts, again.attempts) == (again.id, 1, 2)
    made.deliver(first, "late")
    assert [(call.state, call.message) for call in made.of(job)] == [("waiting", "")]
    made.deliver(again, "taken")
    assert [(call.state, call.message) for call in made.of(job)] == [("delivered", "taken")]
    assert made.claim() is None


def test_calls_wait_for_the_state_of_their_job_and_for_each_other(machine):
    made, job = Calls(machine.engine), machine.submit(text="a")
    uris = dict.fromkeys(("inProgress", "success", "failed"), "https://host.example/")
    made.enter(job.id, uris)
    assert made.claim() is None
    claim = machine.claimed()
    progress = made.claim()
    assert progress is not None and progress.event == "inProgress"
    machine.claims.succeed(claim)
    assert made.claim() is None  # until the first one is settled
    made.deliver(progress, "taken")
    success = made.claim()
    assert success is not None and success.event == "success"
    made.deliver(success, "taken")
    assert made.claim() is None
    assert {call.event: call.state for call in made.of(job.id)} == {
        "inProgress": "delivered",
        "success": "delivered",
        "failed": "skipped",
    }


def test_pauses_grow_and_end(machine, monkeypatch):
    made, job = Calls(machine.engine), succeeded(machine, "a")
    made.enter(job, {"success": "https://host.example/"})
    call = made.claim()
    assert call is not None
    made.fail(call, "away")
    assert made.claim() is None  # for five seconds
    assert made.of(job)[0].state == "waiting"
    monkeypatch.setattr(calls, "FIRST_PAUSE_S", 0.0)
    made, job = Calls(machine.engine), succeeded(machine, "b")
    made.enter(job, {"success": "https://other.example/"})
    attempts = 0
    while (call := made.claim()) is not None:
        made.fail(call, "away")
        attempts += 1
    assert attempts == calls.MAX_ATTEMPTS and made.of(job)[0].state == "given up"


PRIVATE = [
    *("127.0.0.1", "127.8.9.1", "0.0.0.0", "10.0.0.1", "172.16.0.1", "192.168.1.1", "169.254.169.254"),
    *("100.64.0.1", "224.0.0.1", "255.255.255.255", "198.18.0.1", "192.0.2.1", "::1", "::", "fe80::1"),
    *("fe80::1%eth0", "fc00::1", "::ffff:127.0.0.1", "::ffff:10.0.0.1", "2002:7f00:1::", "64:ff9b::7f00:1"),
    *("ff02::1", "2001:db8::1"),
]


@pytest.mark.parametrize("address", PRIVATE)
def test_no_name_leads_to_a_private_address(monkeypatch, address):
    assert not requests.is_public(address)
    entry = (socket.AF_INET, socket.SOCK_STREAM, 0, "", (address, 80))
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_args, **_more: [entry])
    with pytest.raises(requests.NotCalled, match="no public address"):
        requests.send("http://hooks.example.com/", b"", {})


@pytest.mark.parametrize("address", ["93.184.216.34", "2606:2800:220:1::1", "::ffff:93.184.216.34"])
def test_public_addresses_are_called(address):
    assert requests.is_public(address)


def test_the_address_that_was_looked_at_is_the_one_connected_to(monkeypatch):
    """A name that resolves to another address the next time is not asked a next time."""
    answers = iter(["93.184.216.34", "127.0.0.1"])
    connected: list[Any] = []

    def resolved(*_args, **_more):
        return [(socket.AF_INET, socket.SOCK_STREAM, 0, "", (next(answers), 80))]

    class Recorded(socket.socket):
        def connect(self, address):
            connected.append(address)
            raise ConnectionRefusedError

    monkeypatch.setattr(socket, "getaddrinfo", resolved)
    monkeypatch.setattr(socket, "socket", Recorded)
    with pytest.raises(requests.NotCalled, match="ConnectionRefusedError"):
        requests.send("http://hooks.example.com/", b"", {})
    assert connected == [("93.184.216.34", 80)]
    assert next(answers) == "127.0.0.1"


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"webhook_origins": "https://hooks.example.com"}, "webhook_secret"),
        ({"webhook_origins": "https://hooks.example.com", "webhook_secret": "short"}, "webhook_secret"),
        ({"webhook_secret": "whsec_AAAA"}, "webhook_secret"),
        ({"webhook_origins": "hooks.example.com", "webhook_secret": SECRET}, "webhook_origins"),
        ({"webhook_origins": "https://a.example/path", "webhook_secret": SECRET}, "webhook_origins"),
        ({"webhook_origins": "https://a.example:x", "webhook_secret": SECRET}, "webhook_origins"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(options, field):
    with pytest.raises(BadInput) as caught:
        load_settings(**options)
    assert [fault.field for fault in caught.value.faults] == [field]
    assert SECRET not in str(caught.value)


def test_origins_are_those_of_the_settings():
    settings = Settings(
        webhook_origins="https://Hooks.example.com, http://[::1]:8080/", webhook_secret=SECRET
    )
    assert settings.origins == {Origin("https", "hooks.example.com", 443), Origin("http", "::1", 8080)}
    assert settings.webhook_key == bytes(32)
    assert Settings().origins == frozenset()


def test_the_signature_is_that_of_the_standard():
    """The example of Standard Webhooks' own libraries."""
    key = secret_bytes("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw")
    headers = signed_headers(key, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1614265330, b'{"test": 2432232314}')
    assert headers["webhook-signature"] == "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE="
