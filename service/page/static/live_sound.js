// @ts-check
/** The live curves as sounds: what the meshes excite over a run-up, all at one scale, so that louder is louder. */

import { button, byId, make, number } from "./elements.js";
import { markOn } from "./plots.js";

/** @typedef {{name: string, teeth: number, harmonics: number[]}} Voice teeth of the driving gear, amplitudes in um */
/** @typedef {{from: number, to: number, seconds: number}} Sweep speeds of the driving gear in rpm */

const LOUDEST = 0.5; // of full scale
const SECONDS = 6;
const EDGE = 0.05; // seconds in which a sound comes and goes

const frequency = ({ teeth }, rpm) => (teeth * rpm) / 60;

/** Most that a voice can reach at the end of a sweep: velocities of all its harmonics together. @param {Voice} voice @param {Sweep} sweep */
export function strength(voice, sweep) {
  const together = voice.harmonics.reduce((sum, amplitude, k) => sum + amplitude * (k + 1), 0);
  return together * frequency(voice, Math.max(sweep.from, sweep.to));
}

/** One period: each harmonic by its velocity. @param {BaseAudioContext} context @param {Voice} voice */
function wave(context, { harmonics }) {
  const sines = Float32Array.from([0, ...harmonics.map((amplitude, k) => amplitude * (k + 1))]);
  return context.createPeriodicWave(new Float32Array(sines.length), sines, { disableNormalization: true });
}

/**
 * Sound a voice over a sweep; what lies beyond the sampling is left out.
 * @param {BaseAudioContext} context @param {Voice} voice @param {Sweep} sweep
 * @param {number} full the strength that is played at LOUDEST
 * @returns {OscillatorNode} its source
 */
export function sounded(context, voice, { from, to, seconds }, full) {
  const begin = context.currentTime;
  const source = context.createOscillator();
  const [level, edge] = [context.createGain(), context.createGain()];
  const scale = LOUDEST / full;
  source.setPeriodicWave(wave(context, voice));
  for (const [parameter, unit] of /** @type {[AudioParam, number][]} */ ([[source.frequency, 1], [level.gain, scale]])) {
    parameter.setValueAtTime(unit * frequency(voice, from), begin);
    parameter.linearRampToValueAtTime(unit * frequency(voice, to), begin + seconds);
  }
  edge.gain.setValueAtTime(0, begin);
  edge.gain.linearRampToValueAtTime(1, begin + EDGE);
  edge.gain.setValueAtTime(1, begin + seconds - EDGE);
  edge.gain.linearRampToValueAtTime(0, begin + seconds);
  source.connect(level).connect(edge).connect(context.destination);
  source.start(begin);
  source.stop(begin + seconds);
  return source;
}

/** A tone that follows what is pointed at. */
export class Tone {
  /** @param {BaseAudioContext} context */
  constructor(context) {
    this.context = context;
    [this.source, this.level] = [context.createOscillator(), context.createGain()];
    this.level.gain.value = 0;
    this.source.connect(this.level).connect(context.destination);
    this.source.start();
  }

  /** @param {number} frequency Hz @param {number} part of what is played at LOUDEST; 0: silence */
  sound(frequency, part) {
    const now = this.context.currentTime;
    if (part) this.source.frequency.setTargetAtTime(frequency, now, EDGE / 5);
    this.level.gain.setTargetAtTime(LOUDEST * part, now, EDGE / 5);
  }
}

export class LiveSound {
  constructor() {
    /** @type {Voice[]} */
    this.voices = [];
    const speed = (id, label, value) => [make("label", { for: id }, label), make("input", { id, type: "number", min: 1, max: 100000, step: "any", value, "data-unkept": true })];
    this.buttons = make("span", { class: "buttons" });
    this.words = make("output", { class: "hint", for: "sound-from sound-to" });
    byId("live-sound").replaceChildren(
      make("div", { class: "row" }, ...speed("sound-from", "Run-up from, rpm", 1000), ...speed("sound-to", "Run-up to, rpm", 6000), this.buttons, this.words),
      make("p", { class: "hint" }, "Harmonics of the transmission error as velocities at the mesh frequency, all curves at one scale: what the mesh excites, before shafts and housing change it. While one plays it follows the sliders."),
    );
    for (const input of byId("live-sound").querySelectorAll("input")) input.addEventListener("input", () => this.mark());
    this.mark();
  }

  /** @returns {Sweep} as typed */
  get sweep() {
    const [from, to] = ["sound-from", "sound-to"].map((id) => Math.max(Number(/** @type {HTMLInputElement} */ (byId(id)).value) || 1, 1));
    return { from, to, seconds: SECONDS };
  }

  /** Say when the complaint passes. */
  mark() {
    const { from, to, seconds } = this.sweep;
    const rpm = markOn("speed of the driving gear, rpm", Math.min(from, to), Math.max(from, to));
    const passes = rpm !== null && from !== to;
    this.words.textContent = passes ? `The complaint, at ${number(rpm)} rpm, passes after ${number((seconds * (rpm - from)) / (to - from), 2)} s.` : "";
  }

  /** @param {Voice[]} voices the last is the one now */
  show(voices) {
    const names = (list) => list.map(({ name }) => name).join();
    const same = names(voices) === names(this.voices);
    this.voices = voices;
    if (!same) this.buttons.replaceChildren(...voices.map(({ name }) => button(`Play ${name}`, () => this.play(name))));
    const voice = voices.find(({ name }) => name === this.playing);
    if (voice) this.source.setPeriodicWave(wave(this.context, voice));
  }

  /** @param {string} name */
  play(name) {
    this.context ??= new AudioContext();
    this.source?.stop();
    const { sweep } = this;
    const full = Math.max(...this.voices.map((voice) => strength(voice, sweep)), 1e-9);
    this.playing = name;
    const source = (this.source = sounded(this.context, this.voices.find((voice) => voice.name === name), sweep, full));
    source.onended = () => {
      if (this.source === source) this.playing = null;
    };
  }
}
