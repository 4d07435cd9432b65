"""The bill of materials of an image keeps to the schema of its format."""

import json
from itertools import islice

import sbom


def test_it_lists_what_is_installed_in_its_format(monkeypatch):
    from cyclonedx.schema import SchemaVersion  # noqa: PLC0415 (two seconds that each worker would pay)
    from cyclonedx.validation.json import JsonStrictValidator  # noqa: PLC0415

    some = [*islice(sbom.python_packages(), 5), *islice(sbom.debian_packages(), 5)]
    monkeypatch.setattr(sbom, "python_packages", lambda: iter(some))
    monkeypatch.setattr(sbom, "debian_packages", lambda: iter(()))
    bill = sbom.bill()
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(json.dumps(bill)) is None
    assert {part["purl"] for part in some} <= {part["purl"] for part in bill["components"]}
