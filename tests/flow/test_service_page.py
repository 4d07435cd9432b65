"""What the page on the service shows with curl works as shown, against a service that runs."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from condensed_once import find_condensed

from fe_contact.ste import SteDatabase

PAGE = (Path(__file__).parents[2] / "docs" / "service.md").read_text(encoding="utf-8")
STEPS = re.findall(r"```sh\n(.*?)```", PAGE.partition("## First steps")[2].partition("\n## ")[0], re.DOTALL)
ADDRESS = "http://127.0.0.1:8321"


@pytest.fixture
def address(tmp_path, condensed_bodies):
    """A service, started as the page says but on a free port."""
    find_condensed(condensed_bodies, tmp_path / "data")
    environment = os.environ | {"OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(tmp_path / "cache")}
    command = [sys.executable, "-m", "lineofaction.cli", "serve", "--port", "0"]
    command += ["--data-directory", str(tmp_path / "data")]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().split()[-1]
        finally:
            process.terminate()


@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not here")
def test_the_first_steps_work_with_curl(tmp_path, address):
    start, *steps = STEPS
    assert start.strip() == "loa serve"
    assert len(steps) == 3 and ADDRESS in steps[0]
    script = "set -eo pipefail\n" + "\necho ----\n".join(steps).replace("curl -s", "curl -sf")
    done = subprocess.run(
        ["bash", "-c", script.replace(ADDRESS, address)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    submitted, results, asked = done.stdout.split("----\n")
    assert '"status":"successful"' in submitted and "event: status" in submitted
    table = SteDatabase.from_netcdf(tmp_path / "ste.nc")
    assert json.loads(results)["database"]["href"] == f"/v1/results/{table.metadata.content_hash}"
    force, curves = (json.loads(line) for line in asked.splitlines())
    expected = table.force_at([0.0, 0.25], [5e-6, 7.5e-6]).force.tolist()
    assert force["force_n"] == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert [curve["torque_n_m"] for curve in curves["curves"]] == [pytest.approx(100.0, rel=1e-12, abs=0.0)]
