"""Access keys: what is kept, who is let in, how often."""

import json
import stat
from datetime import datetime, timedelta

import pytest
import structlog.testing
from command_line import loa

from lineofaction.gearbox.problems import BadInput
from service.access.capacity import RateLimits
from service.access.holder import Scope
from service.access.identities import open_identities
from service.access.key_file import AccessKey, KeyFile
from service.access.keyring import Keyring
from service.settings import Settings


@pytest.fixture
def file(tmp_path):
    return KeyFile(tmp_path / "keys.json")


def a_key(limit: int | None, name: str = "bench") -> AccessKey:
    digest = name.encode().hex().ljust(64, "0")
    return AccessKey(name=name, sha256=digest, created="2026-01-01T00:00:00Z", requests_per_minute=limit)


def test_a_key_opens_and_is_nowhere_on_disk(file):
    secret = file.add("bench", requests_per_minute=60)
    assert len(secret) >= 43, "256 bits"
    assert secret not in file.path.read_text()
    holder = Keyring(file).holder(secret)
    assert (holder.name, holder.requests_per_minute, holder.unfinished_jobs) == ("bench", 60, None)


def test_only_its_owner_reads_the_file_whatever_the_mask(tmp_path, file):
    file.add("a")
    file.add("b")
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600
    assert list(tmp_path.iterdir()) == [file.path], "nothing is left beside it"


@pytest.mark.parametrize(
    "change", [lambda k: k[:-1], lambda k: k + "A", str.upper, lambda k: "", lambda k: k[4:]]
)
def test_anything_but_the_key_is_nobody(file, change):
    assert Keyring(file).holder(change(file.add("bench"))) is None


def test_every_key_is_compared_whichever_it_is(file, monkeypatch):
    """How long an answer takes must not tell which keys there are."""
    secrets = [file.add(f"k{number}") for number in range(5)]
    keyring = Keyring(file)
    seen: list[str] = []

    def compare(a, b):
        seen.append(b)
        return a == b

    monkeypatch.setattr("service.access.keyring.hmac.compare_digest", compare)
    for presented in (secrets[0], secrets[4], "nobody"):
        seen.clear()
        keyring.holder(presented)
        assert len(seen) == 5


def test_a_key_taken_back_opens_no_more_and_a_new_one_at_once(file):
    old = file.add("old")
    keyring = Keyring(file)
    new = file.add("new")
    assert keyring.holder(new) is not None
    file.remove("old")
    assert keyring.holder(old) is None
    assert keyring.holder(new) is not None


def test_a_file_spoilt_meanwhile_opens_nothing_and_shuts_nobody_out(file):
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
def test_a_spoilt_file_is_never_one_without_keys(tmp_path, text):
    path = tmp_path / "keys.json"
    path.write_text(text)
    with pytest.raises(BadInput, match="keys_file"):
        Keyring(KeyFile(path))


@pytest.mark.parametrize("name", ["", "-a", "a b", "a" * 65, "ä", "a\n"])
def test_a_name_that_would_spoil_a_log_is_refused(tmp_path, name):
    with pytest.raises(BadInput, match="name"):
        KeyFile(tmp_path / "keys.json").add(name)


def test_names_are_taken_once_and_limits_allow_something(file):
    file.add("a")
    with pytest.raises(BadInput, match="must be new"):
        file.add("a")
    with pytest.raises(BadInput, match="requests_per_minute = 0"):
        file.add("b", requests_per_minute=0)
    with pytest.raises(BadInput, match="one of the keys: a"):
        file.remove("b")


def test_over_any_time_no_more_pass_than_a_minutes_worth_and_the_rate():
    instant = 0.0
    limits = RateLimits(clock=lambda: instant)
    passed = 0
    for _ in range(6000):  # ten a second for ten minutes
        passed += limits.wait_s(a_key(30)) == 0
        instant += 0.1
    assert passed == pytest.approx(30 + 30 * 10, abs=1)


def test_who_waits_as_long_as_told_is_let_in():
    instant = 0.0
    limits = RateLimits(clock=lambda: instant)
    while (wait := limits.wait_s(a_key(7))) == 0:
        pass
    assert 0 < wait <= 9
    instant += wait
    assert limits.wait_s(a_key(7)) == 0


def test_keys_do_not_use_up_one_another():
    limits = RateLimits(clock=lambda: 0.0)
    while limits.wait_s(a_key(3, "busy")) == 0:
        pass
    assert limits.wait_s(a_key(3, "idle")) == 0
    assert all(limits.wait_s(a_key(None, "free")) == 0 for _ in range(1000))


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org"])
def test_an_address_that_others_reach_needs_a_key(tmp_path, host):
    settings = Settings(host=host, data_directory=tmp_path)
    with pytest.raises(BadInput, match="loa keys add"):
        open_identities(settings)
    KeyFile(settings.key_file).add("bench")
    assert open_identities(settings)
    assert not open_identities(Settings(data_directory=tmp_path / "other"))


def rewritten(file: KeyFile, name: str, **changes: object) -> None:
    content = json.loads(file.path.read_text())
    for entry in content["keys"]:
        entry.update(changes if entry["name"] == name else {})
    file.path.write_text(json.dumps(content))


def test_a_key_of_before_there_were_scopes_may_do_what_it_did(file):
    secret = file.add("old")
    entry = json.loads(file.path.read_text())["keys"][0]
    former = {name: entry[name] for name in ("name", "sha256", "created", "requests_per_minute")}
    file.path.write_text(json.dumps({"keys": [former | {"of_a_later_program": 1}]}))
    holder = Keyring(file).holder(secret)
    assert (set(holder.scopes), holder.project, holder.expires) == (set(Scope), "", None)


@pytest.mark.parametrize(
    ("rights", "named"),
    [
        ({"scopes": ["read", "write"]}, "some of read, submit, dismiss, operate"),
        ({"scopes": []}, "some of read"),
        ({"project": "Axle"}, "small letters"),
        ({"project": "a.b"}, "small letters"),
        ({"expires": "soon"}, "hours, days or weeks"),
        ({"expires": "0d"}, "hours, days or weeks"),
        ({"streams": 0}, "at least 1"),
        ({"connections": -1}, "at least 1"),
    ],
)
def test_rights_that_are_none_are_refused(file, rights, named):
    with pytest.raises(BadInput, match=named):
        file.add("bench", **rights)
    assert file.read() == ()


@pytest.mark.parametrize(
    "spoilt", [{"scopes": ["all"]}, {"project": "../x"}, {"expires": "2026-01-01T00:00:00"}, {"expires": "x"}]
)
def test_a_right_that_cannot_be_read_is_not_left_out(file, spoilt):
    file.add("bench")
    rewritten(file, "bench", **spoilt)
    with pytest.raises(BadInput, match="keys_file"):
        file.read()


@pytest.mark.parametrize(("text", "hours"), [("12h", 12), ("90d", 2160), ("2w", 336)])
def test_a_key_ends_after_the_time_it_was_made_for(file, text, hours):
    file.add("bench", expires=text)
    (key,) = file.read()
    end = datetime.fromisoformat(key.created) + timedelta(hours=hours)
    assert not key.ends_within(timedelta(0), end - timedelta(seconds=1))
    assert key.ends_within(timedelta(0), end)
    assert not key.expired


def test_rotation_leaves_the_old_key_the_overlap_and_the_new_one_all_rights(file):
    old = file.add("bench", project="axle", scopes=["read"], expires="90d", streams=3)
    new = file.rotate("bench", overlap="7d")
    keyring = Keyring(file)
    before, after = keyring.holder(old), keyring.holder(new)
    for key in (before, after):
        assert (key.name, key.project, key.scopes, key.streams) == ("bench", "axle", (Scope.READ,), 3)
    assert before.ends_within(timedelta(days=7)) and not before.ends_within(timedelta(days=6, hours=23))
    assert after.ends_within(timedelta(days=90)) and not after.ends_within(timedelta(days=89, hours=23))
    file.remove("bench")
    assert file.read() == ()


def test_rotation_without_an_overlap_ends_the_old_key(file):
    old = file.add("bench")
    new = file.rotate("bench")
    assert Keyring(file).holder(old) is None
    assert Keyring(file).holder(new) is not None
    assert [key.expires for key in file.read()] == [None]


def test_rotation_makes_no_key_live_longer(file):
    file.add("bench", expires="1h")
    end = file.read()[0].expires
    file.rotate("bench", overlap="7d", expires="90d")
    assert file.read()[0].expires == end
    with pytest.raises(BadInput, match="one of the keys: bench"):
        file.rotate("other")


def test_both_keys_of_a_rotation_share_one_rate(tmp_path):
    file, limits = KeyFile(tmp_path / "keys.json"), RateLimits(clock=lambda: 0.0)
    file.add("bench", requests_per_minute=3)
    file.rotate("bench", overlap="1d")
    keys = file.read()
    assert [limits.wait_s(keys[n % 2]) == 0 for n in range(5)] == [True, True, True, False, False]


def test_a_key_that_ends_soon_is_mentioned_once_a_day(file):
    soon, later = file.add("soon", expires="6d"), file.add("later", expires="8d")
    keyring = Keyring(file)
    with structlog.testing.capture_logs() as lines:
        for secret in (soon, later, soon):
            keyring.holder(secret)
    assert [(line["event"], line["key"]) for line in lines] == [("key ends soon", "soon")]


def test_the_verbs_show_rights_and_never_a_hash(tmp_path):
    path = tmp_path / "keys.json"

    def verb(*arguments):
        shown = loa("keys", *arguments, "--file", path, "--json")
        assert shown.exit_code == 0, shown.output
        return shown.stdout

    made = json.loads(
        verb("add", "bench", "--scopes", "read, submit", "--project", "axle", "--expires", "1w")
    )
    renewed = json.loads(verb("rotate", "bench", "--overlap", "1d"))
    assert made["key"] != renewed["key"]
    listed = verb("list")
    first, second = json.loads(listed)["keys"]
    assert first["scopes"] == second["scopes"] == ["read", "submit"]
    assert (first["project"], first["expires"] < second["expires"]) == ("axle", True)
    assert "sha256" not in listed
