/** The two gears in mesh, from the outlines that the service computes. */

import { byId, draw, figures, number } from "./elements.js";

const turned = ([x, y], angle) => [x * Math.cos(angle) - y * Math.sin(angle), x * Math.sin(angle) + y * Math.cos(angle)];
const place = ([x, y]) => `${x.toFixed(3)} ${(-y).toFixed(3)}`;

/** All teeth as one closed path in the gear's frame. */
function outline(gear) {
  const points = [];
  for (let tooth = 0; tooth < gear.teeth; tooth += 1) {
    const angle = (-2 * Math.PI * tooth) / gear.teeth;
    points.push(...gear.tooth_mm.map((point) => turned(point, angle)));
  }
  return `M${points.map(place).join("L")}Z`;
}

const circle = (radius) => `M${radius} 0A${radius} ${radius} 0 1 0 ${-radius} 0A${radius} ${radius} 0 1 0 ${radius} 0Z`;

/** A gear as a group that turns about its center: body with its bore, or rim with its outside. */
function gearGroup(gear, kind, stroke) {
  const [x, y] = gear.centre_mm;
  const group = draw("g", { transform: `translate(${x} ${-y})`, "stroke-width": stroke });
  const body = draw("path", { d: outline(gear) + circle(gear.radius_mm.held), class: `gear-${kind}`, "fill-rule": "evenodd" });
  const dashes = `${4 * stroke} ${3 * stroke}`;
  const pitch = draw("path", { d: circle(gear.radius_mm.reference), class: `circle-${kind}`, "stroke-dasharray": dashes });
  const turning = draw("g", {});
  turning.append(body);
  group.append(turning, pitch);
  return { group, turning };
}

function pathOfContact(path, size) {
  const group = draw("g", {});
  const { A, E } = path.points_mm;
  const along = [E[0] - A[0], E[1] - A[1]];
  const beyond = (end, share) => [end[0] + share * along[0], end[1] + share * along[1]];
  const line = (from, to, name, width) => draw("path", {
    d: `M${place(from)}L${place(to)}`, class: name, "stroke-width": width,
  });
  group.append(line(beyond(A, -0.6), beyond(E, 0.6), "action-line", 0.006 * size), line(A, E, "path-line", 0.012 * size));
  const length = Math.hypot(...along);
  const aside = [(-along[1] / length) * 0.045 * size, (along[0] / length) * 0.045 * size];
  for (const [name, [x, y]] of Object.entries(path.points_mm)) {
    group.append(draw("circle", { cx: x, cy: -y, r: 0.011 * size, class: "path-dot", "stroke-width": 0.004 * size }));
    const side = name === "B" || name === "D" ? -1.35 : 1;
    group.append(draw("text", {
      x: x + side * aside[0], y: -(y + side * aside[1]) + 0.015 * size, class: "path-name", "font-size": 0.045 * size,
      "text-anchor": "middle",
    }, name));
  }
  return group;
}

function words(found) {
  const { pinion, wheel, figures: known } = found;
  const kind = found.internal ? "ring gear around it" : "wheel";
  return `Pinion with ${pinion.teeth} teeth and ${kind} with ${wheel.teeth}; the path of contact from A to E is `
    + `${number(known.transverse_contact_ratio, 3)} base pitches long. B to D is single contact where that is below 2.`;
}

export class Drawing {
  constructor() {
    this.turning = [];
    for (const name of ["input", "followed"]) byId("roll").addEventListener(name, () => this.roll());
  }

  /** @param {object} found answer of /v1/drafts/outline */
  show(found) {
    this.mark("");
    this.gears = [found.pinion, found.wheel];
    const [{ A, C, E }, tip] = [found.path_of_contact.points_mm, found.pinion.radius_mm];
    const size = Math.max(2.6 * (tip.tip - tip.root), 1.25 * Math.hypot(E[0] - A[0], E[1] - A[1])) * 2;
    this.turning = [
      this.scene("mesh-drawing", found, [C[0] - 0.75 * size, -C[1] - size / 2, 1.5 * size, size], size, true),
      this.scene("whole-drawing", found, ...this.whole(found)),
    ].flat();
    byId("mesh-words").textContent = words(found);
    const k = found.figures;
    figures(byId("pair-figures"), [
      ["contact ratio, transverse", number(k.transverse_contact_ratio, 3)],
      ["overlap", number(k.overlap_ratio, 3)],
      ["working pressure angle", `${number(k.working_pressure_angle_deg, 4)}°`],
      ["base pitch", `${number(k.base_pitch_mm, 4)} mm`],
      ["backlash, circumferential", `${number(Number(k.circumferential_backlash_um.toFixed(1)), 3)} µm`],
    ]);
    this.roll();
  }

  /** Say that the pair as typed cannot be drawn: what is shown is the last one that could. */
  stale() {
    this.mark("(not yet the pair as typed)");
  }

  mark(text) {
    byId("drawing-state").textContent = text;
    byId("thing").classList.toggle("stale", Boolean(text));
  }

  whole(found) {
    const edge = this.gears.map((gear) => Math.max(gear.radius_mm.tip, gear.radius_mm.held));
    const [, y] = found.wheel.centre_mm;
    const low = Math.min(-edge[0], y - edge[1]);
    const high = Math.max(edge[0], y + edge[1]);
    const half = Math.max(...edge);
    const room = 0.03 * (high - low);
    return [[-half - room, -high - room, 2 * (half + room), high - low + 2 * room], 0.6 * (high - low), false];
  }

  scene(id, found, box, size, detailed) {
    const svg = byId(id);
    svg.setAttribute("viewBox", box.map((value) => value.toFixed(3)).join(" "));
    const made = [gearGroup(found.wheel, "wheel", 0.005 * size), gearGroup(found.pinion, "pinion", 0.005 * size)];
    svg.replaceChildren(...made.map(({ group }) => group));
    if (detailed) svg.append(pathOfContact(found.path_of_contact, size));
    return [{ node: made[1].turning, gear: found.pinion }, { node: made[0].turning, gear: found.wheel }];
  }

  /** Turn both gears to the position of the slider. */
  roll() {
    const position = Number(byId("roll").value);
    byId("roll-value").textContent = position.toFixed(2);
    for (const { node, gear } of this.turning) {
      const angle = gear.angle_deg + (gear.turn * position * 360) / gear.teeth;
      node.setAttribute("transform", `rotate(${(-angle).toFixed(4)})`);
    }
  }
}

