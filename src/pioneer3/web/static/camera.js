// Where a picture is taken from: world [m, y up] <-> canvas [CSS px, y down].

export class Camera {
  width = 1;
  height = 1;
  x = 0; // world point in the middle
  y = 0;
  scale = 60; // px per m

  toScreen(x, y) {
    return { x: this.width / 2 + (x - this.x) * this.scale, y: this.height / 2 - (y - this.y) * this.scale };
  }

  toWorld(px, py) {
    return { x: this.x + (px - this.width / 2) / this.scale, y: this.y - (py - this.height / 2) / this.scale };
  }

  /** Applies the camera to a context whose units are CSS pixels times `ratio`. */
  apply(context, ratio) {
    const k = this.scale * ratio;
    context.setTransform(k, 0, 0, -k, (this.width * ratio) / 2 - this.x * k, (this.height * ratio) / 2 + this.y * k);
  }

  /** Visible part of the world. */
  get window() {
    const { x: left, y: top } = this.toWorld(0, 0);
    const { x: right, y: bottom } = this.toWorld(this.width, this.height);
    return { left, right, bottom, top };
  }
}
