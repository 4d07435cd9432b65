"""Settings of the service that are refused, or read as unset, at its start."""

import pytest
import structlog.testing

from lineofaction.gearbox.problems import BadInput
from service.settings import _FORMER, Settings, load_settings, note_former_settings


@pytest.mark.parametrize("address", ["tcp://gears.example:8786", "ws://[2001:db8::1]:8786"])
def test_plain_text_beyond_this_machine_is_refused_unless_said(address, monkeypatch):
    """Who reaches the port runs code with the rights of the service."""
    monkeypatch.setattr("service.settings.find_spec", lambda _: object())
    with pytest.raises(BadInput) as caught:
        load_settings(scheduler=address)
    (fault,) = caught.value.faults
    assert fault.field == "scheduler" and fault.bound.startswith("tls:// beyond this machine")
    for local in ("tcp://127.0.0.1:8786", "tcp://localhost:8786", "tcp://[::1]:8786"):
        assert load_settings(scheduler=local).scheduler == local
    monkeypatch.setenv("LOA_SCHEDULER_UNENCRYPTED", "true")
    assert load_settings(scheduler=address).scheduler == address


def test_an_empty_name_of_the_key_file_is_none(tmp_path, monkeypatch):
    """Compose passes variables that are not set as empty ones."""
    monkeypatch.setenv("LOA_KEYS_FILE", "")
    assert load_settings(data_directory=tmp_path).key_file == tmp_path / "keys.json"


def test_settings_of_earlier_versions_are_named_in_one_line(monkeypatch):
    """Else jobs would run on this machine, and nobody would know why."""
    monkeypatch.setenv("LOA_DASK_SCHEDULER", "tls://gears.example:8786")
    monkeypatch.setenv("LOA_LEASE_S", "60")
    with structlog.testing.capture_logs() as lines:
        note_former_settings()
    (line,) = lines
    assert (line["event"], line["log_level"]) == ("settings without effect", "warning")
    assert line["settings"]["LOA_DASK_SCHEDULER"] == "It is LOA_SCHEDULER."
    assert "one server owns a job table" in line["settings"]["LOA_LEASE_S"]


def test_a_former_setting_is_no_setting_and_an_empty_one_is_none(monkeypatch):
    fields = {f"LOA_{name.upper()}" for name in Settings.model_fields}
    assert not fields & set(_FORMER)
    for name in _FORMER:
        monkeypatch.setenv(name, "")
    with structlog.testing.capture_logs() as lines:
        note_former_settings()
    assert lines == []
