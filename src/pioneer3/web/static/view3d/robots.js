// Robots whose wheels turn, their names, rings around the chosen ones; people and boxes of the simulated world.

import { BoxGeometry, CapsuleGeometry, Color, CylinderGeometry, Group, Mesh, MeshLambertMaterial, RingGeometry, SphereGeometry } from "../vendor/three-0.187.0/three.js";
import { Bodies } from "./bodies.js";
import { flat } from "./floor.js";
import { free, label, merge } from "./shapes.js";

const REACH = 0.3; // m, of a robot whose shape is not known

/** One robot of the picture: the ring and the name are its own, the body is one of many. */
class Figure {
  group = new Group();
  pose = null; // where it is drawn
  turned = []; // its wheels [rad]
  #ring;
  #label = null;
  #labelled = "";

  constructor(shape) {
    const reach = shape ? Math.max(shape.length_front, shape.length_rear, shape.width / 2) : REACH;
    this.#ring = new Mesh(new RingGeometry(reach + 0.05, reach + 0.1, 48), flat("#ffffff"));
    this.#ring.position.z = 0.02;
    this.group.add(this.#ring);
  }

  show(body, pose, { ring, name, palette, faint, hidden, ground }) {
    if (body) this.#roll(body.wheels, pose);
    if (body && !hidden) body.draw(ground.stance(pose), this.turned, faint);
    this.pose = { ...pose, z: ground.height(pose.x, pose.y) };
    this.group.visible = !hidden;
    this.group.position.set(pose.x, pose.y, this.pose.z);
    this.#ring.visible = ring > 0;
    this.#ring.material.color.set(palette.nose);
    Object.assign(this.#ring.material, { transparent: ring < 1, opacity: ring });
    this.#name(name, palette);
  }

  /** Turns the wheels by the way that the drawn robot has moved: their motion agrees with what is seen. */
  #roll(wheels, { x, y, theta }) {
    if (this.turned.length !== wheels.length) this.turned = wheels.map(() => 0);
    if (!this.pose || Math.hypot(x - this.pose.x, y - this.pose.y) > 1) return;
    const way = (x - this.pose.x) * Math.cos(theta) + (y - this.pose.y) * Math.sin(theta);
    const turn = Math.atan2(Math.sin(theta - this.pose.theta), Math.cos(theta - this.pose.theta));
    wheels.forEach(({ at, radius }, number) => (this.turned[number] += (way - turn * at[1]) / radius));
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
    this.group.add(this.#bodies.group);
  }

  /** @param placed [[Robot, pose]], things [[thing, pose]] */
  show(placed, things, { selected, chosen, several, isLive, shown, palette, hidden, ground }) {
    const seen = new Set();
    this.#bodies.begin();
    for (const [robot, pose] of placed) {
      seen.add(robot);
      const ring = !several ? 0 : robot === selected ? 1 : chosen.includes(robot) ? 0.4 : 0;
      const figure = this.#figure(robot, robot.shape);
      figure.show(robot.shape && this.#bodies.get(robot.shape.model), pose, {
        ring, palette, ground, name: several && shown("names") ? robot.name : "", faint: robot !== selected && !isLive(robot), hidden: robot === hidden,
      });
    }
    for (const [thing, pose] of things) {
      if (thing.own || (thing.kind !== "robot" && !shown("things"))) continue;
      seen.add(thing.id);
      if (thing.kind === "robot") {
        this.#figure(thing.id, null).show(this.#bodies.get(thing.model), pose, { ring: 0, palette, ground, name: shown("names") ? thing.name : "", faint: false, hidden: false });
      } else this.#showThing(thing, pose, palette, ground);
    }
    for (const [key, figure] of this.#figures) if (!seen.has(key)) (figure.dispose(), this.#figures.delete(key));
    for (const [key, { mesh }] of this.#things) if (!seen.has(key)) (free(mesh), this.#things.delete(key));
  }

  /** Where a robot is drawn: pose and turned wheels, or null. */
  drawn(robot) {
    const figure = this.#figures.get(robot);
    return figure?.pose ? { ...figure.pose, wheels: figure.turned } : null;
  }

  #figure(key, shape) {
    if (!this.#figures.has(key)) {
      const figure = new Figure(shape);
      this.#figures.set(key, figure);
      this.group.add(figure.group);
    }
    return this.#figures.get(key);
  }

  #showThing(thing, pose, palette, ground) {
    let known = this.#things.get(thing.id);
    if (known?.thing !== thing || known.palette !== palette) {
      if (known) free(known.mesh);
      const mesh = new Mesh(thing.kind === "box" ? boxOf(thing, palette) : personOf(thing, palette), new MeshLambertMaterial({ vertexColors: true }));
      known = { mesh, thing, palette };
      this.#things.set(thing.id, known);
      this.group.add(mesh);
    }
    known.mesh.position.set(pose.x, pose.y, ground.height(pose.x, pose.y));
    known.mesh.rotation.z = pose.theta;
  }

  dispose() {
    for (const figure of this.#figures.values()) figure.dispose();
    for (const { mesh } of this.#things.values()) free(mesh);
    this.#bodies.dispose();
  }
}

function boxOf({ front, rear, side, height }, palette) {
  const geometry = new BoxGeometry(front + rear, 2 * side, height).translate((front - rear) / 2, 0, height / 2);
  return merge([{ geometry, color: new Color(palette["box-edge"]) }]);
}

/** Legs, trunk and head, and a nose that tells the heading. */
function personOf({ side, height }, palette) {
  const [body, skin] = [new Color(palette.person), new Color(palette["person-head"])];
  const r = Math.min(side, 0.22);
  const upright = (geometry) => geometry.rotateX(Math.PI / 2);
  return merge([
    ...[r * 0.5, -r * 0.5].map((y) => ({ geometry: upright(new CylinderGeometry(r * 0.36, r * 0.3, 0.85, 12)).translate(0, y, 0.425), color: body.clone().multiplyScalar(0.6) })),
    { geometry: upright(new CapsuleGeometry(r * 0.8, 0.4, 4, 14)).scale(0.7, 1.1, 1).translate(0, 0, 1.1), color: body },
    { geometry: new SphereGeometry(0.12, 16, 12).translate(0, 0, height - 0.12), color: skin },
    { geometry: new SphereGeometry(0.03, 8, 6).translate(0.12, 0, height - 0.13), color: body },
  ]);
}
