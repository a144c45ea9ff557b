// A picture of what stands still, larger than the window, so that panning draws nothing anew.

import { Camera } from "./camera.js";

const AROUND = 0.25; // of the window, on each side
const MOST = 12e6; // device pixels; larger pictures have less around them
const CLOSE = 1.6; // a picture zoomed by more than this is drawn anew at once
const REST = 140; // ms without zooming until the picture is drawn sharp again

export class Still {
  #canvas = document.createElement("canvas");
  #context;
  #camera = new Camera();
  #paint;
  #opaque;
  #ratio = 0;
  #width = 0; // of the window it was made for
  #height = 0;
  #version = null;
  #scale = 0; // seen last
  #zoomed = -Infinity; // when [ms]

  /**
   * @param paint  function(context, camera, ratio): draws in world coordinates
   * @param opaque whether it covers all
   */
  constructor(paint, { opaque = false } = {}) {
    this.#paint = paint;
    this.#opaque = opaque;
    this.#context = this.#canvas.getContext("2d", { alpha: !opaque });
  }

  /** Draws it as `view` sees it; says whether it should be drawn once more to be sharp. */
  draw(context, view, ratio, version, now) {
    if (this.#scale !== view.scale) this.#zoomed = now;
    this.#scale = view.scale;
    const zoom = view.scale / this.#camera.scale;
    const same = ratio === this.#ratio && view.width === this.#width && view.height === this.#height;
    const known = same && version === this.#version && this.#covers(view);
    const rests = now - this.#zoomed >= REST;
    if (!known || (zoom !== 1 && (rests || zoom > CLOSE || zoom < 1 / CLOSE))) this.#renew(view, ratio, version);
    this.#blit(context, view, ratio);
    return view.scale !== this.#camera.scale;
  }

  /** Whether all that `view` sees is in the picture. */
  #covers(view) {
    const [mine, seen] = [this.#camera.window, view.window];
    return mine.left <= seen.left && mine.right >= seen.right && mine.bottom <= seen.bottom && mine.top >= seen.top;
  }

  #renew(view, ratio, version) {
    const camera = this.#camera;
    const pixels = view.width * view.height * ratio * ratio;
    const around = Math.min(AROUND, Math.max(0, (Math.sqrt(MOST / pixels) - 1) / 2));
    // whole pixels around: moved by whole pixels, it is the same picture
    const [across, down] = [view.width, view.height].map((size) => (2 * Math.floor(around * size * ratio)) / ratio);
    Object.assign(camera, { width: view.width + across, height: view.height + down, x: view.x, y: view.y, scale: view.scale });
    const [width, height] = [camera.width, camera.height].map((size) => Math.ceil(size * ratio));
    if (this.#canvas.width !== width || this.#canvas.height !== height) {
      this.#canvas.width = width;
      this.#canvas.height = height;
    }
    this.#width = view.width;
    this.#height = view.height;
    this.#ratio = ratio;
    this.#version = version;
    const context = this.#context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    if (!this.#opaque) context.clearRect(0, 0, width, height);
    camera.apply(context, ratio);
    this.#paint(context, camera, ratio);
  }

  #blit(context, view, ratio) {
    const camera = this.#camera;
    const zoom = view.scale / camera.scale;
    const { left, top } = camera.window;
    const corner = view.toScreen(left, top);
    context.setTransform(1, 0, 0, 1, 0, 0);
    // whole pixels at rest: lines stay sharp
    if (zoom === 1) context.drawImage(this.#canvas, Math.round(corner.x * ratio), Math.round(corner.y * ratio));
    else context.drawImage(this.#canvas, corner.x * ratio, corner.y * ratio, this.#canvas.width * zoom, this.#canvas.height * zoom);
  }
}
