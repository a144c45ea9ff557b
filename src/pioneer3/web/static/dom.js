// Elements, texts, numbers and keys: small functions that all modules of the page share.

const SVG = "http://www.w3.org/2000/svg";
const NEGATIVE_ZERO = /^-(?=0(\.0*)?$)/; // "-0.00"

/** Whether the page has the layout of phones: the same condition as in the style sheets. */
export const PHONE = matchMedia("(max-width: 760px), (max-height: 520px)");

export const byId = (id) => document.getElementById(id);

/** Makes an element; children are elements or texts. */
export function make(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** Makes an element of a drawing. */
export function makeSvg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** Makes a button that calls `act`. */
export function makeButton(text, attributes, act) {
  const button = make("button", { type: "button", ...attributes }, text);
  button.addEventListener("click", act);
  return button;
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Shows a text, if it has changed. */
export function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Shows a text of the server, if it has changed; what is `quoted` in it is code. */
export function putProse(element, text) {
  if (element.textContent === text.replaceAll("`", "")) return;
  element.replaceChildren(...text.split("`").map((part, at) => (at % 2 ? make("code", {}, part) : part)));
}

/** Sets an attribute, if it has changed; null removes it. */
export function set(element, name, value) {
  if (value === null) element.removeAttribute(name);
  else if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** Shows texts as the items of a list, if they have changed. */
export function putLines(list, lines, item = (line) => make("li", {}, line)) {
  putItems(list, lines.join("\n"), () => lines.map(item));
}

/** Replaces the items of a list where `key`, which stands for all of them, has changed. */
export function putItems(list, key, items) {
  if ((list.dataset.key ?? "") === key) return;
  list.dataset.key = key;
  list.replaceChildren(...items());
}

/** Returns a link to the page of the book about a symptom, where the book is served; else nothing. */
export function helpLinks(symptom) {
  const book = document.querySelector('link[rel="help"]');
  if (!book || !symptom) return [];
  return [make("a", { class: "help-link", href: `${book.href}troubleshooting/${symptom}/`, target: "_blank" }, "How to mend it")];
}

/** Shows a text with the link to the page about its symptom, if they have changed. */
export function putHelp(element, text, symptom) {
  putItems(element, `${text}\n${symptom ?? ""}`, () => [text, ...helpLinks(symptom).flatMap((link) => [" ", link])]);
}

/** A number with a real minus sign, and never "-0.00"; a dash if it is not known. */
export function number(value, digits) {
  if (!Number.isFinite(value)) return "–";
  return value.toFixed(digits).replace(NEGATIVE_ZERO, "").replace("-", "−");
}

/** A text of the server as a sentence. */
export const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;

export const degrees = (radians) => (radians * 180) / Math.PI;

/** Whether keys go into a field now. */
export function isTyping({ target }) {
  return target instanceof Element && target.matches("input, textarea, select, [contenteditable]");
}

/** Whether a key is part of a shortcut of the browser. */
export const hasModifier = ({ ctrlKey, altKey, metaKey }) => ctrlKey || altKey || metaKey;

/** Returns what this device remembers under a name, or null. */
export function recall(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null; // storage may be forbidden
  }
}

/** Remembers a text on this device, where that is allowed. */
export function remember(name, text) {
  try {
    localStorage.setItem(name, text);
  } catch {
    // it is lost when the page is closed
  }
}
