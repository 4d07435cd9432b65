"""Bodies are condensed once in a run of the tests: what their laws are about comes after them.

Analyses that are given no cache condense both gears each time, which is most of what a small one costs. All
tests share the results, each still said to be computed. The laws of condensing itself are in
tests/unit/fe_contact/compliance, whose conftest has a `condensed_once` that shares nothing.
"""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any

import pytest

from fe_contact.compliance import FlankCompliance, FlankCompliance3D, cyclic_compliance, flank_compliance_2d
from fe_contact.compliance.cache import read_compliance, write_compliance

FOLDER = "LOA_TEST_CONDENSED_BODIES"
"""Names the folder to a warm process."""


@pytest.fixture(scope="session")
def condensed_bodies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where they are kept while the tests run, by all processes."""
    own = tmp_path_factory.getbasetemp()
    return (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "condensed_bodies"


@pytest.fixture(scope="module", autouse=True)
def condensed_once(condensed_bodies: Path) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        condense_once(condensed_bodies, patch)
        yield


def warm_up() -> None:
    """Let the workers that a warm process forks condense once too."""
    condense_once(Path(os.environ[FOLDER]), pytest.MonkeyPatch())


def find_condensed(bodies: Path, home: Path) -> None:
    """Let a program that keeps its results below `home` find the bodies, and keep its own among them."""
    for folder in (bodies, home):
        folder.mkdir(parents=True, exist_ok=True)
    (home / "compliance").symlink_to(bodies)


def condense_once(folder: Path, patch: pytest.MonkeyPatch) -> None:
    plane, face = flank_compliance_2d, cyclic_compliance
    for module, name, key, kind in (
        (plane, "compute_flank_compliance", plane.compliance_key, FlankCompliance),
        (face, "compute_flank_compliance_3d", face.compliance_key_3d, FlankCompliance3D),
    ):
        patch.setattr(module, name, _kept(getattr(module, name), key, kind, folder))


def _kept(
    compute: Callable[..., Any], key_of: Callable[..., str], kind: type[Any], folder: Path
) -> Callable[..., Any]:
    @wraps(compute)
    def found(*asked: Any, **reports: Any) -> Any:
        key = key_of(*asked)
        result = read_compliance(folder, key, kind)
        if result is None:
            result = compute(*asked, **reports)
            write_compliance(folder, key, result)
        return replace(result, from_cache=False)

    return found
