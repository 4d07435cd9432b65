"""Dockerfile, compose.yaml and the manifests for Kubernetes agree with the program and with each other."""

import importlib
import os
import re
import shutil
import subprocess
import time
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from postgres_server import migrated, postgres
from repository import ROOT
from typer.main import get_command

from lineofaction.cli.commands import app
from service.secret_files import is_secret
from service.settings import Settings

__all__ = ["postgres"]
MANIFESTS = ROOT / "deploy" / "kubernetes"
FIELDS = {name.upper(): field for name, field in Settings.model_fields.items()}
VARIABLES = {f"LOA_{name}" for name in FIELDS} | {
    f"LOA_{name}_FILE" for name, field in FIELDS.items() if is_secret(field)
}
PARTS = ("serve", "schema", "scheduler", "work")
OURS = ("serve", "schema")
"""Those that do a verb of the program; the others are of Dask."""


@cache
def documents(part: str) -> tuple[dict[str, Any], ...]:
    """Return what kustomize makes of a folder."""
    if shutil.which("kubectl") is None:
        pytest.skip("kubectl is not installed")
    words = ["kubectl", "kustomize", str(MANIFESTS / part)]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return tuple(yaml.safe_load_all(done.stdout))


def of_kind(part: str, kind: str) -> Iterator[dict[str, Any]]:
    yield from (one for one in documents(part) if one["kind"] == kind)


def servers() -> list[dict[str, Any]]:
    """Return what keeps pods of the service running."""
    return [*of_kind("service", "Deployment"), *of_kind("service", "StatefulSet")]


def pods() -> dict[str, dict[str, Any]]:
    """Return the pods by their part."""
    makers = [*servers(), *of_kind("schema", "Job")]
    found = {one["metadata"]["name"].rpartition("-")[2]: _pod(one["spec"]) for one in makers}
    assert set(found) == set(PARTS)
    return found


def _pod(maker: dict[str, Any]) -> dict[str, Any]:
    """Return the pod of what makes some, the volumes that it claims for each among its volumes."""
    pod, claims = maker["template"]["spec"], maker.get("volumeClaimTemplates", [])
    claimed = [
        {"name": claim["metadata"]["name"], "persistentVolumeClaim": claim["spec"]} for claim in claims
    ]
    return {**pod, "volumes": [*pod["volumes"], *claimed]}


def container(part: str) -> dict[str, Any]:
    (only,) = pods()[part]["containers"]
    return only


def compose() -> dict[str, Any]:
    return yaml.safe_load((ROOT / "compose.yaml").read_text())


def dockerfile() -> str:
    return (ROOT / "Dockerfile").read_text()


def variables_of(part: str) -> dict[str, str]:
    """Return what a part's container finds in its environment, secrets apart."""
    maps = {one["metadata"]["name"]: one["data"] for one in of_kind("service", "ConfigMap")}
    found: dict[str, str] = {}
    for source in container(part).get("envFrom", []):
        found |= maps[source["configMapRef"]["name"]]
    return found | {entry["name"]: entry["value"] for entry in container(part).get("env", [])}


@pytest.fixture
def kubernetes_validate():
    """Its import takes three seconds, of every worker if it stood above."""
    return importlib.import_module("kubernetes_validate")


@pytest.mark.parametrize("part", ["service", "schema", "whole"])
def test_manifests_are_valid(part, kubernetes_validate):
    for document in documents(part):
        if not document["apiVersion"].startswith("monitoring.coreos.com/"):  # see the test of the monitor
            kubernetes_validate.validate(document, "1.34", strict=True)


def test_a_manifest_that_is_not_valid_is_found(kubernetes_validate):
    wrong = {**next(of_kind("service", "Deployment"))}
    wrong["spec"] = {**wrong["spec"], "replica": 2}
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(wrong, "1.34", strict=True)


@pytest.mark.parametrize("part", OURS)
def test_every_variable_of_a_pod_is_a_setting(part):
    assert {name for name in variables_of(part) if not name.startswith("DASK_")} <= VARIABLES


def test_every_variable_of_compose_and_of_the_image_is_a_setting():
    named = {
        name for service in compose()["services"].values() for name in service.get("environment", {})
    } | set(re.findall(r"\bLOA_[A-Z_]+(?==)", dockerfile()))
    assert {name for name in named if name.startswith("LOA_")} <= VARIABLES
    assert {"LOA_DATABASE_URL_FILE", "LOA_MANAGEMENT_PORT", "LOA_DATA_DIRECTORY"} <= named


def test_pods_hold_no_secret_and_mount_those_they_name():
    for part, spec in pods().items():
        assert not any(
            is_secret(field) and f"LOA_{name}" in variables_of(part) for name, field in FIELDS.items()
        )
        assert all(list(source) == ["configMapRef"] for source in container(part).get("envFrom", []))
        mounted = [Path(mount["mountPath"]) for mount in container(part)["volumeMounts"]]
        for name, value in variables_of(part).items():
            if name.endswith(("_FILE", "__CERT", "__KEY")):
                assert Path(value).parent in mounted, (part, name)
        assert {mount["name"] for mount in container(part)["volumeMounts"]} == {
            volume["name"] for volume in spec["volumes"]
        }


@pytest.mark.parametrize("part", OURS)
def test_commands_are_verbs_of_the_program(part):
    for words in (
        container(part)["args"],
        compose()["services"][{"serve": "service"}.get(part, part)]["command"],
    ):
        program, verb, *rest = words
        assert program == "loa"
        command = get_command(app).commands[verb]
        options = {option for parameter in command.params for option in parameter.opts}
        assert all(word in options or word in getattr(command, "commands", {}) for word in rest)


def test_ports_and_paths_agree():
    exposed = set(map(int, re.search(r"^EXPOSE (.*)$", dockerfile(), re.MULTILINE)[1].split()))
    http = int(re.search(r"LOA_PORT=(\d+)", dockerfile())[1])
    management = int(variables_of("serve")["LOA_MANAGEMENT_PORT"])
    assert http == Settings.model_fields["port"].default
    assert exposed == {http, management}
    assert re.search(r"LOA_MANAGEMENT_PORT=(\d+)", dockerfile())[1] == str(management)
    check = dockerfile().partition("HEALTHCHECK")[2].partition("ENTRYPOINT")[0]
    assert "LOA_MANAGEMENT_PORT" in check and "LOA_PORT" not in check
    ports = {port["name"]: port["containerPort"] for port in container("serve")["ports"]}
    assert ports == {"http": http, "management": management}
    targets = [port["targetPort"] for one in of_kind("service", "Service") for port in one["spec"]["ports"]]
    assert set(targets) == {"dask", "http"}
    assert f":{http}" in compose()["services"]["service"]["ports"][0]
    parts = compose()["services"]["service"]
    assert parts["environment"]["LOA_MANAGEMENT_PORT"] == management
    assert f"http://127.0.0.1:{management}/health" in parts["healthcheck"]["test"][-1]
    names = ("startup", "liveness", "readiness")
    probes = {name: container("serve")[f"{name}Probe"]["httpGet"] for name in names}
    assert {probe["port"] for probe in probes.values()} == {"management"}
    assert probes["liveness"]["path"] == probes["startup"]["path"] == "/health"
    assert probes["readiness"]["path"] == "/ready"


@pytest.mark.parametrize("part", PARTS)
def test_pods_have_the_least_rights(part):
    spec, only = pods()[part], container(part)
    assert spec["automountServiceAccountToken"] is False
    user = re.search(r"--uid (\d+)", dockerfile())
    assert (spec["securityContext"]["runAsNonRoot"], spec["securityContext"]["runAsUser"]) == (
        True,
        int(user[1]),
    )
    assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert only["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    for bound in ("requests", "limits"):
        assert set(only["resources"][bound]) == {"cpu", "memory"}
    place = re.search(r"LOA_DATA_DIRECTORY=(\S+)", dockerfile())
    writable = [mount["mountPath"] for mount in only["volumeMounts"] if not mount.get("readOnly")]
    assert "/tmp" in writable and any(Path(place[1]).is_relative_to(path) for path in writable)


def test_containers_of_compose_are_bounded():
    for name, service in compose()["services"].items():
        assert {"mem_limit", "cpus", "pids_limit"} <= set(service), name
        assert service["logging"]["options"] == {"max-size": "10m", "max-file": "5"}, name
        assert service["cap_drop"] == ["ALL"] and service["security_opt"] == ["no-new-privileges:true"], name
        assert service.get("read_only", False) or name == "database"


def test_there_is_one_server_and_the_former_has_ended_before_the_next_starts():
    server = next(
        one for one in of_kind("service", "Deployment") if one["metadata"]["name"].endswith("serve")
    )
    assert (server["spec"]["replicas"], server["spec"]["strategy"]) == (1, {"type": "Recreate"})


def test_the_server_and_the_workers_find_the_scheduler():
    services = {
        one["metadata"]["name"]: one["spec"]["ports"][0]["port"] for one in of_kind("service", "Service")
    }
    address = f"tls://lineofaction-scheduler:{services['lineofaction-scheduler']}"
    assert variables_of("serve")["LOA_SCHEDULER"] == address == container("work")["args"][2]
    of_compose = compose()["services"]
    assert of_compose["service"]["environment"]["LOA_SCHEDULER"] == of_compose["work"]["command"][2]
    assert of_compose["scheduler"]["command"][-2] == "8786" == address.rpartition(":")[2]


@pytest.mark.law
def test_server_scheduler_and_workers_have_one_certificate_and_let_in_nobody_without():
    of_compose = compose()["services"]
    for name, part in {"service": "serve", "scheduler": "scheduler", "work": "work"}.items():
        for own in (of_compose[name]["environment"], variables_of(part)):
            dask = {key.removeprefix("DASK_").lower(): value for key, value in own.items() if "DASK_" in key}
            certificates = {value for key, value in dask.items() if key.endswith(("__cert", "ca_file"))}
            keys = {value for key, value in dask.items() if key.endswith("__key")}
            assert (len(certificates), len(keys), len(dask)) == (1, 1, 8), name
            assert dask["distributed__comm__require_encryption"] == "true"
        assert {"dask_certificate", "dask_key"} <= set(of_compose[name]["secrets"])
    for command in (of_compose["scheduler"]["command"], container("scheduler")["args"]):
        assert command[2:4] == ["--protocol", "tls"]


@pytest.mark.law
def test_only_the_server_and_dask_reach_the_ports_of_dask():
    """They run the code that they are sent."""
    policies = {one["metadata"]["name"]: one["spec"] for one in of_kind("service", "NetworkPolicy")}
    (rule,) = policies["dask"]["ingress"]
    (peer,) = rule["from"]
    (chosen,) = peer["podSelector"]["matchExpressions"]
    assert set(chosen["values"]) == {"serve", "scheduler", "work"}
    ports = {port["containerPort"] for part in ("scheduler", "work") for port in container(part)["ports"]}
    (opened,) = rule["ports"]
    assert all(opened["port"] <= port <= opened["endPort"] for port in ports)
    others = [spec for name, spec in policies.items() if name not in ("dask", "nothing-else")]
    named = {
        port.get("port") for spec in others for rule in spec.get("ingress", ()) for port in rule["ports"]
    }
    assert named == {"http", "management"}
    for name in ("scheduler", "work"):
        assert (
            compose()["services"][name]["networks"] == ["inside"]
            and "ports" not in compose()["services"][name]
        )
    assert compose()["networks"]["inside"] == {"internal": True}


@pytest.mark.law
def test_only_the_server_and_the_schema_job_reach_database_and_store():
    """A worker of Dask runs code that it is sent: it gets no way out but to names and to Dask."""
    out = {
        one["metadata"]["name"]: {port["port"] for rule in one["spec"]["egress"] for port in rule["ports"]}
        for one in of_kind("service", "NetworkPolicy")
        if "egress" in one["spec"]
    }
    assert out == {"to-names": {53}, "to-database-and-store": {5432, 443}, "dask": {8786}}
    policies = {one["metadata"]["name"]: one["spec"] for one in of_kind("service", "NetworkPolicy")}
    (chosen,) = policies["to-database-and-store"]["podSelector"]["matchExpressions"]
    assert (chosen["operator"], set(chosen["values"])) == ("In", {"serve", "schema"})


def test_a_worker_fails_by_its_own_limit_before_the_container_does():
    limit = int(variables_of("serve")["LOA_MEMORY_LIMIT_MB"])
    assert container("work")["resources"]["limits"]["memory"] == "4Gi"
    assert limit + 600 < 4 * 1024  # the Dask worker, and the warm process it forks children from


def test_scaling_needs_no_adapter_and_workers_say_what_they_use():
    (scaler,) = of_kind("service", "HorizontalPodAutoscaler")
    assert [entry["type"] for entry in scaler["spec"]["metrics"]] == ["Resource"]
    target = scaler["spec"]["scaleTargetRef"]
    work = next(
        one for one in of_kind("service", target["kind"]) if one["metadata"]["name"] == target["name"]
    )
    assert "replicas" not in work["spec"]  # two would set it against each other
    resources = container("work")["resources"]
    assert resources["requests"]["cpu"] == resources["limits"]["cpu"] == "1"  # a job uses one core: 100 %


def test_a_worker_that_is_to_end_has_the_time_to_finish_its_job():
    words = {"--no-nanny", "--preload", "service.worker.draining"}
    for command in (container("work")["args"], compose()["services"]["work"]["command"]):
        assert words <= {part for word in command for part in word.split("=")}
    assert pods()["work"]["terminationGracePeriodSeconds"] > Settings.model_fields["deadline_s"].default
    assert importlib.import_module("service.worker.draining").dask_setup


def test_byte_code_is_written_in_the_image_that_runs():
    """The base image has none of Python's own modules: 0.3 CPU s of each process that cannot write it."""
    _, run = dockerfile().split(" AS run\n")
    script = re.search(r"RUN .*source=scripts/image_modules.py,target=(\S+) \\\n(?:.*\\\n)*?.*python \1", run)
    assert script is not None and "PYTHONDONTWRITEBYTECODE" not in script[0]
    assert run.index("COPY --from=build") < script.start() < run.index("USER lineofaction")
    assert "PYTHONDONTWRITEBYTECODE" not in run.partition("RUN --mount")[0]


def test_caches_and_temporary_files_are_on_volumes():
    """Neither a restart nor an upgrade compiles again, and no temporary file counts as memory."""
    place = Path(re.search(r"NUMBA_CACHE_DIR=(\S+)", dockerfile())[1])
    for part in ("serve", "work"):
        mounts = {mount["mountPath"]: mount["name"] for mount in container(part)["volumeMounts"]}
        volumes = {volume["name"]: volume for volume in pods()[part]["volumes"]}
        assert "persistentVolumeClaim" in volumes[mounts["/data"]] and place.is_relative_to("/data")
        assert "medium" not in volumes[mounts["/tmp"]]["emptyDir"], "memory"
    (claim,) = of_kind("service", "PersistentVolumeClaim")
    named = [
        volume.get("persistentVolumeClaim", {}).get("claimName") for volume in pods()["serve"]["volumes"]
    ]
    assert claim["metadata"]["name"] in named
    for name, service in compose()["services"].items():
        assert "tmpfs" not in service, name
        if service.get("read_only"):
            assert "/tmp" in service["volumes"], name
    for name in ("service", "work"):
        paths = [volume.partition(":")[2] for volume in compose()["services"][name]["volumes"]]
        assert any(path and place.is_relative_to(path) for path in paths), name


# What is optional: components, which `whole` has all of.


def only(kind: str) -> dict[str, Any]:
    """Return the document of a kind that there is one of, all that is optional included."""
    (found,) = of_kind("whole", kind)
    return found


def test_the_whole_has_all_components():
    makers = {
        file.parent.name: yaml.safe_load(file.read_text()) for file in MANIFESTS.glob("*/kustomization.yaml")
    }
    components = {name for name, made in makers.items() if made["kind"] == "Component"} - {"image"}
    assert components == {Path(path).name for path in makers["whole"]["components"]}
    assert {one["metadata"]["namespace"] for one in documents("whole") if one["kind"] != "Namespace"} == {
        "lineofaction"
    }


def test_the_proxy_passes_on_what_the_service_takes_and_sends():
    ingress = only("Ingress")
    (rule,) = ingress["spec"]["rules"]
    (path,) = rule["http"]["paths"]
    target = path["backend"]["service"]
    service = next(one for one in of_kind("whole", "Service") if one["metadata"]["name"] == target["name"])
    assert target["port"]["name"] in {port["name"] for port in service["spec"]["ports"]}
    assert [rule["host"]] == ingress["spec"]["tls"][0]["hosts"], "no plain HTTP"
    notes = {key.partition("/")[2]: value for key, value in ingress["metadata"]["annotations"].items()}
    assert int(notes["proxy-body-size"].rstrip("m")) << 20 >= Settings.model_fields["body_limit"].default
    assert notes["proxy-buffering"] == "off" and int(notes["proxy-read-timeout"]) >= 3600
    policy = next(
        one for one in of_kind("whole", "NetworkPolicy") if one["metadata"]["name"] == "callers-to-serve"
    )
    (peer,) = policy["spec"]["ingress"][0]["from"]
    assert peer["namespaceSelector"]["matchLabels"]["kubernetes.io/metadata.name"] == "ingress-nginx"


def test_the_monitor_finds_the_management_port_under_the_name_of_the_alerts():
    monitor = only("ServiceMonitor")
    assert monitor["apiVersion"] == "monitoring.coreos.com/v1"
    assert set(monitor["spec"]) == {"jobLabel", "selector", "endpoints"}
    wanted = monitor["spec"]["selector"]["matchLabels"].items()
    chosen = [
        one for one in of_kind("whole", "Service") if wanted <= one["metadata"].get("labels", {}).items()
    ]
    (service,) = chosen
    (endpoint,) = monitor["spec"]["endpoints"]
    (port,) = service["spec"]["ports"]
    assert (endpoint["port"], endpoint["path"]) == (port["name"], "/metrics")
    assert port["port"] == int(variables_of("serve")["LOA_MANAGEMENT_PORT"])
    job = service["metadata"]["labels"][monitor["spec"]["jobLabel"]]
    alerts = (ROOT / "deploy" / "prometheus" / "alerts.yml").read_text()
    assert set(re.findall(r'job="([^"]+)"', alerts)) == {job}
    labels = pods_labels("serve")
    assert service["spec"]["selector"].items() <= labels.items()


def pods_labels(part: str) -> dict[str, str]:
    (maker,) = (one for one in servers() if one["metadata"]["name"].endswith(part))
    labels: dict[str, str] = maker["spec"]["template"]["metadata"]["labels"]
    return labels


@pytest.mark.law
def test_the_backup_reads_the_database_and_reaches_nothing_else():
    job = only("CronJob")["spec"]["jobTemplate"]["spec"]["template"]
    spec = job["spec"]
    (dump,) = spec["containers"]
    assert spec["securityContext"] == pods()["serve"]["securityContext"]
    assert dump["securityContext"] == container("serve")["securityContext"]
    assert spec["automountServiceAccountToken"] is False
    secrets = [volume["secret"]["secretName"] for volume in spec["volumes"] if "secret" in volume]
    assert secrets == ["lineofaction-database"]
    assert {mount["name"] for mount in dump["volumeMounts"]} == {volume["name"] for volume in spec["volumes"]}
    policies = [one["spec"] for one in of_kind("whole", "NetworkPolicy")]
    mine = [policy for policy in policies if _selects(policy["podSelector"], job["metadata"]["labels"])]
    out = {port["port"] for policy in mine for rule in policy.get("egress", ()) for port in rule["ports"]}
    assert out == {53, 5432}
    claim = next(volume for volume in spec["volumes"] if volume["name"] == "backup")["persistentVolumeClaim"]
    claims = {one["metadata"]["name"] for one in of_kind("whole", "PersistentVolumeClaim")}
    assert claim["claimName"] in claims


def _selects(selector: dict[str, Any], labels: dict[str, str]) -> bool:
    """Whether a selector of pods chooses one with these labels."""
    by_list = all(labels.get(part["key"]) in part["values"] for part in selector.get("matchExpressions", ()))
    return selector.get("matchLabels", {}).items() <= labels.items() and by_list


@pytest.mark.skipif(shutil.which("pg_dump") is None, reason="PostgreSQL is not installed")
def test_the_backup_leaves_whole_dumps_and_removes_old_ones(tmp_path, postgres):
    """Its script, with other folders; a dump that fails leaves the last ones."""
    (script,) = only("CronJob")["spec"]["jobTemplate"]["spec"]["template"]["spec"]["containers"][0][
        "command"
    ][2:]
    secret, backup = tmp_path / "database", tmp_path / "backup"
    secret.mkdir()
    backup.mkdir()
    script = script.replace("/run/secrets/database", str(secret)).replace("/backup", str(backup))
    (secret / "url").write_text(migrated(postgres.new_database()))
    old, young = backup / "loa-20200101T000000Z.dump", backup / "loa-20300101T000000Z.dump"
    for file, days in ((old, 15), (young, 3)):
        file.touch()
        os.utime(file, times=(time.time() - 86_400 * days,) * 2)
    subprocess.run(["sh", "-euc", script], check=True)
    (new,) = set(backup.iterdir()) - {young}
    assert not old.exists() and new.stat().st_size > 10_000
    (secret / "url").write_text("postgresql://127.0.0.1:1/none")
    assert subprocess.run(["sh", "-euc", script], check=False, capture_output=True).returncode != 0
    assert {young, new} <= set(backup.iterdir())


def test_selectors_select_pods():
    labels = [one["spec"]["template"]["metadata"]["labels"] for one in servers()]
    chosen = [one["spec"]["selector"] for one in of_kind("service", "Service")]
    chosen += [one["spec"]["selector"]["matchLabels"] for one in of_kind("service", "PodDisruptionBudget")]
    chosen += [
        one["spec"]["podSelector"].get("matchLabels", {}) for one in of_kind("service", "NetworkPolicy")
    ]
    for wanted in chosen:
        assert any(wanted.items() <= given.items() for given in labels), wanted


def test_the_image_has_every_package():
    """What the Dockerfile copies is let through by .dockerignore; no package of the project is missing."""
    copied = re.findall(r"^COPY (?!--from)(.*) \S+$", dockerfile(), re.MULTILINE)
    sources = {source for line in copied for source in line.split()}
    sources |= set(re.findall(r"source=(\S+?),", dockerfile()))
    allowed = {line[1:] for line in (ROOT / ".dockerignore").read_text().split() if line.startswith("!")}
    assert sources <= allowed
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]["find"]
    assert {name.rstrip("*") for name in packages["include"]} <= sources


def test_the_tag_is_the_version():
    """An older image may lack what the manifests set: 0.2.0 has no management port."""
    image = yaml.safe_load((MANIFESTS / "image" / "kustomization.yaml").read_text())["images"][0]
    assert image["newTag"] == tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert {container(part)["image"] for part in PARTS} == {f"lineofaction:{image['newTag']}"}
