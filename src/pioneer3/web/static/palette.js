// The canvas colours, taken from theme.css so that both themes live in one place.

const NAMES = [
  "floor", "grid", "grid-major", "wall", "wall-soft", "trail", "path", "body", "deck", "edge",
  "wheel", "nose", "sonar-near", "sonar-mid", "sonar-far", "sonar-none", "bumper", "hit", "ink",
  "box", "box-edge", "person", "person-soft", "person-head", "other", "other-deck", "other-edge", "other-nose", "select", "label",
  "cell", "free", "goal", "dock", "home", "forbidden", "zone", "laser", "target",
];

/** Colours by name; `mate` has those of a robot that is not selected, `stranger` of one that is not the page's. */
export function readPalette() {
  const style = getComputedStyle(document.documentElement);
  const palette = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--c-${name}`).trim()]));
  palette.mate = { ...palette, nose: palette["other-nose"] };
  palette.stranger = {
    ...palette.mate, body: palette.other, deck: palette["other-deck"], edge: palette["other-edge"],
  };
  return palette;
}

/** Between two #rrggbb colours, k from 0 to 1. */
export function mix(a, b, k) {
  const channel = (at) => {
    const [from, to] = [a, b].map((colour) => parseInt(colour.slice(at, at + 2), 16));
    return Math.round(from + (to - from) * Math.min(1, Math.max(0, k)));
  };
  return `rgb(${channel(1)} ${channel(3)} ${channel(5)})`;
}
