"""Settings of the service that are refused, or read as unset, at its start."""

from __future__ import annotations

from pathlib import Path

import pytest

from lineofaction.gearbox.problems import BadInput
from service.settings import load_settings


@pytest.mark.parametrize("address", ["tcp://gears.example:8786", "ws://[2001:db8::1]:8786"])
def test_plain_text_beyond_this_machine_is_refused_unless_said(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
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


def test_an_empty_name_of_the_key_file_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compose passes variables that are not set as empty ones."""
    monkeypatch.setenv("LOA_KEYS_FILE", "")
    assert load_settings(data_directory=tmp_path).key_file == tmp_path / "keys.json"
