// Robots, from the description that their URDF is made of; their wheels turn; rings around the chosen ones.

import {
  BoxGeometry, CapsuleGeometry, Color, CylinderGeometry, Group, Matrix4, Mesh, MeshLambertMaterial, RingGeometry, SphereGeometry,
} from "../vendor/three-0.187.0/three.js";
import { ask } from "../http.js";
import { flat } from "./floor.js";
import { free, label, merge, mergeSolids } from "./shapes.js";

const HEIGHT = { box: 0.5, person: 1.7 }; // m: the simulated world is flat, its things stand so high
const REACH = 0.3; // m, of a robot whose shape is not known
const OLD = 0.45; // opacity of a robot that does not report

/** Bodies by model: fetched once, as merged geometries. */
class Bodies {
  #bodies = new Map(); // model -> {still, wheels: [{side, at, geometry, radius}]} or null while it comes
  #changed;

  constructor(changed) {
    this.#changed = changed;
  }

  get(model) {
    if (!this.#bodies.has(model)) {
      this.#bodies.set(model, null);
      ask("GET", `models/${encodeURIComponent(model)}`).then((body) => (this.#bodies.set(model, build(body)), this.#changed()), () => {});
    }
    return this.#bodies.get(model);
  }

  dispose() {
    for (const body of this.#bodies.values()) for (const { geometry } of body ? [body, ...body.wheels] : []) geometry.dispose();
  }
}

function build({ links }) {
  const placed = ({ at, yaw }) => new Matrix4().makeRotationZ(yaw).setPosition(...at);
  const still = links.filter(({ wheel }) => !wheel);
  const parts = still.flatMap((link) => link.solids.map((solid) => ({ solid, matrix: placed(link) })));
  const wheels = links.filter(({ wheel }) => wheel).map(({ wheel, at, solids }) => ({
    side: wheel, at, radius: solids[0].size[0] / 2,
    geometry: mergeSolids(solids.map((solid) => ({ solid, matrix: new Matrix4() }))),
  }));
  return { geometry: mergeSolids(parts), wheels };
}

/** One robot of the picture. */
class Figure {
  group = new Group();
  #body = null;
  #wheels = [];
  #material = new MeshLambertMaterial({ vertexColors: true, emissive: "#10161f" }); // black parts can be told from a dark floor
  #ring;
  #label = null;
  #labelled = "";
  #last = null; // pose

  constructor(shape) {
    this.reach = shape ? Math.max(shape.length_front, shape.length_rear, shape.width / 2) : REACH;
    this.#ring = new Mesh(new RingGeometry(this.reach + 0.05, this.reach + 0.1, 48), flat("#ffffff"));
    this.#ring.position.z = 0.02;
    this.group.add(this.#ring);
  }

  show(body, pose, { ring, name, palette, faint }) {
    if (body && body !== this.#body) this.#dress(body);
    this.group.position.set(pose.x, pose.y, 0);
    this.group.rotation.z = pose.theta;
    if (this.#last && body) this.#roll(body, pose);
    this.#last = pose;
    this.#ring.visible = ring > 0;
    this.#ring.material.color.set(palette.nose);
    Object.assign(this.#ring.material, { transparent: ring < 1, opacity: ring });
    Object.assign(this.#material, { transparent: faint, opacity: faint ? OLD : 1 });
    this.#name(name, palette);
  }

  #dress(body) {
    this.#body = body;
    const part = (geometry) => Object.assign(new Mesh(geometry, this.#material), { userData: { shared: true } });
    this.group.add(part(body.geometry));
    this.#wheels = body.wheels.map(({ geometry, at }) => {
      const wheel = part(geometry);
      wheel.position.set(...at);
      this.group.add(wheel);
      return wheel;
    });
  }

  /** Turns the wheels by the way that the drawn robot has moved: their motion agrees with what is seen. */
  #roll(body, { x, y, theta }) {
    const { x: x0, y: y0, theta: before } = this.#last;
    const way = (x - x0) * Math.cos(theta) + (y - y0) * Math.sin(theta);
    const turn = Math.atan2(Math.sin(theta - before), Math.cos(theta - before));
    if (Math.hypot(x - x0, y - y0) > 1) return;
    body.wheels.forEach(({ at, radius }, number) => (this.#wheels[number].rotation.y += (way - turn * at[1]) / radius));
  }

  #name(name, palette) {
    const key = `${name} ${palette.label}`;
    if (key === this.#labelled) return;
    this.#labelled = key;
    if (this.#label) free(this.#label);
    this.#label = name ? label(name, palette.label, palette.floor) : null;
    if (!this.#label) return;
    this.#label.position.z = 0.5;
    this.group.add(this.#label);
  }

  dispose() {
    free(this.group);
    this.#material.dispose();
  }

  get rolled() {
    return this.#wheels.map((wheel) => wheel.rotation.y);
  }
}

export class Robots {
  group = new Group();
  #bodies;
  #figures = new Map(); // Robot, or thing's number -> Figure
  #things = new Map(); // thing's number -> {mesh, thing, colours}

  /** @param changed function(), when a body has come */
  constructor(changed) {
    this.#bodies = new Bodies(changed);
  }

  /** @param placed [[Robot, pose]], things [[thing, pose]] */
  show(placed, things, { selected, chosen, several, isLive, shown, palette, hidden }) {
    const seen = new Set();
    for (const [robot, pose] of placed) {
      seen.add(robot);
      const ring = !several ? 0 : robot === selected ? 1 : chosen.includes(robot) ? 0.4 : 0;
      const figure = this.#figure(robot, robot.shape);
      figure.group.visible = robot !== hidden;
      figure.show(robot.shape && this.#bodies.get(robot.shape.model), pose, {
        ring, palette, name: several && shown("names") ? robot.name : "", faint: robot !== selected && !isLive(robot),
      });
    }
    for (const [thing, pose] of things) {
      if (thing.own || (thing.kind !== "robot" && !shown("things"))) continue;
      seen.add(thing.id);
      if (thing.kind === "robot") {
        this.#figure(thing.id, null).show(this.#bodies.get(thing.model), pose, { ring: 0, palette, name: shown("names") ? thing.name : "", faint: false });
      } else this.#showThing(thing, pose, palette);
    }
    for (const [key, figure] of this.#figures) if (!seen.has(key)) (figure.dispose(), this.#figures.delete(key));
    for (const [key, { mesh }] of this.#things) if (!seen.has(key)) (free(mesh), this.#things.delete(key));
  }

  /** Where a robot is drawn: pose and turned wheels, or null. */
  drawn(robot) {
    const figure = this.#figures.get(robot);
    if (!figure) return null;
    const { position: { x, y }, rotation: { z: theta } } = figure.group;
    return { x, y, theta, wheels: figure.rolled };
  }

  #figure(key, shape) {
    if (!this.#figures.has(key)) {
      const figure = new Figure(shape);
      this.#figures.set(key, figure);
      this.group.add(figure.group);
    }
    return this.#figures.get(key);
  }

  #showThing(thing, pose, palette) {
    let known = this.#things.get(thing.id);
    if (known?.thing !== thing || known.palette !== palette) {
      if (known) free(known.mesh);
      const mesh = new Mesh(thing.kind === "box" ? boxOf(thing, palette) : personOf(thing, palette), new MeshLambertMaterial({ vertexColors: true }));
      known = { mesh, thing, palette };
      this.#things.set(thing.id, known);
      this.group.add(mesh);
    }
    known.mesh.position.set(pose.x, pose.y, 0);
    known.mesh.rotation.z = pose.theta;
  }

  dispose() {
    for (const figure of this.#figures.values()) figure.dispose();
    for (const { mesh } of this.#things.values()) free(mesh);
    this.#bodies.dispose();
  }
}

function boxOf({ front, rear, side }, palette) {
  const geometry = new BoxGeometry(front + rear, 2 * side, HEIGHT.box).translate((front - rear) / 2, 0, HEIGHT.box / 2);
  return merge([{ geometry, color: new Color(palette["box-edge"]) }]);
}

/** Legs, trunk and head, and a nose that tells the heading. */
function personOf({ side }, palette) {
  const [body, skin] = [new Color(palette.person), new Color(palette["person-head"])];
  const r = Math.min(side, 0.22);
  const upright = (geometry) => geometry.rotateX(Math.PI / 2);
  return merge([
    ...[r * 0.5, -r * 0.5].map((y) => ({ geometry: upright(new CylinderGeometry(r * 0.36, r * 0.3, 0.85, 12)).translate(0, y, 0.425), color: body.clone().multiplyScalar(0.6) })),
    { geometry: upright(new CapsuleGeometry(r * 0.8, 0.4, 4, 14)).scale(0.7, 1.1, 1).translate(0, 0, 1.1), color: body },
    { geometry: new SphereGeometry(0.12, 16, 12).translate(0, 0, HEIGHT.person - 0.12), color: skin },
    { geometry: new SphereGeometry(0.03, 8, 6).translate(0.12, 0, HEIGHT.person - 0.13), color: body },
  ]);
}
