"""Alerts and dashboard: they name what the service tells, and each alert fires on its case alone."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

import httpx2
import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families
from running_service import until
from served_app import served
from service_fakes import EXECUTION, REGISTRY

from service.app import create_app
from service.settings import Settings

DEPLOY = Path(__file__).parents[3] / "deploy"
RULES = DEPLOY / "prometheus" / "alerts.yml"
RUNBOOKS = {
    "runbook-database-down",
    "runbook-database-damaged",
    "runbook-disk-full",
    "runbook-worker-dies",
    "runbook-scheduler-dies",
    "runbook-queue-grows",
    "runbook-result-damaged",
    "runbook-store-unreachable",
    "runbook-cluster-away",
    "runbook-database-locked",
}
METRIC = re.compile(r"\b(?:loa|process)_[a-z_]+")
LABELS = re.compile(r"\b(loa_[a-z_]+)\{([^}]*)\}")

Series = dict[str, str]
QUIET: Series = {
    'up{job="lineofaction"': "1x80",
    "loa_scheduler_up{": "1x80",
    "loa_scheduler_turn_age_seconds{": "0.3x80",
    'loa_queue_depth{state="accepted", process="analyze"': "3x80",
    "loa_oldest_waiting_seconds{": "120x80",
    "loa_database_up{": "1x80",
    'loa_writable{part="database"': "1x80",
    'loa_writable{part="results"': "1x80",
    "loa_data_free_bytes{": "50000000000x80",
    "loa_data_size_bytes{": "100000000000x80",
    'loa_problems_total{problem="database-damaged"': "0x80",
    'loa_problems_total{problem="no-space"': "0x80",
    'loa_problems_total{problem="queue-full"': "5x80",
    'loa_problems_total{problem="damaged-file"': "1x80",
    'loa_worker_ends_total{process="analyze", outcome="done"': "0+1x80",
    'loa_worker_ends_total{process="analyze", outcome="died"': "0x70 1x10",
    'loa_worker_ends_total{process="analyze", outcome="defect"': "2x80",
    'loa_worker_warnings_total{process="analyze"': "4x80",
    "loa_workers_limit{": "2x77 0x2",
    'loa_requests_total{status="200"': "0+100x80",
    'loa_requests_total{status="503"': "0+1x80",
}
"""A service with work to do, one value a minute: three wait, one worker died, workers left just now."""


class Case(NamedTuple):
    """How its service differs from the quiet one, what an alert says, its labels beside its severity."""

    changed: Series
    summary: str
    labels: dict[str, str]


HERE, ALL, ANALYZE = {"instance": "a"}, dict[str, str](), {"process": "analyze"}
CASES = {
    "LoaProcessDown": Case(
        {'up{job="lineofaction"': "1x60 0x20"},
        "a does not answer",
        HERE | {"job": "lineofaction"},
    ),
    "LoaSchedulerStuck": Case(
        {"loa_scheduler_turn_age_seconds{": "0x70 60+60x10"},
        "The scheduler of a does not turn",
        HERE,
    ),
    "LoaNobodyWorks": Case(
        {"loa_scheduler_up{": "1x60 _x20"},
        "Computations wait and no scheduler runs",
        ALL,
    ),
    "LoaDatabaseDown": Case(
        {"loa_database_up{": "1x60 0x20", 'loa_writable{part="database"': "1x60 0x20"},
        "The database does not answer a",
        HERE,
    ),
    "LoaDatabaseDamaged": Case(
        {'loa_problems_total{problem="database-damaged"': "0x76 1x4"},
        "a finds the database damaged or read-only",
        HERE | {"problem": "database-damaged"},
    ),
    "LoaDatabaseLocked": Case(
        {'loa_writable{part="database"': "1x60 0x20"},
        "a can read the database, but not write to it",
        HERE | {"part": "database"},
    ),
    "LoaStoreUnreachable": Case(
        {'loa_writable{part="results"': "1x60 0x20"},
        "a cannot write results",
        HERE | {"part": "results"},
    ),
    "LoaDiskFull": Case(
        {'loa_problems_total{problem="no-space"': "0x76 1x4"},
        "a finds no space for its database or its results",
        HERE | {"problem": "no-space"},
    ),
    "LoaDiskAlmostFull": Case(
        {"loa_data_free_bytes{": "50000000000x40 4294967296x40"},
        "a has 4GiB of space left for its data directory",
        HERE,
    ),
    "LoaWorkersDie": Case(
        {'loa_worker_ends_total{process="analyze", outcome="died"': "0x60 0+1x20"},
        "Workers of analyze die; the log says by which signal",
        ANALYZE,
    ),
    "LoaWorkersDefect": Case(
        {'loa_worker_ends_total{process="analyze", outcome="defect"': "2x70 3x10"},
        "A worker of analyze failed unexpectedly; its log has the traceback",
        ANALYZE,
    ),
    "LoaQueueGrows": Case(
        {"loa_oldest_waiting_seconds{": "120x30 0+60x50"},
        "A computation has waited for 47m 0s",
        ALL,
    ),
    "LoaQueueFull": Case(
        {'loa_problems_total{problem="queue-full"': "5x77 9x3"},
        "Submissions are refused: the queue, or that of a key, is full",
        ALL,
    ),
    "LoaResultDamaged": Case(
        {'loa_problems_total{problem="damaged-file"': "1x40 2x40"},
        "The file of a result was damaged and is set aside",
        ALL,
    ),
    "LoaClusterAway": Case(
        {'loa_worker_warnings_total{process="analyze"': "4x70 5x10"},
        "The Dask cluster is away: jobs wait, or go on alone and take longer",
        ALL,
    ),
    "LoaServerErrors": Case(
        {'loa_requests_total{status="503"': "0+1x60 61+20x20"},
        "More than 5 % of the answers are server errors",
        ALL,
    ),
}
"""What each alert is for; it is looked at after 78 minutes."""


def alerts() -> dict[str, dict[str, Any]]:
    (group,) = yaml.safe_load(RULES.read_text())["groups"]
    return {rule["alert"]: rule for rule in group["rules"]}


def dashboard_expressions() -> list[str]:
    panels = json.loads((DEPLOY / "grafana" / "dashboard.json").read_text())["panels"]
    return [target["expr"] for panel in panels for target in panel["targets"]]


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """The labels of all samples of a service by name: with a job that runs, one that waits, and a result."""
    app = create_app(Settings(data_directory=tmp_path_factory.mktemp("service")), REGISTRY)
    with served(app) as port, httpx2.Client(base_url=f"http://127.0.0.1:{port}", timeout=None) as client:

        def submit(mode, text):
            body = {"inputs": {"wish": {"mode": mode, "text": text}}}
            return str(client.post(EXECUTION, json=body).headers["location"])

        hanging = [submit("hang", "runs"), submit("hang", "waits")]
        until(lambda: client.get(hanging[0]).json()["status"] == "running")
        busy = client.get("/metrics").text
        for location in hanging:
            client.delete(location)
        written = submit("write", "")
        client.get(f"{written}/events")  # to its end
        texts = (busy, client.get("/metrics").text)
    samples: dict[str, list[dict[str, str]]] = {}
    for text in texts:
        for family in text_string_to_metric_families(text):
            for sample in family.samples:
                samples.setdefault(sample.name, []).append(sample.labels)
    return samples


def test_every_metric_they_name_is_told(told):
    expressions = [rule["expr"] for rule in alerts().values()] + dashboard_expressions()
    assert {name for text in expressions for name in METRIC.findall(text)} - set(told) == set()


def test_every_label_they_choose_by_is_told(told):
    missing = []
    for text in [rule["expr"] for rule in alerts().values()] + dashboard_expressions():
        for name, chosen in LABELS.findall(text):
            for label, value in re.findall(r'(\w+)="([^"]*)"', chosen):
                if not any(sample.get(label) == value for sample in told[name]):
                    missing.append((name, label, value))
    assert missing == []


def test_every_metric_and_alert_is_documented(told):
    docs = DEPLOY.parent / "docs"
    text = "".join((docs / page).read_text("utf-8") for page in ("operations.md", "how-to/runbooks.md"))
    parts = re.compile("_(bucket|count|sum)$")
    names = {parts.sub("", name) for name in told if name.startswith("loa_")} | set(alerts())
    assert {name for name in names if f"`{name}`" not in text} == set()


def test_each_alert_has_a_runbook_and_each_runbook_an_alert():
    sections = {rule["annotations"]["runbook"].partition("#")[::2] for rule in alerts().values()}
    assert sections - {("operations.md", "log")} == {("how-to/runbooks.md", name) for name in RUNBOOKS}
    assert {rule["labels"]["severity"] for rule in alerts().values()} == {"critical", "warning"}


def series(changed: Series) -> list[dict[str, str]]:
    """Return the series of a service that is quiet but for what changed."""
    return [
        {"series": f'{begin}{"" if begin.endswith("{") else ", "}instance="a"}}', "values": values}
        for begin, values in (QUIET | changed).items()
    ]


def expected(name: str) -> dict[str, Any]:
    rule, case = alerts()[name], CASES[name]
    annotations = {"summary": case.summary, "runbook": rule["annotations"]["runbook"]}
    return {"exp_labels": rule["labels"] | case.labels, "exp_annotations": annotations}


def promtool(*arguments: object) -> str:
    program = shutil.which("promtool")
    if program is None:
        pytest.skip("promtool is not installed (Debian: prometheus)")
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_each_alert_fires_on_its_case_and_no_other_does(tmp_path):
    assert set(CASES) == set(alerts())
    tests = []
    for case in (None, *CASES):
        fires = [
            {"alertname": name, "eval_time": "78m", "exp_alerts": [expected(name)] if name == case else []}
            for name in CASES
        ]
        changed = {} if case is None else CASES[case].changed
        tests.append({"interval": "1m", "input_series": series(changed), "alert_rule_test": fires})
    file = tmp_path / "alerts.test.yml"
    file.write_text(yaml.safe_dump({"rule_files": [str(RULES)], "evaluation_interval": "1m", "tests": tests}))
    assert "SUCCESS" in promtool("test", "rules", file)


def test_prometheus_reads_its_configuration_and_every_expression(tmp_path):
    promtool("check", "config", RULES.with_name("prometheus.yml"))
    rules = [{"record": f"panel_{n}", "expr": text} for n, text in enumerate(dashboard_expressions())]
    file = tmp_path / "dashboard.yml"
    file.write_text(yaml.safe_dump({"groups": [{"name": "dashboard", "rules": rules}]}))
    assert f"{len(rules)} rules found" in promtool("check", "rules", file)
