"""Whatever a map_server, picture or world file holds: a map, or one line that says why not."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, read_map, write_aria_map
from pioneer3.maps.grid import outline, raster_outline
from pioneer3.maps.image import to_png
from pioneer3.models import load_model
from pioneer3.sim.map_check import check_world
from pioneer3.sim.relief import Carpet, Cylinder, Ramp, Step, Table
from pioneer3.sim.worldfile import (
    Box,
    Person,
    RobotSpec,
    Wall,
    WorldFile,
    load_map,
    parse_world,
    to_toml,
)

MODEL = load_model("p3at-sh")
YAML = b"image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0.3]\n"
PICTURE = to_png(np.arange(108, dtype=np.uint8).reshape(6, 6, 3))
WORDS = st.one_of(
    st.text(max_size=8),
    st.floats().map(str),
    st.sampled_from(["[", "]", "{", "}", "=", ":", "'", '"', "#", "\n", "- ", " ", "\\", "0x1"]),
)
YAML_KEYS = st.sampled_from(
    ["image: m.pgm", "resolution: ", "origin: [", "origin:\n- ", "negate: ", "mode: ", "k: ", ""]
)
TOML_KEYS = st.sampled_from(
    [
        "[world]\n",
        "map=",
        "seed=",
        "[[box]]\n",
        "center=[1,2]\n",
        "size=[",
        "[[person]]\n",
        "path=[[0,0],",
        "[[robot]]\n\n    ",
        "start=",
        "port=",
        "[[wall]]\n",
        "[[ramp]]\n",
        "[[table]]\n",
        "[[mesh]]\n",
        "file=",
        "height=",
        "points=[[",
        "x=",
        "loop=",
    ]
)


def lines_of(keys: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    row = st.builds(lambda key, words: key + "".join(words), keys, st.lists(WORDS, max_size=5))
    return st.lists(row, max_size=8).map("\n".join)


def holds(name: str, content: bytes, image: bytes = b"P5 1 1 255\n\0") -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        (Path(folder) / "m.pgm").write_bytes(image)
        path.write_bytes(content)
        message, walls = "fine", np.empty(0)
        try:
            walls = load_map(path).walls
        except ConfigError as error:
            message = str(error)
        check_world(path, MODEL)
    assert message.isprintable()
    assert np.isfinite(walls).all()


@given(lines_of(YAML_KEYS))
def test_any_yaml(text: str) -> None:
    holds("m.yaml", text.encode("utf-8", "surrogatepass"))
    holds("m.yaml", YAML + text.encode("utf-8", "surrogatepass"))


@given(lines_of(TOML_KEYS))
def test_any_world(text: str) -> None:
    holds("m.toml", b"[world]\n" + text.encode("utf-8", "surrogatepass"))


@given(st.binary(max_size=300))
def test_any_bytes(content: bytes) -> None:
    for name in ("m.yaml", "m.toml", "m", "m.png"):
        holds(name, content)


@given(st.binary(max_size=80), st.sampled_from([b"", b"P2 ", b"P5 2 2 ", b"P2 2 2 9 "]))
def test_any_pgm(content: bytes, start: bytes) -> None:
    holds("m.yaml", YAML, start + content)


@given(st.integers(8, len(PICTURE) - 1), st.binary(max_size=4), st.booleans())
def test_any_damaged_png(at: int, change: bytes, keep: bool) -> None:
    holds("m.yaml", YAML, PICTURE[:at] + change + (PICTURE[at + len(change) :] if keep else b""))


CELLS = st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1)


@given(CELLS)
def test_pictures_and_points_have_one_outline(cells: set[tuple[int, int]]) -> None:
    occupied = np.zeros((7, 7), dtype=np.bool_)
    occupied[tuple(np.array(sorted(cells)).T[::-1])] = True
    drawn = {tuple(wall) for wall in raster_outline(occupied).tolist()}
    points = outline(np.array(sorted(cells), dtype=float) + 0.5, 1.0)
    assert drawn == {tuple(wall) for wall in points.tolist()}


NUMBERS = st.integers(-100_000, 100_000)


@given(st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS), max_size=5))
def test_whole_millimetres_survive_an_aria_map(rows: list[tuple[int, int, int, int]]) -> None:
    before = LineMap(name="m", walls=np.array(rows, dtype=float).reshape(-1, 4) * 0.001)
    with TemporaryDirectory() as folder:
        write_aria_map(before, Path(folder) / "m.map")
        after = read_map(Path(folder) / "m.map")
    np.testing.assert_array_equal(after.walls, before.walls)


METRES = st.floats(-1e4, 1e4)
NAMES = st.text(max_size=6).filter(str.isprintable)
POINTS = st.tuples(METRES, METRES)
SIZES = st.tuples(st.floats(0.01, 1000), st.floats(0.01, 1000))
HEIGHTS = st.floats(0.001, 40)
FEET = st.floats(0, 40)
FRICTIONS = st.floats(0.01, 3)
PLACES = st.builds(Pose2, METRES, METRES)
PLACED = {"pose": PLACES, "size": SIZES, "z": FEET}
SOLIDS = st.one_of(
    # above the ground, or a wall could go through them
    st.builds(Step, pose=PLACES, size=SIZES, height=st.floats(0.001, 10), z=st.just(100.0)),
    st.builds(Ramp, pose=PLACES, size=SIZES, height=st.floats(0.001, 10), z=st.just(100.0)),
    st.builds(Carpet, friction=FRICTIONS, height=st.floats(0.006, 0.05), **PLACED),
    st.builds(Cylinder, pose=PLACES, radius=st.floats(0.005, 500), height=HEIGHTS, z=FEET),
    st.builds(
        Table,
        height=st.floats(0.5, 40),
        thickness=st.floats(0.002, 0.4),
        leg_width=st.just(0.005),
        back=st.floats(0, 10),
        **PLACED,
    ),
)
WORLDS = st.builds(
    lambda name, seed, boxes, people, robots, solids, step, wall_height: WorldFile(
        name=name,
        seed=seed,
        boxes=tuple(boxes),
        people=tuple(people),
        robots=tuple(robots),
        solids=tuple(solids),
        physics_step=step / 1e6,
        wall_height=wall_height,
        walls=(Wall(points=((0.0, 0.0), (1.0, 1.0)), height=wall_height / 2),),
    ),
    NAMES,
    st.none() | st.integers(0, 2**63 - 1),
    st.lists(
        st.builds(
            Box,
            pose=PLACES,
            size=SIZES,
            movable=st.booleans(),
            name=NAMES,
            height=st.none() | HEIGHTS,
            z=FEET,
            mass=st.floats(0.01, 1000),
            friction=FRICTIONS,
        ),
        max_size=3,
    ),
    st.lists(
        st.builds(
            lambda path, speed, loop: Person(path=tuple(path), speed=speed, loop=loop),
            st.lists(POINTS, min_size=1, max_size=4),
            st.floats(0.01, 10),
            st.booleans(),
        ),
        max_size=2,
    ),
    st.lists(
        st.builds(
            lambda at: RobotSpec(start=Pose2(*at)),
            POINTS,
        ),
        max_size=2,
    ),
    st.lists(SOLIDS, max_size=4),
    st.integers(500, 2500),
    st.floats(0.002, 90),
)


@given(WORLDS)
def test_a_world_survives_its_file(world: WorldFile) -> None:
    here = Path("/somewhere")
    assert parse_world(here / "w.toml", to_toml(world, here)) == world


@given(st.lists(POINTS, min_size=1, max_size=5), st.floats(0, 1e6), st.booleans())
def test_a_person_is_somewhere_near_their_path(
    path: list[tuple[float, float]], time: float, loop: bool
) -> None:
    pose = Person(path=tuple(path), loop=loop, pause=1.0).pose_at(time)
    xs, ys = zip(*path, strict=True)
    assert min(xs) - 1e-3 <= pose.x <= max(xs) + 1e-3
    assert min(ys) - 1e-3 <= pose.y <= max(ys) + 1e-3
