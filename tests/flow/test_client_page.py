"""What the pages of the Python client show runs as shown; the paper's flow runs again without its service."""

import hashlib
import os
import re
import runpy
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from condensed_once import find_condensed
from repository import ROOT
from small_table import small_table

from dynamics.results import RunResult
from host.extras import MODULES
from lineofaction.client import LineOfActionClient, OfflineWarning, ResultCache
from lineofaction.gearbox.problems import BadInput

RESTS_ON = ("docs/client.md", "docs/how-to/call-a-service.md", "examples")
PAGE = (ROOT / "docs" / "client.md").read_text(encoding="utf-8")
RECIPES = (ROOT / "docs" / "how-to" / "call-a-service.md").read_text(encoding="utf-8")
KEY = "ab" * 32


@pytest.fixture(scope="module")
def service(tmp_path_factory, condensed_bodies):
    folder = tmp_path_factory.mktemp("service")
    find_condensed(condensed_bodies, folder)
    with subprocess.Popen(
        [sys.executable, "-m", "lineofaction.cli", "serve", "--port", "0", "--data-directory", str(folder)],
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        line = process.stdout.readline()
        yield process, line[line.index("http://") :].strip()
        process.terminate()
        process.wait()


@pytest.fixture(autouse=True)
def _as_a_user(monkeypatch, tmp_path, service):
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("LOA_SERVICE", service[1])


@pytest.mark.chain
def test_the_scripts_of_the_page_run_one_after_the_other(capsys):
    scripts = re.findall(r"```python\n(.*?)```", RECIPES, re.DOTALL)
    assert len(scripts) == 16  # the first one, and the recipes
    names: dict[str, Any] = {}
    printed = []
    for script in scripts:
        exec(compile(script, "docs/how-to/call-a-service.md", "exec"), names)
        printed.append(capsys.readouterr().out)
    table, followed, waited, many, batched, awaited, study, arrays, live, before, made, lists = printed[:12]
    labeled, _, shown, run_up = printed[12:]
    assert re.search(r"^(pinion|wheel) \d+ [\d.]+ µm$", made, re.MULTILINE) and "mesh 1 " in made
    assert re.fullmatch(r"2\.\d+ ± [\d.]+ µm", table.splitlines()[-1])
    assert followed.splitlines()[-1] == "analyze: done"
    assert names["table"].identical(names["ste"])
    assert waited == "" and names["file"].is_file()  # nothing failed
    reliefs, ripples = np.array([list(map(float, line.split())) for line in many.splitlines()]).T
    assert reliefs.tolist() == names["reliefs"]
    assert batched.splitlines()[-len(reliefs) :] == many.splitlines()
    assert float(awaited) == ripples.min() and len(set(ripples)) == len(reliefs)
    pascals, megapascals, unit = study.split()
    assert float(pascals) == pytest.approx(1e6 * float(megapascals)) and unit == "Pa"
    assert "['inside', 'inside', 'inside']" in arrays
    assert names["key"] == names["ste"].metadata.content_hash
    assert 0.0 < float(live.split()[1]) < 0.1 * float(live.split()[0])
    assert "transverse" not in before and "corner_contact" in before
    assert names["again"].model_dump(mode="json") == names["example"].case
    assert int(lists.split()[0]) >= 3 and {len(word) for word in lists.split()} & {64}
    assert labeled.splitlines()[0].startswith("Tip relief 20 µm, released ('ev-3',) 20/20")
    case, fetched = names["table_of"](f"{os.environ['LOA_SERVICE']}/#database={names['key']}")
    assert case.model_dump(mode="json") == names["ste"].metadata.case and fetched.identical(names["ste"])
    assert shown == "" and "<details>" in names["report"]._repr_html_()
    assert float(run_up) == pytest.approx(100.0 / (0.04 * np.cos(np.radians(20.0))), rel=2e-3)


def test_the_sheet_of_an_inspection_goes_into_a_case(tmp_path):
    sheet = tmp_path / "pinion.csv"
    rows = "".join(f"{tooth},left,pitch,{tooth % 2}\n" for tooth in range(1, 21))
    sheet.write_text(f"tooth,flank,trace,deviation_um\n{rows}", encoding="utf-8")
    with LineOfActionClient() as client:
        case = client.case_as_measured(ROOT / "examples" / "palermo_spur_20_20.toml", sheet, "pinion", "left")
        assert len(case.pair.pinion.pitch_deviation_um) == 20
        assert case.pair.wheel.pitch_deviation_um == ()
        with pytest.raises(BadInput, match="a file that can be read"):
            client.case_as_measured(case, tmp_path / "none.csv", "pinion")
        with pytest.raises(BadInput, match="line 2"):
            sheet.write_text("tooth,flank,trace,deviation_um\n21,left,pitch,0\n", encoding="utf-8")
            client.case_as_measured(case, sheet, "pinion")


@pytest.mark.chain  # by the bodies that the scripts had condensed
def test_the_paper_s_flow_runs_again_without_the_service(service, monkeypatch, tmp_path, capsys):
    examples = ROOT / "examples"
    monkeypatch.syspath_prepend(str(examples))

    def run(output):
        monkeypatch.setattr(sys, "argv", ["run_up_from_service.py", "-o", str(output)])
        runpy.run_path(str(examples / "run_up_from_service.py"), run_name="__main__")
        return capsys.readouterr().out

    first = run(tmp_path / "first.nc")
    service[0].terminate()
    service[0].wait()
    with pytest.warns(OfflineWarning, match=re.escape(service[1])):
        run(tmp_path / "second.nc")
    runs = [RunResult.from_netcdf(tmp_path / f"{name}.nc") for name in ("first", "second")]
    assert np.array_equal(runs[0].bearing_force, runs[1].bearing_force)
    fundamental = re.search(r"spectrum: fundamental\s+([\d.]+) Hz", first)
    assert fundamental and 286.5 < float(fundamental.group(1)) < 302.4  # the paper's figure: 287 to 303 Hz


def test_what_the_page_installs_is_enough_to_ask_a_service(tmp_path):
    """Without the extras tables are fetched, opened and asked; datasets name the extra they need."""
    assert "pip install lineofaction\n" in PAGE
    hidden = [name for names in MODULES.values() for name in names]
    assert {"gmsh", "numba", "skfem", "fastapi", "pydantic_settings"} <= set(hidden)
    cache, content = ResultCache(tmp_path / "tables"), tmp_path / "table.nc"
    small_table().to_netcdf(content)
    with cache.incoming() as file:
        file.write(content.read_bytes())
        cache.keep("database", KEY, file, hashlib.sha256(content.read_bytes()).hexdigest())
    code = f"""
import sys
sys.modules.update(dict.fromkeys({hidden!r}))  # importing one of these fails now
from lineofaction.client import LineOfActionClient
client = LineOfActionClient("http://127.0.0.1:9", cache_dir={str(tmp_path / "tables")!r})
table = client.fetch({KEY!r})
print(table.peak_to_peak(torque=float(table.torque[-1])).value > 0.0, table.force_at(0.0, 3e-6).force > 0.0)
try:
    client.fetch_dataset({KEY!r})
except ModuleNotFoundError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    answer, missing = done.stdout.splitlines()
    assert answer == "True True" and "lineofaction[analysis]" in missing
