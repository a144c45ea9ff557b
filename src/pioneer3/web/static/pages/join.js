// Trades the class's token behind the `#` of the address, or typed as its code, and a name, for a robot. The token
// goes to the server in the body of a POST and nowhere else; it leaves the address bar and the history at once.

import { byId, put } from "../dom.js";
import { ask } from "../http.js";
import { askForInstallation, bookLink, installationSteps } from "../classroom/installation.js";

const HELP = "Scan the class's code, or type it once more. Your teacher can show it.";
const BAD_LINK = [401, 403, 404]; // of the answer, to a token that is not good any more

let token = location.hash.slice(1);
history.replaceState(null, "", location.pathname);

function say(text, bad = false) {
  byId("lead").textContent = text;
  byId("lead").classList.toggle("bad", bad);
}

const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`;

async function join() {
  const name = byId("name").value.trim();
  if (!name) return say("Write your name first.", true);
  if (!byId("ask-code").hidden) token = byId("code").value.toLowerCase().replace(/[^a-z]/g, ""); // written in groups, or in capitals
  byId("join").disabled = true;
  try {
    await ask("POST", "class/join", { token, name });
    location.replace("/");
  } catch (error) {
    byId("join").disabled = false;
    const useless = BAD_LINK.includes(error.status);
    if (useless) askForCode();
    say(`${sentence(error.message)}${useless ? ` ${HELP}` : ""}`, true);
  }
}

function askForCode() {
  byId("ask-code").hidden = false;
  byId("code").required = true;
  byId("code").select();
}

/** Whether this browser has a robot already. */
async function hasRobot() {
  try {
    return (await ask("GET", "me")).role === "student";
  } catch {
    return false;
  }
}

/** Shows what to type for a program of one's own; open where there is room for it. */
async function showInstallation() {
  const told = await askForInstallation();
  if (!told) return;
  byId("install-steps").append(installationSteps(told, false, (text) => put(byId("copied"), text)), ...bookLink(told));
  byId("install").open = matchMedia("(min-width: 900px)").matches;
  byId("install").hidden = false;
}

async function begin() {
  if (await hasRobot()) return location.replace("/");
  byId("form").hidden = false;
  showInstallation();
  say("A robot of your own, to drive and to program.");
  if (token) byId("name").focus();
  else askForCode();
}

byId("form").addEventListener("submit", (event) => {
  event.preventDefault();
  join();
});
addEventListener("hashchange", () => location.reload()); // another link in the same tab
begin();
