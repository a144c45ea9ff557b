// Bodies of robots, from the description that their URDF is made of: one instanced mesh draws a part of all robots of a model.

import {
  BoxGeometry, Color, CylinderGeometry, DynamicDrawUsage, Euler, Group, InstancedMesh, Matrix4, MeshLambertMaterial, Quaternion, SRGBColorSpace, Vector3,
} from "../vendor/three-0.187.0/three.js";
import { ask } from "../http.js";
import { free, merge } from "./shapes.js";

const OLD = 0.45; // opacity of a robot that does not report
const ROOM = 4; // instances at first
const sidesOf = (width) => (width < 0.05 ? 6 : 14); // of a cylinder [m]

export class Bodies {
  group = new Group();
  #models = new Map(); // model -> Model, or null while it comes
  #changed;
  #materials = [1, OLD].map((opacity) => (
    new MeshLambertMaterial({ vertexColors: true, emissive: "#10161f", transparent: opacity < 1, opacity }) // black parts can be told from a dark floor
  ));

  /** @param changed function(), when a body has come */
  constructor(changed) {
    this.#changed = changed;
  }

  /** The body of a model, or null while it is not there: it is fetched once. */
  get(name) {
    if (!this.#models.has(name)) {
      this.#models.set(name, null);
      ask("GET", `models/${encodeURIComponent(name)}`).then((body) => {
        const model = new Model(body, this.#materials);
        this.group.add(model.group);
        this.#models.set(name, model);
        this.#changed();
      }, () => {});
    }
    return this.#models.get(name);
  }

  /** Before the robots of a frame: none is drawn. */
  begin() {
    for (const model of this.#models.values()) model?.begin();
  }

  dispose() {
    for (const model of this.#models.values()) if (model) free(model.group);
    for (const material of this.#materials) material.dispose();
  }
}

/** The parts of one model. */
class Model {
  group = new Group();
  wheels; // [{side, at, radius}]
  #body; // [instances of robots that report, of those that do not]
  #tyres; // the same for each wheel

  constructor({ links }, materials) {
    const placed = ({ at, yaw }) => new Matrix4().makeRotationZ(yaw).setPosition(...at);
    const still = links.filter(({ wheel }) => !wheel);
    const turning = links.filter(({ wheel }) => wheel);
    const instances = (geometry) => materials.map((material) => new Instances(this.group, geometry, material));
    this.#body = instances(mergeSolids(still.flatMap((link) => link.solids.map((solid) => ({ solid, matrix: placed(link) })))));
    const alike = new Map(); // wheels of one shape are drawn together
    this.#tyres = turning.map(({ solids }) => {
      const shape = JSON.stringify(solids);
      if (!alike.has(shape)) alike.set(shape, instances(mergeSolids(solids.map((solid) => ({ solid, matrix: new Matrix4() })))));
      return alike.get(shape);
    });
    this.wheels = turning.map(({ wheel, at, solids }) => ({ side: wheel, at, radius: solids[0].size[0] / 2 }));
  }

  begin() {
    for (const kinds of [this.#body, ...this.#tyres]) for (const instances of kinds) instances.begin();
  }

  /** Draws one robot. @param base where it stands, a matrix, turned of its wheels [rad] */
  draw(base, turned, faint) {
    const kind = Number(faint);
    this.#body[kind].add(base);
    this.wheels.forEach(({ at }, number) => {
      const wheel = new Matrix4().makeRotationY(turned[number]).setPosition(...at);
      this.#tyres[number][kind].add(wheel.premultiply(base));
    });
  }
}

/** One geometry at many places; there is room for more when it is needed. */
class Instances {
  #mesh;
  #group;

  constructor(group, geometry, material) {
    this.#group = group;
    this.#reserve(ROOM, geometry, material);
  }

  begin() {
    this.#mesh.count = 0;
  }

  add(matrix) {
    const { count, instanceMatrix, geometry, material } = this.#mesh;
    if (count === instanceMatrix.count) this.#reserve(2 * count, geometry, material);
    this.#mesh.setMatrixAt(count, matrix);
    this.#mesh.instanceMatrix.needsUpdate = true;
    this.#mesh.count = count + 1;
  }

  #reserve(room, geometry, material) {
    const before = this.#mesh;
    this.#mesh = new InstancedMesh(geometry, material, room);
    Object.assign(this.#mesh, { count: 0, frustumCulled: false });
    this.#mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.#group.add(this.#mesh);
    if (!before) return;
    this.#mesh.instanceMatrix.array.set(before.instanceMatrix.array);
    before.removeFromParent();
    before.dispose();
  }
}

/** One geometry of many boxes and cylinders with colours. @param parts [{solid, matrix}] of a body from the server */
function mergeSolids(parts) {
  const made = parts.map(({ solid, matrix }) => {
    const [x, y, z] = solid.size;
    const geometry = solid.shape === "box" ? new BoxGeometry(x, y, z) : new CylinderGeometry(x / 2, x / 2, z, sidesOf(x)).rotateX(Math.PI / 2);
    const [roll, pitch, yaw] = solid.turned;
    const turned = new Quaternion().setFromEuler(new Euler(roll, pitch, yaw, "ZYX"));
    const own = new Matrix4().compose(new Vector3(...solid.at), turned, new Vector3(1, 1, 1));
    return { geometry: geometry.applyMatrix4(own.premultiply(matrix)), color: new Color().setRGB(...solid.color, SRGBColorSpace) };
  });
  return merge(made);
}
