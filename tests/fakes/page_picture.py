"""The three-dimensional picture of a page: what it shows when nothing moves, where its vertices stand."""

import base64
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Page
from running_service import until

CANVAS = "canvas.view"
CAPTURED = """async (values) => {
  const { programsOf } = await import("/page/view_pair.js");
  const gl = document.createElement("canvas").getContext("webgl2");
  const link = gl.linkProgram.bind(gl);
  gl.linkProgram = (made) => {
    gl.transformFeedbackVaryings(made, ["gl_Position"], gl.INTERLEAVED_ATTRIBS);
    link(made);
  };
  const packed = (values) => {
    const bytes = new Uint8Array(values.buffer);
    let text = "";
    for (let k = 0; k < bytes.length; k += 8192) text += String.fromCharCode(...bytes.subarray(k, k + 8192));
    return btoa(text);
  };
  let drawn = [];
  const captured = (mode, count, kind, from, instances = 1) => {
    const indices = new Uint32Array(count);
    gl.getBufferSubData(gl.ELEMENT_ARRAY_BUFFER, from, indices);
    const vertices = indices.reduce((most, index) => Math.max(most, index + 1), 0);
    const [places, buffer] = [new Float32Array(4 * vertices * instances), gl.createBuffer()];
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, places.byteLength, gl.STREAM_READ);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArraysInstanced(gl.POINTS, 0, vertices, instances);
    gl.endTransformFeedback();
    gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, places);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    gl.deleteBuffer(buffer);
    const drawnAt = new Float32Array(3 * count * instances);
    for (let k = 0; k < instances * count; k += 1) {
      const vertex = vertices * Math.floor(k / count) + indices[k % count];
      drawnAt.set(places.subarray(4 * vertex, 4 * vertex + 3), 3 * k);
    }
    drawn.push(packed(drawnAt));
  };
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.drawElements = gl.drawElementsInstanced = captured;
  const subject = await (MADE)(values);
  subject.begin(gl, programsOf(gl));
  const view = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  return [STEPS].map((step) => {
    step(subject, gl);
    drawn = [];
    subject.draw(gl, { view, back: [0, 0, 1], moving: false, picking: false });
    return drawn;
  });
}"""
"""Draws a subject once after each step, with the shaders and buffers of the page; where is drawn, is kept."""


def vertices(page: Page, made: str, steps: list[str], **values: Any) -> list[list[np.ndarray]]:
    """Return the places in mm (n, 3) of what each call draws, in the order of the calls, after each step.

    `made` is a function of `values` that returns (a promise of) the subject; a step is a statement about
    `subject` and `gl`. Both are written in JavaScript.
    """
    functions = ", ".join(f"(subject, gl) => {{ {step}; }}" for step in steps)
    answer = page.evaluate(CAPTURED.replace("MADE", made).replace("STEPS", functions), values)
    return [[_places(text) for text in drawn] for drawn in answer]


def _places(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 3).astype(float)


def picture(page: Page) -> np.ndarray:
    """Return what the canvas shows when nothing moves (height, width, 3)."""
    rest(page)
    return pixels(page.locator(CANVAS).screenshot())


def pixels(content: bytes) -> np.ndarray:
    """Return the points of an image file (height, width, 3)."""
    return np.asarray(Image.open(BytesIO(content)).convert("RGB")).astype(int)


def frames(page: Page) -> int:
    return int(page.locator(CANVAS).get_attribute("data-frames") or 0)


def rest(page: Page) -> None:
    """Wait until a frame is drawn and no more follow."""
    seen = [-1]

    def still() -> bool:
        seen.append(frames(page))
        page.wait_for_timeout(300)
        return frames(page) == seen[-1] > 0

    until(still)


def stopped(page: Page) -> None:
    """Let the picture stand."""
    stop = page.get_by_role("button", name="Stop", exact=True)
    if stop.count():
        stop.click()


PICTURE, CURVE = 120.0, 140.0  # pixels of height at least


def has_room(page: Page) -> None:
    """See that a small phone shows the picture and the curve as they are now."""
    before, chosen = page.viewport_size, page.locator("#tabs [aria-selected=true]").inner_text()
    page.set_viewport_size({"width": 400, "height": 660})
    until(lambda: _height(page, CANVAS) > PICTURE)
    page.get_by_role("tab", name="Ripple", exact=True).click()
    until(lambda: _height(page, "#live-ripple .plot") > CURVE)
    assert _height(page, CANVAS) > PICTURE
    page.get_by_role("tab", name=chosen, exact=True).click()
    assert before is not None
    page.set_viewport_size(before)


def _height(page: Page, part: str) -> float:
    return (page.locator(part).bounding_box() or {"height": 0.0})["height"]


def different(first: np.ndarray, second: np.ndarray) -> float:
    """Return the part of the points that differ; of pictures of other sizes all."""
    if first.shape != second.shape:
        return 1.0
    return float(np.mean(np.abs(first - second).max(axis=-1) > 12))
