// Elements and numbers for the panels.

const NO_SIGN = /^-(?=0(\.0*)?$)/; // "-0.00"

/** Makes an element; children are elements or texts. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** Shows a text, if it is a new one. */
export function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Sets an attribute, if it is new; null takes it away. */
export function set(element, name, value) {
  if (value === null) element.removeAttribute(name);
  else if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** With a real minus sign, and never "-0.00"; a dash for what is not known. */
export function number(value, digits) {
  if (!Number.isFinite(value)) return "–";
  return value.toFixed(digits).replace(NO_SIGN, "").replace("-", "−");
}

export const degrees = (radians) => (radians * 180) / Math.PI;
