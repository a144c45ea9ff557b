// Making a map, and going on with the one in use: the form beside the map, and over it the card of what has changed.

import { byId, make, put, putItems, putLines, putProse, sentence } from "../dom.js";
import { button } from "./fields.js";
import { part } from "./widgets.js";

const NAMED = { class: "small", maxlength: "40", pattern: "[A-Za-z0-9][A-Za-z0-9 _\\-]*", required: "" };
const LONG = 8000; // ms, of a note
const KEEP = { save: "Keep the new map", discard: "Keep the old map" };

/** Begins a map or goes on with one, lets the robot explore, and saves it. */
export class MapMaking {
  element;
  #state = make("p", { class: "words", id: "map-state", role: "status" });
  #notes = make("ul", { class: "lines-of-text map-notes", "aria-label": "Notes about the map" });
  #noUpdate = make("p", { class: "words", id: "map-no-update" });
  #begin;
  #update;
  #explore;
  #finish;
  #save;
  #discard;
  #name = make("input", { id: "map-name", value: "lab", ...NAMED });
  #place = make("input", { id: "map-place", placeholder: "Kitchen", ...NAMED });
  #placed = make("label", { class: "field" }, make("span", {}, "This place is"), this.#place);
  #here;
  #named = make("label", { class: "field" }, make("span", {}, "Name of the map"), this.#name);

  constructor({ send, notify }) {
    const ask = asking(send, notify);
    this.#begin = button("map-begin", "Begin a map", () => ask("begin"));
    this.#update = button("map-update", "Update the map", () => ask("update"));
    this.#explore = button("map-explore", "Explore", () => ask("explore"));
    const askNamed = (step, input) => {
      if (input.checkValidity()) ask(step, { name: input.value });
      else (input.focus(), notify("A name has letters, digits, blanks, - and _ only."));
    };
    this.#here = button("map-name-place", "Name this place", () => askNamed("name_place", this.#place));
    this.#finish = button("map-finish", "Finish, and ask", () => ask("finish"));
    this.#save = button("map-save", KEEP.save, () => (this.#named.hidden ? ask("save") : askNamed("save", this.#name)));
    this.#discard = button("map-discard", KEEP.discard, () => ask("discard"));
    this.element = part("Make a map", this.#state, this.#notes, make("div", { class: "row" }, this.#begin, this.#update, this.#explore), this.#noUpdate,
      this.#placed, make("div", { class: "row" }, this.#here), this.#named, make("div", { class: "row" }, this.#finish, this.#save, this.#discard));
  }

  show(mapping, usable) {
    const { making, exploring, waits, updates, asks, no_update: noUpdate } = mapping ?? {};
    this.element.hidden = !mapping;
    const grows = making && !asks && !waits;
    const there = [
      [!making, this.#begin], [!making && noUpdate === "", this.#update], [!making && noUpdate, this.#noUpdate],
      [grows, this.#explore, this.#placed, this.#here], [grows && !updates, this.#named], [grows && updates, this.#finish],
      [updates ? asks : grows, this.#save], [updates ? asks || grows : grows, this.#discard],
    ];
    for (const [shown, ...elements] of there) for (const one of elements) one.hidden = !shown;
    for (const one of [this.#begin, this.#update]) one.disabled = !usable || Boolean(waits);
    for (const one of [this.#here, this.#finish, this.#save, this.#discard]) one.disabled = !usable;
    this.#explore.disabled = !usable || exploring;
    put(this.#save, updates ? KEEP.save : "Finish and save");
    put(this.#discard, updates ? KEEP.discard : "Discard");
    this.#discard.classList.toggle("danger", !updates);
    putProse(this.#noUpdate, noUpdate ? sentence(`The map in use is not updated: ${noUpdate}`) : "");
    put(this.#state, mapping ? stateOf(mapping) : "");
    putLines(this.#notes, making ? mapping.remarks.map(sentence) : []);
  }
}

/** The map that is made, in words. */
function stateOf({ making, exploring, driven, area, loops, edges, saved, waits, updates, asks }) {
  if (waits) return `Please wait: it ${waits}.`;
  if (asks) return `${updates} is finished, and not saved yet. The map shows what has changed.`;
  if (!making) return `${saved ? `Saved ${saved}. ` : ""}The laser draws the map here while you drive, or while the robot explores by itself.`;
  const left = exploring && edges !== null ? `, ${edges} edges left to explore` : "";
  const how = updates
    ? `${updates} is updated: drive past all that was moved. It stays as it is until you keep the new one.`
    : "Drive through all rooms, or let the robot explore: it MOVES by itself.";
  return `${area.toFixed(0)} m² known, ${driven.toFixed(0)} m driven, ${loops} loops closed${left}. ${how}`;
}

const asking = (send, notify) => (step, rest = {}) => send({ type: "make_map", step, ...rest }) || notify("Not connected: nothing was changed.");

/** Over the map while one is made: new notes, and of one that is updated what has come and gone, and whether it is kept. */
export class MapNews {
  #notify;
  #told = 0; // notes

  /** @param send function(message) @param notify function(text, lasts) */
  constructor({ send, notify }) {
    this.#notify = notify;
    const ask = asking(send, notify);
    for (const step of ["save", "discard"]) {
      put(byId(`changes-${step}`), KEEP[step]);
      byId(`changes-${step}`).addEventListener("click", () => ask(step));
    }
  }

  /** @param mapping of the robot, or null @param changes of the map that is shown @param viewer whether this page may only look */
  show(mapping, changes, viewer) {
    const notes = mapping?.making ? mapping.remarks : [];
    if (notes.length > this.#told) this.#notify(notes.slice(this.#told).map(sentence).join(" "), LONG);
    this.#told = notes.length;
    byId("changes-card").hidden = !mapping?.updates;
    if (!mapping?.updates) return;
    const gone = changes.filter((one) => one.gone).length;
    const count = changes.length === 1 ? "1 change" : `${changes.length} changes`;
    const found = changes.length ? `${count} on ${mapping.updates}: ${gone} gone, ${changes.length - gone} new.` : `Nothing has gone or come on ${mapping.updates}${mapping.asks ? "" : " so far"}.`;
    put(byId("changes-title"), mapping.asks && !viewer ? `${found} Which map is to be kept?` : found);
    putItems(byId("changes-list"), JSON.stringify(changes.map(({ text }) => text)), () => changes.map(item));
    byId("changes-ask").hidden = !mapping.asks || viewer;
  }
}

function item({ gone, text }) {
  const sign = make("i", { class: "change", "data-change": gone ? "gone" : "new", "aria-hidden": "true" }, gone ? "−" : "+");
  return make("li", {}, sign, text);
}
