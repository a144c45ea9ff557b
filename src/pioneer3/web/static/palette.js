// The canvas colours, taken from theme.css so that both themes live in one place.

const NAMES = [
  "floor", "grid", "grid-major", "wall", "wall-soft", "trail", "path", "body", "deck", "edge",
  "arrow", "wheel", "nose", "sonar-near", "sonar-mid", "sonar-far", "sonar-none", "bumper", "hit", "ink",
  "box", "box-edge", "person", "person-soft", "person-head", "mate", "mate-deck", "mate-edge", "other", "other-deck", "other-edge", "select", "label",
  "cell", "free", "goal", "dock", "home", "forbidden", "zone", "laser", "target",
];

/** Colours by name; `mates` has those of a robot that is not selected, `stranger` of one that is not the page's. */
export function readPalette() {
  const style = getComputedStyle(document.documentElement);
  const palette = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--c-${name}`).trim()]));
  const painted = (kind) => ({ ...palette, body: palette[kind], deck: palette[`${kind}-deck`], edge: palette[`${kind}-edge`], nose: palette[`${kind}-deck`] });
  [palette.mates, palette.stranger] = [painted("mate"), painted("other")];
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
