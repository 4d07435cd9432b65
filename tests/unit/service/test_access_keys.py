"""Access keys: what is kept, who is let in, how often."""

from __future__ import annotations

import json
import stat
from pathlib import Path

import pytest

from service.access import AccessKey, KeyFile, Keyring, RateLimits, open_keyring
from service.problems import BadInput
from service.settings import Settings


def a_key(limit: int | None, name: str = "bench") -> AccessKey:
    return AccessKey(name, name.encode().hex().ljust(64, "0"), "2026-01-01T00:00:00Z", limit)


def test_a_key_opens_and_is_nowhere_on_disk(tmp_path: Path) -> None:
    file = KeyFile(tmp_path / "keys.json")
    secret = file.add("bench", requests_per_minute=60)
    assert len(secret) >= 43, "256 bits"
    assert secret not in file.path.read_text()
    holder = Keyring(file).holder(secret)
    assert holder is not None
    assert (holder.name, holder.requests_per_minute, holder.unfinished_jobs) == ("bench", 60, None)


def test_only_its_owner_reads_the_file_whatever_the_mask(tmp_path: Path) -> None:
    file = KeyFile(tmp_path / "keys.json")
    file.add("a")
    file.add("b")
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600
    assert list(tmp_path.iterdir()) == [file.path], "nothing is left beside it"


@pytest.mark.parametrize(
    "change", [lambda k: k[:-1], lambda k: k + "A", str.upper, lambda k: "", lambda k: k[4:]]
)
def test_anything_but_the_key_is_nobody(tmp_path: Path, change) -> None:  # type: ignore[no-untyped-def]
    file = KeyFile(tmp_path / "keys.json")
    assert Keyring(file).holder(change(file.add("bench"))) is None


def test_every_key_is_compared_whichever_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """How long an answer takes must not tell which keys there are."""
    file = KeyFile(tmp_path / "keys.json")
    secrets = [file.add(f"k{number}") for number in range(5)]
    keyring = Keyring(file)
    seen: list[str] = []

    def compare(a: str, b: str) -> bool:
        seen.append(b)
        return a == b

    monkeypatch.setattr("service.access.keyring.hmac.compare_digest", compare)
    for presented in (secrets[0], secrets[4], "nobody"):
        seen.clear()
        keyring.holder(presented)
        assert len(seen) == 5


def test_a_key_taken_back_opens_no_more_and_a_new_one_at_once(tmp_path: Path) -> None:
    file = KeyFile(tmp_path / "keys.json")
    old = file.add("old")
    keyring = Keyring(file)
    new = file.add("new")
    assert keyring.holder(new) is not None
    file.remove("old")
    assert keyring.holder(old) is None
    assert keyring.holder(new) is not None


def test_a_file_spoilt_meanwhile_opens_nothing_and_shuts_nobody_out(tmp_path: Path) -> None:
    file = KeyFile(tmp_path / "keys.json")
    secret = file.add("bench")
    keyring = Keyring(file)
    file.path.write_text("{")
    assert keyring
    assert keyring.holder(secret) is not None
    assert keyring.holder("nobody") is None


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"keys": [{}]}',
        '{"keys": [{"name": "a", "sha256": "12", "created": ""}]}',
        json.dumps({"keys": [{"name": "a", "sha256": "0" * 64, "created": "", "unfinished_jobs": 0}]}),
    ],
)
def test_a_spoilt_file_is_never_one_without_keys(tmp_path: Path, text: str) -> None:
    path = tmp_path / "keys.json"
    path.write_text(text)
    with pytest.raises(BadInput, match="keys_file"):
        Keyring(KeyFile(path))


@pytest.mark.parametrize("name", ["", "-a", "a b", "a" * 65, "ä", "a\n"])
def test_a_name_that_would_spoil_a_log_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(BadInput, match="name"):
        KeyFile(tmp_path / "keys.json").add(name)


def test_names_are_taken_once_and_limits_allow_something(tmp_path: Path) -> None:
    file = KeyFile(tmp_path / "keys.json")
    file.add("a")
    with pytest.raises(BadInput, match="must be new"):
        file.add("a")
    with pytest.raises(BadInput, match="requests_per_minute = 0"):
        file.add("b", requests_per_minute=0)
    with pytest.raises(BadInput, match="one of the keys: a"):
        file.remove("b")


def test_over_any_time_no_more_pass_than_a_minutes_worth_and_the_rate() -> None:
    instant = 0.0
    limits = RateLimits(clock=lambda: instant)
    passed = 0
    for _ in range(6000):  # ten a second for ten minutes
        passed += limits.wait_s(a_key(30)) == 0
        instant += 0.1
    assert passed == pytest.approx(30 + 30 * 10, abs=1)


def test_who_waits_as_long_as_told_is_let_in() -> None:
    instant = 0.0
    limits = RateLimits(clock=lambda: instant)
    while (wait := limits.wait_s(a_key(7))) == 0:
        pass
    assert 0 < wait <= 9
    instant += wait
    assert limits.wait_s(a_key(7)) == 0


def test_keys_do_not_use_up_one_another() -> None:
    limits = RateLimits(clock=lambda: 0.0)
    while limits.wait_s(a_key(3, "busy")) == 0:
        pass
    assert limits.wait_s(a_key(3, "idle")) == 0
    assert all(limits.wait_s(a_key(None, "free")) == 0 for _ in range(1000))


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org"])
def test_an_address_that_others_reach_needs_a_key(tmp_path: Path, host: str) -> None:
    settings = Settings(host=host, data_directory=tmp_path)
    with pytest.raises(BadInput, match="loa keys add"):
        open_keyring(settings)
    KeyFile(settings.key_file).add("bench")
    assert open_keyring(settings)
    assert not open_keyring(Settings(data_directory=tmp_path / "other"))
