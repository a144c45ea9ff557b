"""The view of the camera: it comes when it is opened, shows new pictures, and tells of trouble."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.worldfile import Box, RobotSpec, WorldFile
from tests.browser.support import Product, later, running_product, until, wait_for_the_robot
from tests.cameras import decoded as seen
from tests.cameras import require_opengl

SIZE = "(picture) => [picture.width, picture.height]"
ROBOT = RobotSpec(
    model="p3dx-sh", start=Pose2(0, 0, 0), equipment=EquipmentOptions(camera="vcc4", laser="none")
)


class TestWithACamera:
    """A robot before a box."""

    @pytest.fixture
    def product(self) -> Iterator[Product]:
        require_opengl()
        box = Box(pose=Pose2(1.5, 0.0, 0.0), size=(0.5, 0.5), movable=True)
        world = WorldFile(name="view", physics="mujoco", robots=(ROBOT,), boxes=(box,))
        with running_product(world=world) as product:
            yield product

    def test_it_is_loaded_and_asked_for_only_while_it_is_open(
        self, page: Page, product: Product
    ) -> None:
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.reload()
        wait_for_the_robot(page)
        camera = product.simulation.robots[0].camera
        assert camera is not None
        assert not [url for url in asked if "camera" in url]
        assert camera.taken == 0
        page.locator(".bar [data-view=camera]").click()
        expect(page.locator("#view-camera")).to_contain_text("pixels")
        assert page.locator(".camera-picture").evaluate(SIZE) == [320, 240]
        assert orange(page)
        page.locator("#sheet-close").click()
        until(lambda: not asked_more(page, asked))

    def test_a_box_that_goes_is_seen_no_more(self, page: Page, product: Product) -> None:
        page.locator(".bar [data-view=camera]").click()
        until(lambda: orange(page))
        (box,) = product.simulation.world.obstacles
        product.call(lambda: product.simulation.remove(box))
        until(lambda: not orange(page))

    def test_a_lost_camera_is_told_and_found_again(self, page: Page, product: Product) -> None:
        page.locator(".bar [data-view=camera]").click()
        expect(page.locator("#view-camera")).to_contain_text("pixels")
        page.route("**/camera/image", lambda route: route.fulfill(body="no picture"))
        expect(page.locator(".camera-picture.old")).to_be_visible()
        page.unroute("**/camera/image")
        expect(page.locator("#view-camera")).to_contain_text("pixels")


def test_without_a_camera_there_is_no_such_view(page: Page, product: Product) -> None:
    wait_for_the_robot(page)
    assert page.locator("[data-view=camera]:visible").count() == 0


def orange(page: Page) -> bool:
    """Whether the box is in the middle of the picture."""
    if page.locator(".camera-picture:visible").count() == 0:
        return False
    pixels = seen(page.locator(".camera-picture").screenshot())
    red, green, blue = pixels[pixels.shape[0] // 2, pixels.shape[1] // 2].tolist()
    return bool(red > green + 40 > blue + 60)


def asked_more(page: Page, asked: list[str]) -> bool:
    """Whether pictures are still asked for."""
    before = len(asked)
    later(page)
    return len(asked) > before
