"""The page of licenses has every locked package, and only such as let the image be passed on."""

import re

import licenses
from packaging.markers import Marker
from repository import ROOT

FREE = "MIT|BSD|Apache|PSF|Python Software Foundation|ISC|MPL|Mozilla|LGPL-3.0|GPLv2\\+"


def test_every_locked_package_is_listed_at_its_versions():
    lock = (ROOT / "requirements-dev.lock").read_text("utf-8")
    locked = set(re.findall(r"^([A-Za-z0-9._-]+)==([^ ;\n]+)", lock, flags=re.MULTILINE))
    listed = {(row[0], version) for row in licenses.rows() for version in row[1].split(", ")}
    assert locked == listed


def test_what_one_version_of_python_lacks_has_its_license_stated():
    """The page was not written with Python 3.12 and later, which some packages are not for."""
    lock = (ROOT / "requirements-dev.lock").read_text("utf-8")
    markers: dict[str, list[Marker]] = {}
    for name, marker in re.findall(r"^([\w.-]+)==[^ \n]+(?: ; ([^\\\n]+))?", lock, flags=re.MULTILINE):
        markers.setdefault(name, []).append(Marker(marker.strip() or "python_version > '3'"))
    for minor in (11, 12, 13, 14):
        python = {"python_version": f"3.{minor}", "python_full_version": f"3.{minor}.9"}
        lacking = {name for name, of in markers.items() if not any(each.evaluate(python) for each in of)}
        assert lacking <= set(licenses._STATED_ELSEWHERE), minor


def test_every_license_is_stated_and_those_of_the_service_let_it_be_passed_on_under_the_gpl():
    assert [row for row in licenses.rows() if row[2] in ("", "not stated")] == []
    in_the_image = ("service", "extra `postgres`", "extra `s3`")
    bound = [row for row in licenses.rows() if row[3] in in_the_image and re.search(FREE, row[2]) is None]
    assert bound == []
    service = [row for row in licenses.rows() if row[3] == "service"]
    assert len(service) > 40
    assert not [row for row in licenses.rows() if row[0] == "mkl"], "neither locked nor in the image"
