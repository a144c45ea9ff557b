// Trades the one-time token behind the `#` of the address for a session. The token goes to the
// server in the body of a POST and nowhere else; it leaves the address bar and the history at once.

import { byId } from "../dom.js";
import { ask } from "../http.js";

const HELP = "Ask for an invitation: whoever started the robot runs “pioneer3 access invite”, or presses Invite on the page.";

const [token, role] = location.hash.slice(1).split(".");
const viewer = role === "viewer";
history.replaceState(null, "", location.pathname);

function say(text, bad = false) {
  byId("lead").textContent = text;
  byId("lead").classList.toggle("bad", bad);
}

async function pair(role) {
  for (const button of document.querySelectorAll("button")) button.disabled = true;
  try {
    await ask("POST", "pair", { token, name: byId("name").value, role });
    location.replace("/");
  } catch (error) {
    byId("form").hidden = true;
    say(`${error.message[0].toUpperCase()}${error.message.slice(1)}.`, true);
  }
}

async function begin() {
  byId("trust").hidden = location.protocol === "https:";
  if (token) {
    byId("form").hidden = false;
    byId("drive").hidden = viewer;
    byId("watch").textContent = viewer ? "Watch" : "Only watch";
    return say(viewer ? "You are invited to watch this robot, and to stop it." : "You are invited to drive this robot.");
  }
  try {
    await ask("GET", "me");
    location.replace("/"); // already in
  } catch {
    say(`This device is not paired, or no longer. ${HELP}`);
  }
}

byId("form").addEventListener("submit", (event) => {
  event.preventDefault();
  pair(event.submitter?.value === "viewer" ? "viewer" : null);
});
addEventListener("hashchange", () => location.reload()); // another invitation in the same tab
begin();
