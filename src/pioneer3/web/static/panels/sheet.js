// The sheet beside the map, or on a phone under it: one view at a time.

const byId = (id) => document.getElementById(id);
const VIEWS = { robot: "Robot", plots: "Plots", modes: "Modes", robots: "All robots", help: "Help" };
const OF_ONE = ["robot", "plots", "modes"]; // what the arrow beside a phone's numbers opens

export class Sheet {
  #changed;
  #last = "robot";
  /** The view that is open, or null. */
  view = null;

  /** @param changed function(view or null), after another one is shown */
  constructor(changed) {
    this.#changed = changed;
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => {
        const { view } = button.dataset;
        this.open(view === this.view && !button.closest("#sheet") ? null : view);
      });
    }
    byId("details").addEventListener("click", () => this.open(this.view ? null : this.#last));
    byId("sheet-close").addEventListener("click", () => this.open(null));
    addEventListener("keydown", (event) => this.#key(event));
  }

  /** Shows a view; null closes the sheet, and gives the focus back to what opened it. */
  open(view) {
    if (view === this.view) return;
    const inside = byId("sheet").contains(document.activeElement);
    const closed = this.view;
    this.view = view;
    if (OF_ONE.includes(view)) this.#last = view;
    document.body.classList.toggle("sheet-open", view !== null);
    byId("sheet").hidden = view === null;
    byId("sheet-title").textContent = VIEWS[view] ?? "";
    byId("sheet").setAttribute("aria-label", VIEWS[view] ?? "");
    byId("sheet").classList.toggle("of-one", OF_ONE.includes(view));
    byId("details").setAttribute("aria-expanded", String(view !== null));
    for (const name of Object.keys(VIEWS)) byId(`view-${name}`).hidden = name !== view;
    for (const button of document.querySelectorAll("[data-view]")) {
      button.setAttribute("aria-pressed", String(button.dataset.view === view));
    }
    byId("sheet-body").scrollTop = 0;
    this.#changed(view);
    if (view === null && inside) this.#giveBack(closed);
  }

  #key(event) {
    if (event.key === "Escape" && this.view) this.open(null);
    else if (event.key === "?" && !event.target.closest?.("input, textarea, select")) this.open(this.view === "help" ? null : "help");
  }

  #giveBack(closed) {
    const openers = [document.querySelector(`.bar [data-view="${closed}"]`), byId("details")];
    openers.find((button) => button?.offsetParent)?.focus();
  }
}
