// @ts-check
/** The page: what its address says is shown, what is typed is kept with it. */

import { Address, OF_DESIGN } from "./address.js";
import { get, patiently, post } from "./api.js";
import { watchService } from "./away.js";
import { layOut } from "./bench.js";
import { CaseFiles } from "./case_files.js";
import { typedIn } from "./controls.js";
import { Complaint } from "./complaint.js";
import { Design, EMPTY } from "./design.js";
import { byId } from "./elements.js";
import { referenceOf } from "./job.js";
import { Jobs } from "./jobs.js";
import { Live } from "./live.js";
import { clearNotice, sayMissing } from "./notice.js";
import { ordersOf, pairOf } from "./orders.js";
import { pack, unpack } from "./packed.js";
import { asStated } from "./relief_start.js";
import { showReport } from "./report.js";
import { Results } from "./results.js";
import { Dynamics } from "./scene.js";
import { SceneEditor } from "./scene_editor.js";
import { Slot } from "./slot.js";
import { showResult, showStudies, studiesOf } from "./studies.js";
import { Tabs, reveal } from "./tabs.js";
import { Undo } from "./undo.js";
import { UnitHeard } from "./unit_heard.js";
import { OF_UNIT, UnitStudies } from "./unit_studies.js";
import { Variants } from "./variants.js";

const EXAMPLES = "/v1/examples";
const STARTS = [EXAMPLES, "/v1/processes/analyze", "/v1/effects", "/v1/processes", "/v1/"];
const PLACES = ["analyze", "simulate", "modes", "scene", "job", ...OF_UNIT.map(({ id }) => id)]; // beside the studies
const OF_RESULT = { simulate: null, modes: null }; // jobs on a result, which go with it
const USUAL_TAB = "ripple";
const MOST = 1_500_000; // characters of a design that an address carries
const RESTING = 150; // milliseconds between two writings of what is typed

/** What a page without an address shows: the result of the first example, if the service has it by now, or what came with the program. */
const opening = () => patiently(async () => {
  const [{ hash, stored }] = await get(EXAMPLES);
  if (stored) return { hash };
  const came = await get("/page/first.json");
  return { ...came, outline: await post("/v1/cases/outline", { inputs: { case: came.case } }) };
});

class Page {
  async begin() {
    watchService(() => this.back());
    this.opening = location.hash ? null : opening();
    const starts = await patiently(() => Promise.all(STARTS.map(get)));
    const [examples, analyze, effects, { processes }, landing] = starts;
    byId("version").textContent = landing.version;
    const studies = studiesOf(processes);
    const ofCases = studies.filter(({ subjects }) => subjects.includes("case"));
    this.address = new Address([...PLACES, ...ofCases.map(({ process }) => process)], () => this.typed);
    this.caller = `page-${Math.random().toString(36).slice(2, 12)}`;
    this.design = new Design(analyze.inputs.case.schema, effects, examples, this);
    const complaint = new Complaint(this.design);
    const scene = (name, unit) => this.scenes.take(name, unit);
    const slide = (part, position) => this.scenes.slide(part, position);
    const openScene = (chosen) => this.scenes.open(chosen);
    this.files = new CaseFiles(this.design, { scene, slide, openScene, go: (views) => this.go(views) });
    new UnitHeard(this.design, this.files.unit, complaint);
    /** @type {Map<string, Slot>} */
    this.slots = new Map();
    this.parts(ofCases, studies);
    this.nodes = new Tabs(byId("tree"), byId("fields"));
    this.tabs = layOut((id) => this.address.look("tab", id === this.usualTab ? null : id));
    this.keepTyped();
    addEventListener("popstate", () => {
      this.address.read();
      this.render();
    });
    await this.render();
    this.undo = new Undo(() => this.state, (state) => this.putBack(state));
    byId(this.address.section)?.focus();
    document.documentElement.dataset.ready = "yes";
  }

  /** @param {ReturnType<typeof studiesOf>} ofCases @param {ReturnType<typeof studiesOf>} studies all */
  parts(ofCases, studies) {
    const take = (flanks) => this.take(flanks);
    const slot = (name, parts, show) => this.slot(name, parts, show);
    const show = async (target, reference, signal, { scene }) => {
      if (scene) await this.design.view.offer(scene, reference, signal);
      await showResult(target, reference, { take, signal });
    };
    const page = { design: this.design, unit: this.files.unit, slot, show };
    showStudies(ofCases, page);
    const dynamics = new Dynamics(studies.find(({ process }) => process === "modes"), page);
    this.scenes = new SceneEditor(studies, page);
    new UnitStudies(studies, page, this.scenes);
    document.addEventListener("subject", () => this.tabs?.of(document.body.dataset.seen, this.usualTab));
    this.variants = new Variants(this, () => this.render());
    const live = new Live(this, { take, inThreeDimensions: () => this.inThreeDimensions() });
    this.results = new Results(this, live, [dynamics, this.scenes]);
    const button = byId("analyze");
    this.analysis = slot("analyze", { progress: byId("analyze-job"), result: byId("analyze-result"), button },
      (target, reference) => this.tabled("analyze", reference));
    this.analysis.refused = (problem) => this.notAnalyzed(problem);
    button.addEventListener("click", () => this.analyze());
    this.reopened = slot("job", { progress: byId("jobs-progress"), result: byId("jobs-result") },
      (target, reference, signal, inputs) => (reference.kind === "database" ? this.tabled("job", reference) : show(target, reference, signal, inputs)));
    this.jobs = new Jobs((job) => this.reopen(job), (first, second) => this.compare(first, second));
    this.jobs.refresh();
    this.design.settled = () => this.carry();
    this.design.left = () => this.unit();
  }

  get usualTab() {
    return this.files.unit.isSeen ? OF_UNIT[0].id : USUAL_TAB;
  }

  slot(name, parts, show) {
    const made = new Slot(name, this, parts, show);
    this.slots.set(name, made);
    return made;
  }

  /** Show what the address says, whatever was shown before: first what was computed, in the form, then its results. */
  async render() {
    const turn = (this.turn = (this.turn ?? 0) + 1);
    const { kept, faults, empty, views } = this.address;
    this.variants.offer();
    byId("name").value = views.get("name") ?? "";
    this.called();
    this.design.view.motion = views.get("motion") ?? null;
    this.scenes.word = views.get("toml") ?? null;
    this.design.view.stand(views.get("at"));
    this.more = false; // what was typed last belongs to the entry that is left
    if (this.results.stands) this.results.retype();
    clearNotice();
    for (const fault of faults) sayMissing(`“${fault}”: the page has no such address.`);
    if (!this.address.get("database")) for (const name in OF_RESULT) this.address.settle(name, "job");
    this.design.stands = false;
    if (kept.fields) this.design.restore(kept);
    if (this.address.get("database") && !this.results.stands) this.results.announce();
    const orders = kept.fields ? [] : await ordersOf(this.address.names);
    const first = await this.unit();
    const pair = await pairOf(orders) ?? first;
    if (turn !== this.turn) return;
    this.base = pair;
    if (!kept.fields) this.beginWith(pair, orders);
    this.fill(orders.filter(({ name }) => !(name in OF_RESULT)));
    for (const [name, slot] of this.slots) slot.follow(this.address.get(name));
    const [newest] = [...this.address.names.keys()].reverse();
    if (views.has("tab")) this.tabs.select(views.get("tab"));
    else if (newest && newest !== "database") reveal(this.slots.get(newest).result);
    else this.tabs.select(this.usualTab);
    await this.results.show(this.address.get("database"));
    if (turn !== this.turn) return;
    this.fill(orders.filter(({ name }) => name in OF_RESULT)); // showing a result resets them
    await this.scenes.follow();
    if (turn !== this.turn) return;
    if (empty) this.first();
    this.undo?.begin();
  }

  /** Begin with the pair of the address; with none, if it names any other thing; else with the first example. */
  beginWith(pair, orders) {
    const { names, faults, views } = this.address;
    const carried = unpack(views.get("case") ?? "");
    if (carried) this.design.show(carried, { example: "", note: "The pair of this address." });
    else if (pair) this.design.show(pair, { example: "", note: "The pair of this address." });
    else if (!names.size && !faults.length) this.design.begin();
    else {
      this.design.begin(EMPTY); // there is no design for what the address names
      if (!orders.length) sayMissing("The fields of the gear pair are left empty.");
    }
  }

  /** Go on to an entry that shows a unit by itself. @param {Record<string, string | null>} views */
  async go(views) {
    this.address.turn({}, { ...OF_DESIGN, a: null, b: null, c: null, on: null, ...views }, {});
    await this.render();
  }

  /** Show the unit of the address, or a part of it. @returns {Promise<object | null>} the pair of its first mesh */
  async unit() {
    const first = await this.files.unit.follow(this.address.views.get("unit"));
    this.files.unit.see(this.address.views.get("see"));
    return first;
  }

  /** Let the address carry the design where it is not that of its result, its job or the first example. */
  carry() {
    const base = this.results.note.content ?? this.base ?? (this.address.empty ? this.design.example.case : null);
    const own = base === null || this.design.differences(base).length > 0;
    const word = own ? pack(this.design.case) : null;
    const long = word !== null && word.length > MOST;
    this.address.look("case", long ? null : word);
    if (long) byId("example-replaced").textContent = "The design is too long for the address: save it to send it.";
  }

  /** Show what jobs were submitted with where such jobs are submitted. @param {import("./orders.js").Order[]} orders */
  fill(orders) {
    for (const order of orders) {
      const { name, processID, inputs } = order;
      const place = name !== "job" ? name : inputs.scene ? "scene" : processID;
      this.slots.get(place)?.fill?.(order);
    }
  }

  /** The pair that a page without an address begins with: there is a result with nothing to press. */
  async first() {
    const { hash, ...came } = await (this.opening ?? opening());
    this.opening = null;
    if (!this.address.empty) return;
    if (hash) {
      this.address.replace({ database: hash });
      await this.results.show(hash);
    } else if (this.results.key === null) await this.results.still(came);
  }

  /** Keep what is typed with the entry of the history that it is typed in: at once, and no more often than browsers allow. */
  keepTyped() {
    const rested = () => {
      this.resting = 0;
      if (this.more) keep();
    };
    const keep = () => {
      this.more = Boolean(this.resting);
      if (this.more) return;
      this.address.view({ live: this.results.moved, name: byId("name").value.trim(), at: this.design.view.at, motion: this.design.view.motion, toml: this.scenes.word });
      this.called();
      this.address.keep(this.typed);
      this.resting = setTimeout(rested, RESTING);
    };
    document.addEventListener("input", keep);
    document.addEventListener("typed", keep);
    addEventListener("pagehide", () => this.address.leave());
  }

  get typed() {
    if (!this.design.stands) return {};
    return { fields: typedIn(byId("main")), ofResult: this.results.typed };
  }

  /** What may be undone. */
  get state() {
    return { case: this.design.case, origin: this.address.kept.origin, ofResult: this.results.typed, ofScene: this.scenes.state };
  }

  /** Show what was undone or is done anew. @param {import("./undo.js").State} state */
  async putBack({ case: content, origin, ofResult, ofScene }) {
    await this.scenes.putBack(ofScene);
    this.design.show(content, origin);
    this.design.settled();
    this.address.keep({ ofResult });
    await this.results.show(this.address.get("database"));
    document.dispatchEvent(new Event("typed"));
  }

  /** Let the window be called as the design is. */
  called() {
    document.title = [byId("name").value.trim(), "lineofaction · transmission error of gear pairs"].filter(Boolean).join(" · ");
  }

  analyze() {
    this.analysis.submit("analyze", () => ({ case: this.design.submitted() }), { expected: this.design.expected });
  }

  /** A job has ended with a table: that is what the address names in its place from now on. */
  async tabled(name, { hash }) {
    this.address.view({ live: null });
    this.address.settle(name, "database", hash);
    if (this.tabs.shown === "jobs") this.tabs.select(USUAL_TAB);
    this.address.replace(OF_RESULT);
    for (const other of [name, ...Object.keys(OF_RESULT)]) this.slots.get(other).follow(null);
    await this.results.show(hash);
    this.carry();
  }

  notAnalyzed(problem) {
    if (problem.status === 422) this.design.refuse(problem, { focus: true });
    else Slot.prototype.refused.call(this.analysis, problem);
  }

  /** Show what came of an earlier job. */
  async reopen({ jobID: job, title }) {
    this.address.turn({ job }, { ...OF_DESIGN, toml: null, name: title }, {});
    this.tabs.select("jobs");
    const before = document.activeElement;
    await this.render();
    await this.reopened.followed;
    if (document.activeElement !== before) return; // the reader went on while plots were drawn
    if (!this.address.get("job")) this.tabs.select(USUAL_TAB);
    byId(this.address.get("job") ? "jobs-result" : "stage").focus();
  }

  /** Show what differs between the results of two jobs, below the list. */
  async compare(first, second) {
    const [one, other] = await Promise.all([first, second].map(({ jobID }) => referenceOf(jobID)));
    this.comparing?.abort();
    this.comparing = new AbortController();
    await showReport(byId("jobs-result"), { ...one, against: other.hash }, { making: true, signal: this.comparing.signal });
    byId("jobs-result").focus();
  }

  /** The service answers again: ask anew for what hangs on it. */
  back() {
    this.design?.look();
    this.results?.live.ask();
    this.jobs?.refresh();
  }

  /** @param {Record<string, Record<string, any>>} flanks by gear and field */
  async take(flanks) {
    this.design.take(await asStated(flanks, this.design.case));
    reveal(byId("f-pair-pinion-teeth"));
    byId("rail").focus();
  }

  inThreeDimensions() {
    this.design.take({ "accuracy.model": "3d" });
    this.analyze();
  }
}

await new Page().begin();
