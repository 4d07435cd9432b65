"""What verbs load: their help no model of inputs, an answer from the cache nothing that computes or draws."""

import os
import subprocess
import sys

import pytest
from small_table import small_table
from spur_case import spur_case

from lineofaction.cli.cached_tables import CachedTables
from lineofaction.gearbox.schemas import Case, read_model

CODE = """
import os, sys
from lineofaction.cli import main
sys.argv = ["loa", *os.environ["WORDS"].split()]
try:
    main()
finally:
    print(*sys.modules, file=sys.stderr)
"""
COMPUTING = {
    *("numba", "gmsh", "skfem", "xarray", "matplotlib", "plotly", "fastapi", "httpx2"),
    *("scipy.optimize", "scipy.interpolate", "scipy.sparse", "scipy.linalg", "scipy.special"),
    *("fe_contact.analysis", "fe_contact.contact", "fe_contact.compliance", "fe_contact.effects"),
    *("dynamics.scene", "dynamics.effects", "dynamics.mechanism"),
    *("lineofaction.gearbox.schemas.scene", "lineofaction.gearbox.studies.cost"),
}
"""Modules of 2.7 of the 3.5 CPU s that a table from the cache took."""


def after(words: str) -> tuple[str, set[str]]:
    """Return what a process of `loa` prints, and the names of the modules that it has loaded."""
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "WORDS": words},
    )
    return done.stdout, set(done.stderr.splitlines()[-1].split())


def test_the_help_names_every_verb_without_models():
    said, loaded = after("--help")
    assert not loaded & {"numpy", "pydantic", "sqlalchemy"}
    for verb in ("analyze", "sensitivity", "noise", "steady"):
        assert f"\n  {verb}" in said


@pytest.mark.parametrize("words", ["analyze {case} -o {table} --json", "ste {folder}"])
def test_an_answer_from_the_cache_loads_nothing_that_computes(words, tmp_path):
    case = tmp_path / "spur.toml"
    case.write_text(spur_case(torques=[1.0]))
    CachedTables(lambda _: small_table()).table(read_model(Case, case))
    said, loaded = after(words.format(case=case, table=tmp_path / "ste.nc", folder=tmp_path))
    assert "torque_n_m" in said or "200 N m" in said
    assert "fe_contact.ste" in loaded and not loaded & COMPUTING
