"""Editing the map on the page, with mouse, finger and keys, and driving on it afterwards."""

from collections.abc import Iterator
from math import pi
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from pioneer3.maps import read_map
from tests.browser.drawn import rest, state
from tests.browser.support import Product, later, until
from tests.browser.tabs import Tabs
from tests.browser.test_edit import SIZES, drag, drag_by_finger, opened, spot


@pytest.fixture
def folder(product: Product, tmp_path: Path) -> Path:
    """Return the folder in which the page saves maps."""
    product.web.map_editor.folder = tmp_path
    return tmp_path


@pytest.fixture
def editor(page: Page, folder: Path) -> Iterator[Page]:
    """Return the page at desktop size with the map in edit mode, all of it in view."""
    until(lambda: page.locator("#edit").is_visible())
    page.locator("#edit").click()
    page.locator("#edit-map").click()
    page.locator("#fit").click()
    rest(page)
    yield page
    assert folder.is_dir()


def steps(page: Page) -> int:
    number: int = state(page, "draft.steps")
    return number


def names(page: Page) -> list[str]:
    return [place["name"] for place in state(page, "places")]


def test_walls_are_drawn_and_erased_and_undone(editor: Page, product: Product) -> None:
    before = len(product.simulation.world.map.walls)
    editor.locator("#map-tool-wall").click()
    drag(editor, (3.5, 2.6), (4.5, 2.6))
    until(lambda: steps(editor) == 1)
    wall = state(editor, "draft.map.walls")[-1]
    assert wall == pytest.approx([3.5, 2.6, 4.5, 2.6], abs=0.06)
    editor.locator("#map-tool-erase").click()
    drag(editor, (3.3, 2.4), (4.7, 2.8))
    until(lambda: steps(editor) == 2)
    assert len(state(editor, "draft.map.walls")) == before
    editor.locator("#map-undo").click()
    until(lambda: steps(editor) == 1)
    assert len(state(editor, "draft.map.walls")) == before + 1
    editor.locator("#map-revert").click()
    until(lambda: steps(editor) == 0)
    assert len(product.simulation.world.map.walls) == before
    expect(editor.locator("#map-write")).to_be_disabled()


def test_a_box_without_walls_is_refused_in_words(editor: Page) -> None:
    editor.locator("#map-tool-erase").click()
    drag(editor, (3.9, 2.9), (4.1, 3.1))
    expect(editor.locator("#toast")).to_contain_text("no wall is inside of")
    assert steps(editor) == 0


def test_the_robot_drives_to_a_place_of_the_saved_map(
    editor: Page, product: Product, folder: Path
) -> None:
    editor.locator("#map-tool-place").click()
    editor.mouse.click(*spot(editor, 4.0, 3.2))
    expect(editor.locator("#toast")).to_contain_text("name of the place")
    assert steps(editor) == 0
    editor.locator("#place-name").fill("Desk")
    drag(editor, (4.0, 3.2), (4.0, 4.2))
    until(lambda: steps(editor) == 1)
    expect(editor.locator("#place-name")).to_have_value("")
    editor.locator("#map-file").fill("mine")
    editor.locator("#map-write").click()
    expect(editor.locator("#toast")).to_contain_text("Saved mine.map")
    desk = next(i for i in read_map(folder / "mine.map").objects if i.name == "Desk")
    assert desk.kind == "GoalWithHeading"
    assert desk.pose.theta == pytest.approx(pi / 2, abs=0.02)
    editor.locator("#edit").click()
    editor.keyboard.press("g")
    editor.locator("#goto-place").select_option(label="Desk")
    until(lambda: state(editor, "proposal.name") == "Desk")
    editor.locator("#goto-go").click()
    until(lambda: state(editor, "snapshot.mode") == "goto")
    until(lambda: state(editor, "snapshot.mode") is None, 60.0)
    here = product.simulation.body.robot_in_world
    assert (here.x, here.y) == pytest.approx((4.0, 3.2), abs=0.25)


def test_places_are_renamed_and_deleted(editor: Page) -> None:
    editor.mouse.click(*spot(editor, 7.0, 5.1))
    expect(editor.locator("#object-name")).to_have_value("Lab")
    editor.locator("#object-name").fill("Studio")
    editor.keyboard.press("Enter")
    until(lambda: "Studio" in names(editor))
    assert "Lab" not in names(editor)
    editor.locator("#map-object").select_option(label="Studio (Goal)")
    editor.locator("#object-remove").click()
    until(lambda: "Studio" not in names(editor))
    assert steps(editor) == 2


def test_lines_and_areas_are_forbidden(editor: Page) -> None:
    editor.locator("#map-tool-line").click()
    drag(editor, (3.0, 2.6), (4.0, 2.6))
    until(lambda: steps(editor) == 1)
    editor.locator("#map-tool-area").click()
    editor.locator("#place-name").fill("wet floor")
    drag(editor, (4.5, 2.6), (5.0, 3.4))
    until(lambda: steps(editor) == 2)
    line, area = state(editor, "draft.map.objects")[-2:]
    assert (line["kind"], area["kind"]) == ("ForbiddenLine", "ForbiddenArea")
    assert (line["name"], area["name"]) == ("", "wet floor")
    editor.mouse.click(*spot(editor, 6.0, 2.9))


def test_others_see_the_map_that_robots_use(tabs: Tabs, editor: Page, product: Product) -> None:
    with tabs.open(product.address) as other:
        until(lambda: len(state(other, "places")) > 0)
        assert_a_draft_is_not_used(editor, other)


def assert_a_draft_is_not_used(editor: Page, other: Page) -> None:
    """Put a place on the map, which the other page shows once it edits the map, too."""
    editor.locator("#map-tool-place").click()
    editor.locator("#place-name").fill("Desk")
    editor.mouse.click(*spot(editor, 4.0, 3.2))
    until(lambda: "Desk" in names(editor))
    later(other, 3)
    assert "Desk" not in names(other)
    other.locator("#edit").click()
    other.locator("#edit-map").click()
    until(lambda: "Desk" in names(other))  # one draft for all


def test_keys_alone_edit_the_map(editor: Page) -> None:
    editor.locator("#map-tool-place").focus()
    editor.keyboard.press("Enter")
    expect(editor.locator("#place-name")).to_be_focused()
    editor.keyboard.type("Desk")
    editor.locator("#map-tool-place").focus()
    editor.keyboard.press("Enter")
    until(lambda: "Desk" in names(editor))
    editor.locator("#map-undo").focus()
    editor.keyboard.press("Enter")
    until(lambda: "Desk" not in names(editor))


@pytest.mark.parametrize("size", ["phone", "phone on its side"])
def test_a_finger_edits_the_map(tabs: Tabs, product: Product, folder: Path, size: str) -> None:
    with opened(tabs, product, size) as page:
        page.locator("#edit-map").tap()
        page.locator("#fit").tap()
        rest(page)
        page.locator("#map-tool-wall").tap()
        drag_by_finger(page, (3.5, 2.6), (4.5, 2.6))
        until(lambda: steps(page) == 1)
        for button in page.locator("#editor :is(button, select, input):visible").all():
            box = button.bounding_box()
            assert box is not None
            assert box["height"] >= 40, button
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= SIZES[size][0]
        page.locator("#map-write").tap()
        until((folder / "lab.map").exists)
        until(lambda: state(page, "draft.map") is None)
