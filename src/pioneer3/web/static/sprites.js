// Small pictures that are drawn once and then copied: robots, names.

const MOST = 200; // pictures; when there are more, all are made anew
const STEP = Math.SQRT2; // between the scales at which pictures are kept

export class Sprites {
  #kept = new Map();

  clear() {
    this.#kept.clear();
  }

  /**
   * Draws what `paint` draws, in the context's coordinates [m], from a kept picture.
   * @param key    tells pictures apart
   * @param reach  {left, right, bottom, top} of the picture [m]
   * @param scale  device pixels per m
   */
  drawShape(context, key, reach, scale, paint) {
    const at = STEP ** Math.ceil(Math.log(scale) / Math.log(STEP));
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
    if (this.#kept.size >= MOST) this.#kept.clear();
    picture = document.createElement("canvas");
    picture.width = Math.max(1, Math.ceil(width));
    picture.height = Math.max(1, Math.ceil(height));
    paint(picture.getContext("2d"), picture);
    this.#kept.set(key, picture);
    return picture;
  }
}
