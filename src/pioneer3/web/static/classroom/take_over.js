// Taking over a robot: its own page opens in a new tab, and takes control there. The wish travels in the storage of
// the session, which the new tab gets a copy of: in the address any other site could state it.

const KEY = "pioneer3.take_over";

/** Opens the page of a robot to take control there; returns whether the browser allows it. */
export function openToTakeOver(id) {
  sessionStorage.setItem(KEY, String(id));
  const opened = window.open(`/?robot=${id}`, "_blank");
  sessionStorage.removeItem(KEY);
  return opened !== null;
}

/** Whether this page was opened to take over the robot; true once only. */
export function isToTakeOver(id) {
  if (sessionStorage.getItem(KEY) !== String(id)) return false;
  sessionStorage.removeItem(KEY);
  return true;
}
