// Colours of drawings, from theme.css.

const NAMES = [
  "floor", "grid", "grid-major", "wall", "wall-soft", "trail", "path", "body", "deck", "edge",
  "arrow", "wheel", "nose", "sonar-near", "sonar-mid", "sonar-far", "sonar-none", "bumper", "hit", "ink",
  "box", "box-edge", "person", "person-soft", "person-head", "mate", "mate-deck", "mate-edge", "other", "other-deck", "other-edge", "select", "label",
  "cell", "free", "goal", "dock", "home", "forbidden", "zone", "laser", "target", "gone", "come",
];

/** Colours by name; `unselected` has those of a robot that is not selected, `external` of one that is not this page's. */
export function readPalette() {
  const style = getComputedStyle(document.documentElement);
  const palette = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--c-${name}`).trim()]));
  const painted = (kind) => ({ ...palette, body: palette[kind], deck: palette[`${kind}-deck`], edge: palette[`${kind}-edge`], nose: palette[`${kind}-deck`] });
  [palette.unselected, palette.external] = [painted("mate"), painted("other")];
  return palette;
}

/** Calls `changed` when the system asks for other colours. */
export function watchPalette(changed) {
  for (const query of ["(prefers-color-scheme: light)", "(prefers-contrast: more)"]) {
    matchMedia(query).addEventListener("change", changed);
  }
}
