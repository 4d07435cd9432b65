/** The page: a case, its plan, its analysis, and what follows from it. */

import { Problem, get, post } from "./api.js";
import { watchService } from "./away.js";
import { Drawing } from "./drawing.js";
import { showDynamics } from "./dynamics.js";
import { byId, make, save } from "./elements.js";
import { CaseForm } from "./form.js";
import { runJob, showFailure } from "./job.js";
import { Jobs } from "./jobs.js";
import { Live } from "./live.js";
import { noPlan, showPlan } from "./plan.js";
import { showReport } from "./report.js";
import { SceneEditor } from "./scene_editor.js";
import { showResult, showStudies } from "./studies.js";

const SETTLED = 350; // milliseconds without an edit after which the case is planned and drawn
const PLANE = /plane/;

class Page {
  async begin() {
    const [examples, analyze, effects, processes, landing] = await Promise.all(
      ["/v1/examples", "/v1/processes/analyze", "/v1/effects", "/v1/processes", "/openapi.json"].map(get),
    );
    byId("version").textContent = landing.info.version;
    this.drawing = new Drawing();
    this.form = new CaseForm(analyze.inputs.case.schema, effects, () => this.edited());
    this.live = new Live({ take: (flanks) => this.take(flanks), inThreeDimensions: () => this.inThreeDimensions() });
    this.offer(examples);
    this.files();
    byId("analyze").addEventListener("click", () => this.analyze());
    const offered = new Set(processes.processes.map(({ id }) => id));
    this.studies = { case: () => this.form.case, offered, take: (flanks) => this.take(flanks) };
    showStudies(this.studies);
    this.scenes = new SceneEditor();
    this.jobs = new Jobs((job, reference) => this.reopen(job, reference));
    this.jobs.refresh();
    watchService(() => this.back());
    const key = /^#database=([0-9a-f]{64})$/.exec(location.hash)?.[1];
    if (key) await this.open(key);
    else this.begun(examples[0]);
    document.documentElement.dataset.ready = "yes";
  }

  offer(examples) {
    const list = byId("example");
    const opened = make("option", { value: "", hidden: true }, "what was opened");
    list.replaceChildren(opened, ...examples.map(({ name, title }) => make("option", { value: name }, title)));
    list.addEventListener("change", () => this.begun(examples.find(({ name }) => name === list.value)));
  }

  begun(example) {
    byId("example").value = example.name;
    byId("example-note").textContent = example.note;
    this.show(example.case);
  }

  show(content) {
    this.form.case = content;
    this.look();
  }

  edited() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.look(), SETTLED);
  }

  /** Draw and plan what the form holds; refusals go to their fields. */
  async look() {
    const body = { inputs: { case: this.form.case } };
    const turn = (this.turn = (this.turn ?? 0) + 1);
    try {
      const outline = await post("/v1/cases/outline", body);
      if (turn !== this.turn) return;
      this.form.clear();
      this.drawing.show(outline);
      const plan = await post("/v1/plans", { ...body, caller: this.live.caller });
      if (turn === this.turn) this.expected = showPlan(plan);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      const later = problem.type.endsWith("superseded") || problem.status === 0; // asked again when it is back
      if (turn !== this.turn || later) return;
      this.form.refuse(problem);
      noPlan();
    }
  }

  async analyze() {
    const button = byId("analyze");
    button.disabled = true;
    const content = this.form.case;
    try {
      const result = await runJob(byId("analyze-job"), "analyze", { case: content }, { expected: this.expected });
      await this.result(result);
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      if (problem.status === 422) this.form.refuse(problem, { focus: true });
      else showFailure(byId("analyze-job"), problem);
    } finally {
      button.disabled = false;
    }
  }

  /** Show a stored table: its report, its live flanks, its dynamics. */
  async result(reference) {
    history.replaceState(null, "", `#database=${reference.hash}`);
    const facts = await get(reference.href);
    const known = {
      key: reference.hash, case: facts.case, torques: facts.torque_n_m, plane: PLANE.test(facts.receipt?.plan?.model ?? ""),
    };
    byId("results-none").hidden = true;
    await showReport(byId("results-body"), reference, { making: true });
    await this.live.show(known);
    showDynamics(known);
    this.scenes.show(known);
  }

  async open(key) {
    const href = `/v1/databases/${key}`;
    try {
      const facts = await get(href);
      byId("example").value = "";
      byId("example-note").textContent = "";
      this.show(facts.case);
      await this.result({ href, type: "application/x-netcdf", hash: key });
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      showFailure(byId("analyze-job"), problem);
    }
  }

  /** Show what an earlier job has found: a table takes the page, any other result stands below the list. */
  async reopen(job, reference) {
    if (reference.href.includes("/databases/")) {
      await this.open(reference.hash);
      byId("results").focus();
      return;
    }
    await showResult(byId("jobs-result"), reference, this.studies);
    byId("jobs-result").focus();
  }

  /** The service answers again: ask anew for what hangs on it. */
  back() {
    this.look();
    this.live.ask();
    this.jobs.refresh();
  }

  take(flanks) {
    for (const [gear, changes] of Object.entries(flanks)) {
      for (const [name, value] of Object.entries(changes)) this.form.set(`pair.${gear}.${name}`, value);
    }
    this.edited();
    byId("pair").focus();
  }

  async inThreeDimensions() {
    this.form.set("accuracy.model", "3d");
    this.edited();
    byId("run").focus();
    await this.analyze();
  }

  files() {
    byId("export-json").addEventListener("click", () => {
      save(`${JSON.stringify(this.form.case, null, 2)}\n`, "case.json", "application/json");
    });
    byId("export-toml").addEventListener("click", () => this.careful(async () => {
      const { toml } = await post("/v1/cases/to-toml", { inputs: { case: this.form.case } });
      save(toml, "case.toml", "application/toml");
    }));
    const chosen = byId("import-file");
    chosen.addEventListener("change", () => this.careful(async () => {
      const [given] = chosen.files;
      chosen.value = "";
      const text = await given.text();
      const content = given.name.endsWith(".json") ? parsed(text) : (await post("/v1/cases/from-toml", { toml: text })).case;
      byId("example").value = "";
      byId("example-note").textContent = given.name;
      this.show(content);
    }));
  }

  /** Do something that the service may refuse; say so at the form. */
  async careful(action) {
    try {
      await action();
    } catch (problem) {
      if (!(problem instanceof Problem)) throw problem;
      this.form.refuse(problem, { focus: true });
    }
  }
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Problem({ title: "No JSON", detail: `The file is no JSON: ${error.message}.`, status: 400 });
  }
}

await new Page().begin();
