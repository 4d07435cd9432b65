"""Secrets of the settings in files: one mechanism for all, one clear error where it cannot be used."""

import os

import pytest

from lineofaction.gearbox.problems import BadInput
from service.secret_files import is_secret
from service.settings import Settings, load_settings

SECRETS = [name for name, field in Settings.model_fields.items() if is_secret(field)]
URL = "postgresql://loa:geheim@database/loa"
_VALID = {
    "database_url": "sqlite:////srv/loa.sqlite3",
    "webhook_secret": "whsec_" + 32 * "A",
    "results_access_key_id": "AKIA",
    "results_secret_access_key": "geheim",
}


@pytest.fixture
def file(tmp_path, monkeypatch):
    """The file of the database's URL, as an editor or `openssl rand` leaves it."""
    path = tmp_path / "url"
    path.write_text(URL + "\n", encoding="utf-8")
    monkeypatch.setenv("LOA_DATABASE_URL_FILE", str(path))
    return path


def test_every_secret_may_be_in_a_file(tmp_path, monkeypatch):
    for name in SECRETS:
        (tmp_path / name).write_text(_VALID[name] + "\n", encoding="utf-8")
        monkeypatch.setenv(f"LOA_{name.upper()}_FILE", str(tmp_path / name))
    settings = load_settings()
    assert {name: getattr(settings, name).get_secret_value() for name in SECRETS} == _VALID


def test_what_is_no_secret_is_not_read_from_a_file(tmp_path, monkeypatch):
    (tmp_path / "port").write_text("99")
    monkeypatch.setenv("LOA_PORT_FILE", str(tmp_path / "port"))
    assert load_settings().port == 8321


def test_an_option_comes_before_the_file(file):
    assert load_settings(database_url="sqlite:////a").database_address == "sqlite:////a"
    assert load_settings().database_address == URL
    assert file.exists()


def test_both_a_secret_and_its_file_are_refused(file, monkeypatch):
    monkeypatch.setenv("LOA_DATABASE_URL", URL)
    with pytest.raises(
        BadInput, match="in LOA_DATABASE_URL or in LOA_DATABASE_URL_FILE, not in both"
    ) as caught:
        load_settings()
    assert "geheim" not in str(caught.value) and len(caught.value.faults) == 1
    assert file.exists()


@pytest.mark.parametrize(
    ("content", "reason"),
    [(None, "No such file"), (b"", "empty"), (b"\n", "empty"), (b"\xff\xfe", "no UTF-8")],
)
def test_a_file_that_has_no_secret_is_refused(file, content, reason):
    if content is None:
        file.unlink()
    else:
        file.write_bytes(content)
    with pytest.raises(BadInput, match=f"(?s){file}.*{reason}.*LOA_DATABASE_URL_FILE"):
        load_settings()


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every file")
def test_a_file_that_may_not_be_read_is_refused(file):
    file.chmod(0)
    with pytest.raises(BadInput, match="Permission denied"):
        load_settings()
