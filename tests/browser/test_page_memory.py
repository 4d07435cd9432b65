"""Memory of the page: a slider leaves nothing behind, and the browser that measures it keeps nothing."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from benchmarks.bare_browser import bare_browser
from benchmarks.page_memory import SHOWN
from benchmarks.page_motion import FLAGS, MOVE, SIZE

FETCHES, ANSWER_MB, MOVES = 40, 1, 10
FETCHED = f"""async () => {{
  for (let k = 0; k < {FETCHES}; k += 1) await (await fetch("/answer", {{ cache: "no-store" }})).text();
}}"""
HELD = """() => {
  window.held = { Buffer: 0, Texture: 0, VertexArray: 0, Program: 0, Framebuffer: 0, Renderbuffer: 0 };
  const graphics = WebGL2RenderingContext.prototype;
  for (const kind of Object.keys(held)) {
    for (const [verb, change] of [["create", 1], ["delete", -1]]) {
      const own = graphics[verb + kind];
      graphics[verb + kind] = function (...all) { held[kind] += change; return own.apply(this, all); };
    }
  }
}"""
STOP = """() => {
  document.querySelector("canvas.view").dispatchEvent(new KeyboardEvent("keydown", { key: " " }));
}"""
COUNTED = """() => ({
  ...held, entries: history.length, plots: document.querySelectorAll(".js-plotly-plot").length,
})"""
LABELS = """() => [...document.querySelectorAll("#live-ripple .plot :is(.xtick, .ytick) text")].map(
  (label) => label.textContent + label.getAttribute("transform"))"""


class Quiet(SimpleHTTPRequestHandler):
    """Files of a folder, without a log."""

    def log_message(self, *_: object) -> None:
        """Log nothing."""


@contextmanager
def served_files(folder: Path) -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=folder)) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@pytest.mark.law
def test_what_a_page_has_fetched_is_not_kept_while_its_memory_is_measured(browser_path, tmp_path):
    (tmp_path / "answer").write_bytes(b"x" * (ANSWER_MB * 1_000_000))
    fetched_mb = FETCHES * ANSWER_MB
    with served_files(tmp_path) as address, bare_browser(browser_path, FLAGS, tmp_path / "own") as browser:
        browser.open(address, SIZE)
        for _ in range(2):  # until nothing is larger than ever
            browser.evaluate(FETCHED)
        _, before = browser.memory_mb()
        browser.evaluate(FETCHED)
        _, after = browser.memory_mb()
        assert after - before < 0.3 * fetched_mb
        browser.page("Network.enable")  # as drivers of tests do
        browser.evaluate(FETCHED)
        _, watched = browser.memory_mb()
        assert watched - after > 0.7 * fetched_mb


def test_moves_of_a_slider_leave_nothing_behind(browser_path, address, analyzed, tmp_path):
    with bare_browser(browser_path, FLAGS, tmp_path / "own") as browser:
        browser.open(f"{address}/#database={analyzed}", SIZE, before=HELD)
        browser.evaluate(SHOWN)
        browser.evaluate(STOP)  # a frame for each answer is enough
        counts, labels, maximum = [], set[str](), 0
        for _ in range(2):
            for _ in range(MOVES):
                browser.evaluate(MOVE)
                shown = browser.evaluate(LABELS)
                labels.update(shown)
                maximum = max(maximum, len(shown))
            counts.append(browser.evaluate(COUNTED))
        assert counts[0]["Texture"] > 0
        assert counts[1] == counts[0]
        assert maximum > 5 and len(labels) < 0.5 * MOVES * maximum, "plotly.js keeps each label at each place"
