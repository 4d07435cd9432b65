"""`loa` computes in one thread, unless its environment says otherwise."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from host import ONE_THREAD

CALLED = """
import json, os, sys
from lineofaction.cli import commands
commands.app = lambda: print(json.dumps([dict(os.environ), "numpy" in sys.modules]))
commands.main()
"""


@pytest.mark.parametrize("set_by_user", [{}, {"OMP_NUM_THREADS": "3"}], ids=["nothing set", "three threads"])
def test_libraries_find_it_before_they_are_loaded(set_by_user: dict[str, str]) -> None:
    bare = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(
        [sys.executable, "-c", CALLED], env=bare | set_by_user, capture_output=True, text=True, check=True
    )
    environment, loaded = json.loads(done.stdout)
    assert not loaded
    found = {name: environment[name] for name in ONE_THREAD if name in environment}
    assert found == (set_by_user or ONE_THREAD)
