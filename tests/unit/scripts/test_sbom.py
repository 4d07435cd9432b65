"""Bills of materials keep to the schema of their format and list what they are of."""

import json
from itertools import islice

import sbom


def test_it_lists_what_is_installed_in_its_format(monkeypatch):
    from cyclonedx.schema import SchemaVersion  # noqa: PLC0415 (two seconds that each worker would pay)
    from cyclonedx.validation.json import JsonStrictValidator  # noqa: PLC0415

    packages = (one for one in sbom.python_packages() if one["name"] != "lineofaction")
    some = [*islice(packages, 5), *islice(sbom.debian_packages(), 5)]
    monkeypatch.setattr(sbom, "python_packages", lambda: iter(some))
    monkeypatch.setattr(sbom, "debian_packages", lambda: iter(()))
    bill = sbom.bill_of_image()
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(json.dumps(bill)) is None
    assert {part["purl"] for part in some} <= {part["purl"] for part in bill["components"]}


def test_a_release_lists_what_its_lock_names_and_no_tool(monkeypatch, tmp_path):
    installed = [
        sbom.component("library", name, "1", f"pkg:pypi/{name}@1") for name in ("lineofaction", "A.b", "ruff")
    ]
    monkeypatch.setattr(sbom, "python_packages", lambda: iter(installed))
    (tmp_path / "a.lock").write_text("a-b==1 \\\n    --hash=sha256:00\nabsent==2\n", "utf-8")
    bill = sbom.bill(sbom.locked(tmp_path / "a.lock"), "library")
    assert [part["name"] for part in bill["components"]] == ["A.b"]
    assert bill["metadata"]["component"]["type"] == "library"
