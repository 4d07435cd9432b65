"""The main job, as a user would script it: service, STE database, run-up, report.

    python examples/main_job.py [--exit] [--out FOLDER]

Starts a service of its own on a free loopback port and has it compute two pairs: the published spur pair with
its run-up, and the helical EV pair that the page of the service opens on. Each has its report. In a terminal
it stays up, for trying the service.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from lineofaction.client import JobState, LineOfActionClient

EXAMPLES = Path(__file__).parent
CASE, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "palermo_scene.toml"
HELICAL = EXAMPLES / "helical_ev_23_67.toml"
START_S, STOP_S = 60.0, 10.0


def main() -> int:
    """Run the main job."""
    arguments = _arguments()
    out: Path = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the service is stopped on the way out
    with _service(out) as service:
        from main_job_summary import summary  # noqa: PLC0415 (the service starts meanwhile)

        address = _address(service, out / "service.log")
        times = _compute(address, out)
        print(summary(out / "ste.nc", out / "run.nc", out / "helical.nc", times))
        print(f"\nreports   {out / 'report.html'}\n          {out / 'helical.html'}")
        print(f"service   {address}, log in {out / 'service.log'}", flush=True)
        print("loa       `source .venv/bin/activate` puts it on the path", flush=True)
        if sys.stdout.isatty() and not arguments.exit:
            print("The service stays up. Stop it with Ctrl-C.", flush=True)
            _wait_for_interrupt()
    return 0


def _arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Run the main job on the example pairs.")
    parser.add_argument("--exit", action="store_true", help="end when the report is written")
    parser.add_argument("--out", type=Path, default=EXAMPLES.parent / "out", help="folder for all results")
    return parser.parse_args()


@contextmanager
def _service(out: Path) -> Iterator[subprocess.Popen[str]]:
    """Run a service on a free port; it ends with the block."""
    data = str(out / "service")
    command = [sys.executable, "-m", "lineofaction.cli", "serve", "--port", "0"]
    command += ["--workers", "2", "--data-directory", data]
    with (out / "service.log").open("w", encoding="utf-8") as log:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _address(process: subprocess.Popen[str], log: Path) -> str:
    """Read the address from the service's first line."""
    assert process.stdout is not None
    watchdog = threading.Timer(START_S, process.kill)
    watchdog.start()
    line = process.stdout.readline()
    watchdog.cancel()
    if "http://" not in line:
        raise SystemExit(
            f"The service did not start within {START_S:.0f} s:\n{log.read_text(encoding='utf-8')}"
        )
    return line[line.index("http://") :].strip()


def _compute(address: str, out: Path) -> dict[str, float]:
    """Have tables and run computed side by side and reported on; wall seconds by step."""
    times: dict[str, float] = {}
    start = time.perf_counter()
    with LineOfActionClient(address, progress=_show_progress) as client, ExitStack() as verbs:
        client.analyze.submit(HELICAL)
        run = verbs.enter_context(_verb("simulate", SCENE, "--service", address, "-o", out / "run.nc"))
        shutil.copyfile(client.fetch_file(client.analysis_key(CASE)), out / "ste.nc")
        key = client.analysis_key(HELICAL)
        shutil.copyfile(client.fetch_file(key), out / "helical.nc")
        times["STE databases"] = time.perf_counter() - start
        helical = verbs.enter_context(_verb("report", out / "helical.nc", "-o", out / "helical.html"))
        with urllib.request.urlopen(f"{address}/v1/results/{key}/figures"):  # the page opens on them
            _await(run)
        times["run-up, beside them"] = time.perf_counter() - start
        files = [out / "ste.nc", out / "run.nc"]
        _await(_verb("report", *files, "-o", out / "report.html", "--images", out / "images"))
        _await(helical)
    times["reports, after them"] = time.perf_counter() - start - times["run-up, beside them"]
    return times


def _verb(*arguments: object) -> subprocess.Popen[bytes]:
    """Start a verb of loa."""
    command = [sys.executable, "-m", "lineofaction.cli", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL)


def _await(verb: subprocess.Popen[bytes]) -> None:
    """Wait until a verb has ended; raises SystemExit if it failed."""
    if verb.wait() != 0:
        raise SystemExit(f"{verb.args!r} ended with exit code {verb.returncode}")


def _show_progress(state: JobState) -> None:
    """Show the stage on the terminal."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r\x1b[K{state.status} {state.stage}")
        sys.stderr.write("\n" if state.ended else "")
        sys.stderr.flush()


def _wait_for_interrupt() -> None:
    """Stay until Ctrl-C."""
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        print()


if __name__ == "__main__":
    sys.exit(main())
