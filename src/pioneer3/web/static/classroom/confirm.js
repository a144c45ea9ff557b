// Asks before something that cannot be undone. Enter on the marked button, which is the harmless one, changes nothing.

import { byId, put } from "../dom.js";

/** Asks a question in the dialog of the page; returns whether the answer was yes. */
export function confirmed(question, more, yes) {
  const dialog = byId("question");
  put(byId("question-title"), question);
  put(byId("question-more"), more);
  put(byId("question-yes"), yes);
  dialog.returnValue = "no"; // Escape
  dialog.showModal();
  byId("question-no").focus();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "yes"), { once: true });
  });
}
