"""What is on the canvas of the page."""

from typing import Any

from playwright.sync_api import Page

from tests.browser.support import until

READ = """
const canvas = document.getElementById("canvas");
const copy = document.createElement("canvas");  // the console warns of reading the canvas itself
Object.assign(copy, { width: canvas.width, height: canvas.height });
const context = copy.getContext("2d", { willReadFrequently: true });
context.drawImage(canvas, 0, 0);
const read = (x, y, width, height) => context.getImageData(x, y, width, height).data;
const all = () => read(0, 0, canvas.width, canvas.height);
"""
PIXEL = f"""([x, y]) => {{
  {READ}
  const at = window.pioneer3.toScreen(x, y);
  const ratio = window.pioneer3.state.ratio;
  return [...read(at.x * ratio, at.y * ratio, 1, 1)].slice(0, 3);
}}"""
PRINT = f"""() => {{
  {READ}
  const pixels = new Uint32Array(all().buffer);
  return pixels.reduce((hash, pixel) => (Math.imul(hash, 31) + pixel) | 0, 0);
}}"""
KEEP = f"""() => {{
  {READ}
  window.kept = all();
}}"""
DIFFERING = f"""() => {{
  {READ}
  const [data, kept] = [all(), window.kept];
  let count = 0;
  for (let at = 0; at < data.length; at += 4) {{
    count += [0, 1, 2].some((part) => Math.abs(data[at + part] - kept[at + part]) > 16);
  }}
  return count;
}}"""
COLOUR = """(name) => {
  const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}"""


SAME = """([read, times]) => new Promise((done) => {
  let [before, same] = [null, 0];
  const look = () => {
    const now = JSON.stringify(window.pioneer3.state[read]);
    same = now === before ? same + 1 : 0;
    before = now;
    if (same === times) done();
    else requestAnimationFrame(look);
  };
  look();
})"""


def state(page: Page, name: str) -> Any:
    """Return what the page exposes for tests."""
    return page.evaluate(f"window.pioneer3.state.{name}")


def settle(page: Page) -> None:
    """Wait until all is drawn, and sharp: the page has skipped some frames."""
    page.evaluate(SAME, ["frames", 4])


def rest(page: Page) -> None:
    """Wait until there is a map, and the camera stands still."""
    until(lambda: bool(state(page, "places")))
    still(page)


def still(page: Page) -> None:
    """Wait until all robots are on the map, and the camera stands still."""
    until(lambda: all(robot["snapshot"] for robot in state(page, "robots")))
    page.evaluate(SAME, ["camera", 8])


def repaint(page: Page) -> None:
    """Wait until the browser has drawn what has changed."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")


def pixel(page: Page, x: float, y: float) -> list[int]:
    """Return red, green and blue at a point of the map."""
    colour: list[int] = page.evaluate(PIXEL, [x, y])
    return colour


def colour(page: Page, name: str) -> list[int]:
    """Return red, green and blue of a colour of the theme."""
    found: list[int] = page.evaluate(COLOUR, name)
    return found


def fingerprint(page: Page) -> int:
    """Return a number that any other picture does not have."""
    settle(page)
    number: int = page.evaluate(PRINT)
    return number


def keep(page: Page) -> None:
    """Keep the picture to compare others with."""
    settle(page)
    page.evaluate(KEEP)


def differing(page: Page) -> int:
    """Return how many pixels are clearly others than in the picture that was kept."""
    settle(page)
    count: int = page.evaluate(DIFFERING)
    return count
