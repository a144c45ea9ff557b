// Pictures that are drawn once and then copied: the static part of the map, robots, names.

import { make } from "../dom.js";
import { Camera } from "./view.js";

const MARGIN = 0.25; // of the window, on each side
const MAX_PIXELS = 12e6; // device pixels; larger pictures have less around them
const MAX_ZOOM = 1.6; // a picture zoomed by more than this is drawn anew at once
const SETTLED = 140; // ms without zooming until the picture is drawn sharp again
const MAX_SPRITES = 200; // when there are more, all are made anew
const SCALE_STEP = Math.SQRT2; // between the scales at which sprites are kept

/** The static part of the map, larger than the window, so that panning draws nothing anew. */
export class CachedPicture {
  #canvas = make("canvas");
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

  /** Draws it as `view` sees it; returns whether it should be drawn once more to be sharp. */
  draw(context, view, ratio, version, now) {
    if (this.#scale !== view.scale) this.#zoomed = now;
    this.#scale = view.scale;
    const zoom = view.scale / this.#camera.scale;
    const same = ratio === this.#ratio && view.width === this.#width && view.height === this.#height;
    const known = same && version === this.#version && this.#covers(view);
    const settled = now - this.#zoomed >= SETTLED;
    if (!known || (zoom !== 1 && (settled || zoom > MAX_ZOOM || zoom < 1 / MAX_ZOOM))) this.#renew(view, ratio, version);
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
    const around = Math.min(MARGIN, Math.max(0, (Math.sqrt(MAX_PIXELS / pixels) - 1) / 2));
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

/** Small pictures: robots and names. */
export class SpriteCache {
  #kept = new Map();

  clear() {
    this.#kept.clear();
  }

  /**
   * Draws a shape, in the context's coordinates [m], from a kept picture that `paint` has made.
   * @param key    tells pictures apart
   * @param reach  {left, right, bottom, top} of the picture [m]
   * @param scale  device pixels per m
   */
  drawShape(context, key, reach, scale, paint) {
    const at = SCALE_STEP ** Math.ceil(Math.log(scale) / Math.log(SCALE_STEP));
    const width = reach.right - reach.left;
    const height = reach.top - reach.bottom;
    const picture = this.#get(`${key} ${at}`, width * at, height * at, (own) => {
      own.setTransform(at, 0, 0, at, -reach.left * at, -reach.bottom * at);
      paint(own, at);
    });
    context.drawImage(picture, reach.left, reach.bottom, picture.width / at, picture.height / at);
  }

  /** Draws a name, its middle top at a point [CSS px]; context in device pixels times `ratio`. */
  drawName(context, text, x, y, { font, size, colour, halo }, ratio) {
    const picture = this.#get(`${text} ${font} ${colour} ${ratio}`, 0, 0, (own, canvas) => {
      own.font = font;
      canvas.width = Math.ceil((own.measureText(text).width + 8) * ratio);
      canvas.height = Math.ceil((size + 8) * ratio);
      own.setTransform(ratio, 0, 0, ratio, 0, 0);
      Object.assign(own, {
        font, textAlign: "left", textBaseline: "top", lineWidth: 3, lineJoin: "round", strokeStyle: halo, fillStyle: colour,
      });
      own.strokeText(text, 4, 4);
      own.fillText(text, 4, 4);
    });
    const [width, height] = [picture.width / ratio, picture.height / ratio];
    context.drawImage(picture, Math.round((x - width / 2) * ratio) / ratio, Math.round((y - 4) * ratio) / ratio, width, height);
  }

  #get(key, width, height, paint) {
    let picture = this.#kept.get(key);
    if (picture) return picture;
    if (this.#kept.size >= MAX_SPRITES) this.#kept.clear();
    picture = make("canvas");
    picture.width = Math.max(1, Math.ceil(width));
    picture.height = Math.max(1, Math.ceil(height));
    paint(picture.getContext("2d"), picture);
    this.#kept.set(key, picture);
    return picture;
  }
}
