// The toolbar of the map's editor under the map, and the editor's keys.

import { byId, hasModifier, isTyping, put, set } from "../dom.js";

const TOOLS = ["select", "erase", "wall", "place", "line", "area"];
const HINTS = {
  select: "Tap a place, a line or an area to rename or delete it.",
  erase: "Drag a box: walls that lie in it whole are erased.",
  wall: "Drag from one end of a wall to the other.",
  place: "Type a name, then tap the place; drag to give it a heading.",
  line: "Drag a line that robots do not cross.",
  area: "Drag an area that robots do not enter.",
};
const ROLES = { goal: "Goal", dock: "Dock", home: "Home", place: "Place", line: "Line", area: "Area" };
const WRONG = "A name of a file has letters, digits, blanks, - and _ only.";

export class MapToolbar {
  #editor;
  #notify;
  #list = "";
  #shown = null; // the object whose name the field has

  /**
   * @param editor the MapEditor
   * @param notify function(text)
   */
  constructor({ editor, notify }) {
    this.#editor = editor;
    this.#notify = notify;
    for (const tool of TOOLS) byId(`map-tool-${tool}`).addEventListener("click", (event) => this.#pick(tool, event));
    byId("map-object").addEventListener("change", ({ target }) => {
      editor.setTool("select");
      editor.select(target.value === "" ? null : Number(target.value));
    });
    byId("object-name").addEventListener("change", ({ target }) => this.#rename(target));
    byId("object-remove").addEventListener("click", () => editor.remove());
    byId("map-undo").addEventListener("click", () => editor.undo());
    byId("map-revert").addEventListener("click", () => editor.discard());
    byId("map-write").addEventListener("click", () => this.#save());
    addEventListener("keydown", (event) => this.#key(event), { capture: true });
  }

  /** The role and the name of what is added; null, and a notice, without a name that is needed. */
  naming(needed = true) {
    const field = byId("place-name");
    const name = field.value.trim();
    if (needed && !name) {
      field.focus();
      this.#notify("Type the name of the place first.");
      return null;
    }
    return { role: byId("place-role").value, name };
  }

  show() {
    const editor = this.#editor;
    if (!editor.active) return;
    for (const tool of TOOLS) set(byId(`map-tool-${tool}`), "aria-pressed", String(editor.tool === tool));
    byId("canvas").dataset.tool = editor.tool === "select" ? "move" : editor.tool;
    const names = ["place", "line", "area"].includes(editor.tool);
    byId("place-row").hidden = !names;
    byId("object-row").hidden = names;
    byId("place-role").hidden = editor.tool !== "place";
    this.#showObjects();
    const { steps } = editor.draft;
    for (const id of ["map-undo", "map-revert"]) byId(id).disabled = steps === 0;
    byId("map-write").disabled = editor.draft.map === null;
    put(byId("hint"), HINTS[editor.tool] + (editor.draft.map ? " Robots use the map once it is saved." : ""));
  }

  /** An edit was sent: the next place gets a name of its own. */
  placed(message) {
    if (["name_place", "forbid"].includes(message.type)) byId("place-name").value = "";
  }

  #pick(tool, { detail }) {
    this.#editor.setTool(tool);
    if (detail !== 0 || tool === "select") {
      if (tool === "place" && !byId("place-name").value) byId("place-name").focus();
      return;
    }
    this.#editor.makeInMiddle(tool); // Enter: there is no pointer to drag with
  }

  #showObjects() {
    const { map, selected, object } = this.#editor;
    const labels = (map?.objects ?? []).map(({ role, name }) => `${name || "without a name"} (${ROLES[role]})`);
    const select = byId("map-object");
    if (labels.join("\n") !== this.#list || select.options.length === 0) {
      this.#list = labels.join("\n");
      select.replaceChildren(new Option("Nothing selected", ""), ...labels.map((label, at) => new Option(label, at)));
    }
    const chosen = String(selected ?? "");
    if (select.value !== chosen) select.value = chosen;
    byId("object-remove").disabled = byId("object-name").disabled = !object;
    if (object === this.#shown) return;
    this.#shown = object;
    byId("object-name").value = object?.name ?? "";
  }

  #rename(field) {
    const name = field.value.trim();
    if (name) this.#editor.rename(name);
    else field.value = this.#editor.object?.name ?? "";
  }

  #save() {
    const field = byId("map-file");
    if (field.checkValidity()) this.#editor.save(field.value, byId("map-format").value);
    else (field.focus(), this.#notify(WRONG));
  }

  #key(event) {
    const editor = this.#editor;
    if (!editor.active) return;
    if (event.key === "z" && (event.ctrlKey || event.metaKey) && !isTyping(event)) editor.undo();
    else if (hasModifier(event) || isTyping(event)) return;
    else if (event.key === "Escape") (editor.cancel(), editor.setTool("select"));
    else if ((event.key === "Delete" || event.key === "Backspace") && editor.object) editor.remove();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}
