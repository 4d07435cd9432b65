"""A Dask scheduler with certificates: who has them may use it, who has not is told what is missing."""

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from model_studies.workers import WorkersLost, dask_workers

distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
dask = pytest.importorskip("dask", reason="the extra dask is not installed")
_ROLES = ("client", "worker", "scheduler")


def certificate(folder: Path) -> dict[str, Any]:
    """Return the settings of Dask for a certificate that signs itself, as `scripts/secrets` makes it."""
    folder.mkdir()
    key, name = (
        ec.generate_private_key(ec.SECP256R1()),
        x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "x")]),
    )
    begins = datetime.now(UTC) - timedelta(days=1)
    made = (
        x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
        .not_valid_before(begins)
        .not_valid_after(begins + timedelta(days=9))
        .sign(key, hashes.SHA256())
    )
    (folder / "tls.crt").write_bytes(made.public_bytes(serialization.Encoding.PEM))
    form = (serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
    (folder / "tls.key").write_bytes(key.private_bytes(*form))
    files = {"cert": str(folder / "tls.crt"), "key": str(folder / "tls.key")}
    parts = {f"distributed.comm.tls.{role}.{part}": file for role in _ROLES for part, file in files.items()}
    return parts | {
        "distributed.comm.tls.ca-file": files["cert"],
        "distributed.comm.require-encryption": True,
    }


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    folder = tmp_path_factory.mktemp("certificates")
    ours, others = (certificate(folder / name) for name in ("ours", "others"))
    gone = ours | {"distributed.comm.tls.ca-file": str(folder / "gone.crt")}
    return {"none": {}, "ours": ours, "others": others, "gone": gone}


@pytest.fixture(scope="module")
def port(certificates):
    """Yield where a scheduler listens that takes encrypted connections alone."""
    with dask.config.set(certificates["ours"]):
        where: dict[str, Any] = {
            "host": "tls://127.0.0.1",
            "protocol": "tls",
            "security": distributed.Security(),
        }
        where["dashboard_address"] = "127.0.0.1:0"
        cluster = distributed.LocalCluster(n_workers=1, processes=False, **where)
    with cluster:
        yield cluster.scheduler_address.removeprefix("tls://")


@pytest.mark.law
def test_tasks_go_to_a_scheduler_whose_certificate_is_ours(port, certificates):
    with dask.config.set(certificates["ours"]):
        workers = dask_workers(f"tls://{port}")
        with workers.client:
            assert list(workers.run(divmod, 7, [2, 3])) == [(3, 1), (2, 1)]


@pytest.mark.parametrize(
    ("whose", "scheme", "reason"),
    [
        ("none", "tls", r"it wants certificates: name their files in DASK_DISTRIBUTED__COMM__TLS__CA_FILE"),
        ("ours", "tcp", r"REQUIRE_ENCRYPTION is set: its address begins with tls://"),
        ("others", "tls", r"TLS certificate does not match"),
        ("gone", "tls", r"No such file or directory"),
        ("none", "tcp", r"No Dask scheduler answers at tcp://"),
    ],
)
def test_a_connection_that_does_not_fit_is_refused_with_the_reason(port, certificates, whose, scheme, reason):
    with dask.config.set(certificates[whose]), pytest.raises(WorkersLost, match=reason):
        dask_workers(f"{scheme}://{port}")
