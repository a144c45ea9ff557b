// Cells of a map: a small grey picture from the server, coloured here, once for each theme and size.

const CLEAR = 150; // of 255: the grid shows through free cells
const [OCCUPIED, FREE] = [1, 2]; // as the server has them; the shades are 85 times as bright

export class Cells {
  #states; // Uint8Array, the lowest row first
  #pictures = new Map(); // cells joined along each side -> canvas
  #colours = "";

  constructor(states, { width, height, side, corner }) {
    this.#states = states;
    Object.assign(this, { width, height, side, corner });
  }

  /** Reads what the server sent. */
  static async read({ png, ...where }) {
    const bytes = Uint8Array.from(atob(png), (char) => char.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
    const { width, height } = picture;
    const context = makeCanvas(width, height).getContext("2d", { willReadFrequently: true });
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const states = Uint8Array.from({ length: width * height }, (_, at) => Math.round(data[4 * at] / 85));
    return new Cells(states, { width, height, ...where });
  }

  /** The four corners in the map [m]. */
  get outline() {
    const [x, y, theta] = this.corner;
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    const [width, height] = [this.width * this.side, this.height * this.side];
    return [[0, 0], [width, 0], [width, height], [0, height]].map(([a, b]) => [x + c * a - s * b, y + s * a + c * b]);
  }

  /** In world coordinates, about one cell a pixel where there are more: none gets lost. */
  draw(context, camera, palette, ratio) {
    const pixels = camera.scale * this.side * ratio;
    const joined = 2 ** Math.max(0, Math.floor(Math.log2(1 / pixels)));
    const [x, y, theta] = this.corner;
    context.save();
    context.translate(x, y);
    context.rotate(theta);
    context.scale(this.side * joined, this.side * joined); // row 0 is the lowest, as y grows upwards
    context.imageSmoothingEnabled = pixels < 3; // large cells have edges
    context.drawImage(this.#picture(joined, palette), 0, 0);
    context.restore();
  }

  #picture(joined, palette) {
    const colours = `${palette.cell} ${palette.free}`;
    if (this.#colours !== colours) this.#pictures.clear();
    this.#colours = colours;
    if (!this.#pictures.has(joined)) this.#pictures.set(joined, this.#paint(joined, palette));
    return this.#pictures.get(joined);
  }

  #paint(joined, palette) {
    const [width, height] = [Math.ceil(this.width / joined), Math.ceil(this.height / joined)];
    const canvas = makeCanvas(width, height);
    const context = canvas.getContext("2d");
    const image = context.createImageData(width, height);
    const pixels = new Uint32Array(image.data.buffer);
    const [occupied, free] = [pixelOf(palette.cell, 255), pixelOf(palette.free, CLEAR)];
    this.#states.forEach((state, at) => {
      const here = Math.floor(Math.floor(at / this.width) / joined) * width + Math.floor((at % this.width) / joined);
      if (state === OCCUPIED) pixels[here] = occupied;
      else if (state === FREE && pixels[here] === 0) pixels[here] = free;
    });
    context.putImageData(image, 0, 0);
    return canvas;
  }
}

function makeCanvas(width, height) {
  return Object.assign(document.createElement("canvas"), { width, height });
}

/** #rrggbb as four bytes of an image. */
function pixelOf(colour, alpha) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return new Uint32Array(new Uint8Array([r, g, b, alpha]).buffer)[0];
}
