"""A laser that was asked for, in a real browser: its layer is shown by itself."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.worldfile import RobotSpec, WorldFile
from tests.browser.drawn import state
from tests.browser.support import Product, later, running_product, until, wait_for_the_robot

WITH_LASER = WorldFile(
    name="with-laser",
    map="office",
    robots=(
        RobotSpec(
            model="p3at-sh",
            name="robot",
            start=Pose2(2.0, 2.0),
            port=0,
            equipment=EquipmentOptions(laser="tim551", laser_port=0),
        ),
    ),
)


@pytest.fixture
def product() -> Iterator[Product]:
    """Run a robot with a laser, which is connected."""
    with running_product(world=WITH_LASER) as product:
        yield product


def test_its_layer_is_shown_and_its_scans_are_drawn(page: Page, product: Product) -> None:
    until(lambda: state(page, "scans")[0] > 100)
    assert state(page, "layers")["laser"] is True
    page.keyboard.press("l")
    expect(page.locator("#layer-laser")).to_be_checked()
    laser = product.simulation.robots[0].laser
    assert laser is not None
    product.call(laser.unplug)
    until(lambda: product.robot.laser.lost is not None)
    product.call(laser.plug_in)
    until(lambda: product.robot.laser.lost is None)
    until(lambda: state(page, "scans")[0] > 100)


def test_who_has_switched_it_off_is_not_shown_it_again(page: Page, product: Product) -> None:
    until(lambda: state(page, "scans")[0] > 100)
    page.keyboard.press("l")
    page.locator("#layer-laser").uncheck()
    until(lambda: state(page, "scans")[0] == 0)
    page.reload()
    wait_for_the_robot(page)
    later(page)
    assert state(page, "layers")["laser"] is False
    assert state(page, "scans")[0] == 0
