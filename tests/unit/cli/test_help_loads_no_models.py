"""The help of all verbs comes from rows: it loads no model of inputs, which cost a second of start."""

import subprocess
import sys

CODE = """
import sys
from lineofaction.cli import main
sys.argv = ["loa", "--help"]
try:
    main()
finally:
    print(sorted(name for name in ("numpy", "pydantic") if name in sys.modules))
"""


def test_the_help_names_every_verb_without_models() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
    for verb in ("analyze", "sensitivity", "noise", "steady"):
        assert f"\n  {verb}" in done.stdout
