"""The views beside the map, and how long the robot goes on."""

from collections.abc import Callable

from playwright.sync_api import Page

from tests.browser.support import Product, hold, speed, until

VIEWS = ("robot", "plots", "modes")


def open_view(page: Page, view: str) -> None:
    """Open a view: by the top bar, or on a phone by the sheet's own buttons."""
    if not page.locator(".views").is_visible():
        if page.locator("#sheet").is_hidden():
            page.locator("#details").click()
        button = page.locator(f".sheet-views [data-view={view}]")
    else:
        button = page.locator(f".views [data-view={view}]")
    if button.get_attribute("aria-pressed") != "true":
        button.click()
    page.locator(f"#view-{view}").wait_for(state="visible")


def drive(page: Page, product: Product) -> None:
    """Hold the arrow until the robot drives."""
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)


def stopped_after(product: Product, act: Callable[[], object]) -> float:
    """Return how long the robot still moves once `act` begins, in simulated time [s]."""
    began = product.simulation.world.time
    act()
    until(lambda: speed(product) == 0.0)
    return product.simulation.world.time - began
