// What a student types to get pioneer3 and the programs of the lessons from the class.

import { make, makeButton } from "../dom.js";
import { ask } from "../http.js";
import { copy } from "./invitation.js";

const ON_WINDOWS = /Windows/.test(navigator.userAgent);
const PROGRAMS = ON_WINDOWS ? "p3\\Scripts\\" : ""; // without activation, which PowerShell may forbid
const ENVIRONMENT = ON_WINDOWS ? "py -m venv p3" : "python3 -m venv p3 && source p3/bin/activate";
const FIRST = `${PROGRAMS}python square.py`;

/** What the class hands out: {command, offline, programs, book}; null if it hands out nothing. */
export async function askForInstallation() {
  try {
    return await ask("GET", "class/installation");
  } catch {
    return null; // the rest of the page does without
  }
}

/**
 * The lines to type, one after the other, each with a button that copies it.
 * @param told       from askForInstallation
 * @param hasRobot   whether this browser has a robot, whose address programs get
 * @param notify     function(text)
 */
export function installationSteps(told, hasRobot, notify) {
  const load = hasRobot
    ? make("p", {}, "Load programs of the lessons, with your robot's address in them: ", ...links(told))
    : make("p", {}, "Join, and load a program under “Program” of your robot's page.");
  return make("ol", { class: "steps" },
    step("In a terminal, make an environment:", ENVIRONMENT, notify),
    step(told.offline ? "Install pioneer3, from here alone:" : "Install pioneer3:", `${PROGRAMS}${told.command}`, notify),
    make("li", {}, load),
    step("Type, in the folder where it was saved:", FIRST, notify));
}

export function bookLink(told) {
  return told.book ? [make("p", {}, make("a", { href: "/book/", target: "_blank" }, "The book: tutorial, how-to, reference"))] : [];
}

function links(told) {
  const each = told.programs.map((name) => make("a", { href: `/programs/${name}`, download: name }, name));
  return each.flatMap((link, at) => (at ? [", ", link] : [link]));
}

function step(words, line, notify) {
  const button = makeButton("Copy", { class: "choice", "aria-label": `Copy: ${line}` }, () => copy(line, notify));
  return make("li", {}, make("p", {}, words), make("div", { class: "typed" }, make("code", {}, line), button));
}
