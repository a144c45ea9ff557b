"""Bodies of robots over the API: what the 3-D view draws is what their URDF says."""

from xml.etree import ElementTree as ET

import pytest

from pioneer3.models import load_model, model_names
from pioneer3.models.description.tree import Frames, tree_of
from pioneer3.models.description.urdf import describe
from tests.unit.web.asking import Script, stranger
from tests.unit.web.browser import product


@pytest.mark.parametrize("name", model_names())
async def test_a_body_has_the_solids_of_the_urdf(name: str) -> None:
    async with product() as the:
        body = (await Script(the.app).ask("GET", f"/api/models/{name}")).json
    model, frames = load_model(name), Frames()
    urdf = ET.fromstring(describe(model, tree_of(model, frames), frames))
    solids = [solid for link in body["links"] for solid in link["solids"]]
    assert len(solids) == len(urdf.findall(".//visual"))
    assert sum(one["shape"] == "cylinder" for one in solids) == len(
        urdf.findall(".//visual//cylinder")
    )
    sides = [link["wheel"] for link in body["links"] if link["wheel"]]
    assert len(sides) == len(urdf.findall(".//joint[@type='continuous']"))
    assert sides.count("left") == sides.count("right")


async def test_a_link_on_a_link_is_placed_on_the_base() -> None:
    async with product() as the:
        body = (await Script(the.app).ask("GET", "/api/models/p3at-sh")).json
    model, frames = load_model("p3at-sh"), Frames()
    joints = {joint.child: joint for joint in tree_of(model, frames).joints}
    laser, top = joints[frames.laser], joints["top_plate"]
    assert [laser.x, laser.y, top.z + laser.z] in [link["at"] for link in body["links"]]


async def test_an_unknown_model_is_refused_and_a_stranger_gets_none() -> None:
    async with product() as the:
        answer = await Script(the.app).ask("GET", "/api/models/p4at")
        assert answer.status == 404
        assert "pioneer3 model list" in answer.detail
        assert (await stranger(the.app).ask("GET", "/api/models/p3at-sh")).status == 401
