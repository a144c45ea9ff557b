// The class's link, as an address with a code, and as a QR code: small at the top, large for a projector.

import { byId, make, put, putItems, set } from "../dom.js";
import { ask } from "../http.js";

const ONLY_HERE = "Only this computer can open this link. To let other devices in, end the class and start it with --lan.";

export class Invitation {
  #notify;
  #url = null;

  /** @param notify function(text) */
  constructor({ notify }) {
    this.#notify = notify;
    byId("invitation-small").addEventListener("click", () => byId("projector").showModal());
    byId("projector-close").addEventListener("click", () => byId("projector").close());
    byId("copy-link").addEventListener("click", () => copy(this.#url, notify));
  }

  /** @param {import("../messages.d.ts").Class} told */
  show({ join_url: url, lan, locked, seats }) {
    const names = seats.flatMap(({ name }) => (name === null ? [] : [name]));
    put(byId("joined"), `${names.length} of ${seats.length} have joined`);
    put(byId("projector-count"), locked ? "Joining is locked." : `${names.length} of ${seats.length} have joined.`);
    putItems(byId("projector-names"), names.join("\n"), () => names.map((name) => make("li", {}, name)));
    put(byId("projector-note"), lan ? "" : ONLY_HERE);
    put(byId("invitation-note"), lan ? "" : "this computer only");
    if (url === this.#url) return;
    this.#url = url;
    const [address, code] = (url ?? "#").split("#");
    put(byId("projector-address"), address);
    put(byId("projector-code"), code.replace(/(....)(?=.)/g, "$1 ")); // in groups, as people read it
    this.#draw();
  }

  async #draw() {
    try {
      const { svg } = await ask("GET", "class/link");
      for (const id of ["qr-small", "qr-large"]) byId(id).replaceChildren(pictureOf(svg, id === "qr-large" ? "QR code of the class's link" : ""));
    } catch (error) {
      this.#notify(error.message);
    }
  }
}

function pictureOf(svg, label) {
  const picture = document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
  set(picture, "aria-hidden", label ? null : "true");
  set(picture, "role", label ? "img" : null);
  set(picture, "aria-label", label || null);
  return picture;
}

/** Copies a text, and says whether that worked: browsers allow it on secure pages and on this computer only. */
export async function copy(text, notify) {
  try {
    await navigator.clipboard.writeText(text);
    notify("Copied.");
  } catch {
    notify(copyBySelection(text) ? "Copied." : "This browser does not copy here: mark the text, and copy it yourself.");
  }
}

/** The way of old, which works over http too. */
function copyBySelection(text) {
  const area = make("textarea", { class: "off-screen", "aria-hidden": "true", readonly: "" }, text);
  const parent = document.querySelector("dialog[open]") ?? document.body; // what is outside of an open dialog takes no focus
  const before = document.activeElement;
  parent.append(area);
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  before?.focus();
  return done;
}
