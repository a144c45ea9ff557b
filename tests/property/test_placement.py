"""Whatever is asked for: robots never begin in each other, and only given poses stand in walls."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.collision import overlap
from pioneer3.sim.free_space import Obstructions
from pioneer3.sim.placer import PlacementRequest, place_all
from pioneer3.sim.worldfile import Box, Place, Start, Wall, WorldFile
from tests.combinations import examples

MODELS = [load_model(name) for name in ("p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh")]
coordinates = st.floats(-1.0, 9.0)
poses = st.builds(Pose2, coordinates, coordinates, st.floats(-3.0, 3.0))
boxes = st.builds(
    Box, pose=poses, size=st.tuples(st.floats(0.1, 3.0), st.floats(0.1, 3.0)), movable=st.booleans()
)
starts: st.SearchStrategy[Start] = st.one_of(
    st.just("home"), st.just("random"), st.just("outside"), poses
)
requests = st.builds(PlacementRequest, st.just("r"), st.sampled_from(MODELS), starts)


@settings(max_examples=examples(150))
@given(
    st.booleans(),
    st.lists(boxes, max_size=4),
    st.lists(poses, max_size=2),
    st.lists(requests, min_size=1, max_size=7),
    st.integers(0, 9),
)
def test_everybody_gets_a_place_of_their_own(
    walled: bool, boxes: list[Box], homes: list[Pose2], robots: list[PlacementRequest], seed: int
) -> None:
    wall = Wall(points=((0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)), closed=True)
    world = WorldFile(
        name="w",
        walls=(wall,) if walled else (),
        boxes=tuple(boxes),
        places=tuple(Place(kind="RobotHome", pose=home) for home in homes),
    )
    line_map = world.line_map()
    obstacles = [box.outline for box in world.movable]
    try:
        found = place_all(line_map, robots, np.random.default_rng(seed), obstacles)
    except ConfigError:
        return  # too crowded
    assert found == place_all(line_map, robots, np.random.default_rng(seed), obstacles)
    ground = Obstructions.of(line_map, obstacles)
    for index, (robot, pose) in enumerate(zip(robots, found, strict=True)):
        for other, there in zip(robots[:index], found, strict=False):
            assert not overlap(robot.model, pose, other.model, there)
        if isinstance(robot.start, str) and len(robots) > 1:
            assert pose in line_map.homes or not ground.blocks(robot.model, pose)
