// What the server's diagnosis found, and the one thing that only this page can measure.

import { make } from "./dom.js";

const SIGNS = { ok: "✓", warn: "!", fail: "✕" };
const WORDS = { ok: "fine", warn: "warning", fail: "failure" };
const SLOW_TRIP = 120; // ms
const VERY_SLOW_TRIP = 300;

/** @param findings [{check, level, found, meaning, advice}] */
export function showFindings(list, findings) {
  const key = JSON.stringify(findings);
  if (list.dataset.key === key) return;
  list.dataset.key = key;
  list.replaceChildren(...findings.map(item));
}

/** Milliseconds from this page to the driver and back; null if not known. */
export function showRoundTrip(list, roundTrip) {
  if (roundTrip === null || roundTrip <= SLOW_TRIP) return showFindings(list, []);
  showFindings(list, [{
    check: "page",
    level: roundTrip > VERY_SLOW_TRIP ? "fail" : "warn",
    found: "this page reaches the driver slowly",
    meaning: "Keys and stops arrive late by as much.",
    advice: "Come nearer to the access point, or use a cable; keep the speed low.",
  }]);
}

function item({ check, level, found, meaning, advice }) {
  const sign = make("b", { class: "sign", "aria-hidden": "true" }, SIGNS[level]);
  const lines = [meaning, advice].filter(Boolean).map((line) => make("span", {}, line));
  const head = make("strong", {}, `${check}: `, make("span", { class: "sr-only" }, `${WORDS[level]}: `), found);
  return make("li", { "data-level": level }, sign, make("div", {}, head, ...lines));
}
