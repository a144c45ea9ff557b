"""The page goes on with the map of a robot, shows what has changed, and asks which map is kept."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from pioneer3.maps import LineMap
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.worldfile import RobotSpec, WorldFile
from tests.browser.drawn import colour, pixel, rest
from tests.browser.support import Product, hold, running_product, until, wait_for_the_robot
from tests.browser.tabs import DESKTOP, Tabs, no_complaints
from tests.browser.views import open_view
from tests.unit.nav.halls import HALL, ROUND
from tests.unit.nav.test_changes import SHELF
from tests.unit.navigation.test_map_update import Hall, names

LASER = EquipmentOptions(laser="utm-30lx")


@pytest.fixture
def hall(tmp_path: Path) -> Hall:
    """Return a map of a day on which there was a box."""
    return Hall(tmp_path / "hall.map")


@pytest.fixture
def product(hall: Hall) -> Iterator[Product]:
    """Run a robot in the hall on a day on which the box has gone, and there is a shelf."""
    walls = np.concatenate([HALL, SHELF])
    line_map = LineMap(name="hall", walls=walls, homes=(ROUND[0],), file=hall.path)
    world = WorldFile(name="hall", map=line_map, robots=(RobotSpec(equipment=LASER),))
    with running_product(world=world) as product:
        yield product


@pytest.fixture
def page(tabs: Tabs, product: Product) -> Iterator[Page]:
    """Open the page with its modes."""
    with tabs.open(size=DESKTOP) as page, no_complaints(page):
        page.goto(product.address)
        wait_for_the_robot(page)
        open_view(page, "modes")
        yield page


def update(page: Page, product: Product) -> None:
    """Go on with the map, and drive past the place of the box."""
    page.locator("#map-update").click()
    expect(page.locator("#map-finish")).to_be_visible()
    expect(page.locator("#changes-title")).to_contain_text("Nothing has gone or come on hall.map")
    body = product.simulation.body
    hold(page, "ArrowUp", lambda: bool(body.robot_in_world.x > ROUND[0].x + 4.0))
    page.keyboard.up("ArrowUp")
    expect(page.locator("#changes-list")).to_contain_text("gone: 0.")


def test_the_new_map_is_shown_with_its_changes_and_kept(
    page: Page, product: Product, hall: Hall
) -> None:
    update(page, product)
    expect(page.locator("#changes-save")).to_be_hidden()
    page.locator("#map-finish").click()
    expect(page.locator("#changes-title")).to_contain_text("Which map is to be kept?")
    assert hall.is_old(hall.path)
    page.locator("#sheet-close").click()
    page.locator("#fit").click()
    page.locator("#layers").click()
    expect(page.locator("#layer-changes")).to_be_checked()
    for layer in "sonar", "laser", "paths":  # which may lie above
        page.locator(f"#layer-{layer}").uncheck()
    page.locator("#legend-close").click()
    rest(page)
    front = [(x, 0.6) for x in (5.1, 5.2, 5.3, 5.4, 5.5)]
    gone = pytest.approx(colour(page, "--c-gone"), abs=30)
    until(lambda: any(pixel(page, *point) == gone for point in front))
    page.locator("#layers").click()
    page.locator("#layer-changes").uncheck()
    page.locator("#legend-close").click()
    until(lambda: not any(pixel(page, *point) == gone for point in front))
    page.locator("#changes-save").click()
    expect(page.locator("#toast")).to_contain_text("Saved hall.map; the map as it was before is")
    expect(page.locator("#changes-card")).to_be_hidden()
    assert hall.is_old(hall.path.with_stem("hall-before"))
    assert not hall.is_old(hall.path)


def test_the_old_map_is_kept(page: Page, product: Product, hall: Hall) -> None:
    update(page, product)
    page.locator("#map-finish").click()
    page.locator("#changes-discard").click()
    expect(page.locator("#toast")).to_contain_text("hall.map stays as it is.")
    expect(page.locator("#map-update")).to_be_visible()
    assert hall.is_old(hall.path)
    assert names(hall.path.parent) == {"hall"}


def test_a_map_without_a_survey_says_why_it_is_not_updated(page: Page, hall: Hall) -> None:
    expect(page.locator("#map-update")).to_be_visible()
    hall.path.with_suffix(".survey.npz").unlink()
    expect(page.locator("#map-no-update")).to_have_text(
        "The map in use is not updated: to go on with a map, hall.survey.npz has to lie beside it."
    )
    expect(page.locator("#map-update")).to_be_hidden()
