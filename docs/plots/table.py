"""The table of all pictures: a row for each."""

from docs.plots.architecture import WAYS, architecture
from docs.plots.by_reader import by_hand, reading
from docs.plots.classroom import DESK, classroom
from docs.plots.icons import icons
from docs.plots.moving import LOOKED_AT, SCALE, kitchen
from docs.plots.page import (
    THREE,
    camera,
    explore,
    first,
    laser,
    look,
    replayed,
    several,
    solid,
    together,
)
from docs.plots.sonar_angle import sonar_angle
from docs.plots.studio import DESKTOP, PHONE, Picture, Scene, Size
from docs.plots.terminals import demo
from docs.plots.terminals import laser as laser_in_terminal
from docs.plots.tutorial import SHOTS, SIZE

STATIC = "web/static"
PAGE = f"{STATIC}/index.html", f"{STATIC}/styles", f"{STATIC}/map", f"{STATIC}/panels/status.js"
"""Parts that are seen in all pictures of the page."""
MODES = (*PAGE, f"{STATIC}/panels/modes.js")
CLASS = f"{STATIC}/classroom", f"{STATIC}/pages/class.html", f"{STATIC}/pages/class.css"
GO = (*PAGE, "web/navigation.py")


def of_page(
    name: str,
    shows: str,
    scene: Scene,
    *visible: str,
    size: Size = DESKTOP,
    parts: tuple[str, ...] = PAGE,
) -> Picture:
    """Return the row of a picture of the page."""
    file = f"docs/images/{name}.png"
    return Picture(file=file, shows=shows, scene=scene, size=size, parts=parts, visible=visible)


def of_terminal(name: str, shows: str, scene: Scene, size: Size, *parts: str) -> Picture:
    """Return the row of a picture of a terminal."""
    file = f"docs/images/{name}.png"
    return Picture(file=file, shows=shows, scene=scene, size=size, parts=parts, visible=("svg",))


def of_architecture(name: str) -> Picture:
    """Return the row of a picture of the architecture, which a test compares with the modules."""
    return Picture(
        file=f"docs/images/architecture-{name}.svg",
        shows="the layers, or a way through them",
        scene=architecture,
        size=None,
        parts=(),
    )


def of_app(name: str) -> Picture:
    """Return the row of an icon of the app."""
    side = int(name.rsplit("-", 1)[1])
    return Picture(
        file=f"src/pioneer3/{STATIC}/app/{name}.png",
        shows="the robot of the favicon",
        scene=icons,
        size=(side, side),
        parts=(f"{STATIC}/favicon.svg",),
        visible=("svg",),
    )


def of_tutorial(page: str) -> list[Picture]:
    """Return the rows of the pictures of a page of the tutorial."""
    scene = reading(page)
    names = [name for name in SHOTS if name.startswith(f"{page}-")]
    return [
        Picture(
            file=f"docs/images/tutorial/{name}",
            shows=SHOTS[name].__doc__ or "",
            scene=scene,
            size=SIZE,
            parts=CLASS if page == "class" else PAGE,
        )
        for name in names
    ]


ROWS = (
    of_page("page", "the page of a simulated robot", first),
    of_page(
        "page-way", "the way to the kitchen, before Go is pressed", first, "#goto-go", parts=GO
    ),
    Picture(
        file="docs/images/kitchen.webp",
        shows="the page sends the robot to the kitchen, a moving picture",
        scene=kitchen,
        size=(round(SCALE * LOOKED_AT[0]), round(SCALE * LOOKED_AT[1])),
        parts=GO,
    ),
    of_page("page-modes", "a robot wanders", look, "#view-modes", "#mode-card", parts=MODES),
    of_page(
        "page-plots",
        "plots of what the robot reports",
        look,
        *("#view-plots", "#view-plots canvas"),
        parts=(*PAGE, f"{STATIC}/panels/plots.js", f"{STATIC}/panels/time_axis.js"),
    ),
    of_page(
        "page-robot",
        "all that the robot reports",
        look,
        "#view-robot",
        parts=(*PAGE, f"{STATIC}/panels/robot_view.js"),
    ),
    of_page("page-phone-stopped", "the emergency stop on a phone", look, "#reset", size=PHONE),
    of_page("page-laser", "what a laser sees, on the map", laser),
    of_page(
        "page-replay",
        "a log on the page, at the mark of an emergency stop",
        replayed,
        "#replay-play",
        parts=(*PAGE, f"{STATIC}/replay"),
    ),
    of_page(
        "page-camera",
        "pictures of a simulated camera, beside the map",
        camera,
        ".camera-picture",
        parts=(*PAGE, f"{STATIC}/panels/camera.js", "sim/physics/renderer.py"),
    ),
    of_page(
        "map",
        "three robots, of which the third has the offer of a place",
        several,
        "#goto-go",
        size=(1055, 832),
        parts=GO,
    ),
    of_page(
        "page-3d",
        "robots in three dimensions",
        solid,
        size=THREE,
        parts=(*PAGE, f"{STATIC}/view3d"),
    ),
    of_page("page-together", "five robots in a wedge", together, size=THREE),
    of_page("page-making-a-map", "a robot explores", explore, "#map-explore", parts=MODES),
    of_page(
        "map-built",
        "the map that a robot made by exploring the office",
        explore,
        size=(1600, 1136),
        parts=("nav/mapper.py", "maps/office.map"),
    ),
    of_page(
        "class-link",
        "the link to a class, for the projector",
        classroom,
        "#projector",
        size=DESK,
        parts=CLASS,
    ),
    of_page(
        "class",
        "the teacher's page of a class",
        classroom,
        size=DESK,
        parts=CLASS,
    ),
    of_page("class-phone", "a student's page", classroom, size=PHONE),
    of_terminal("demo", "the screen of pioneer3 demo", demo, (1142, 685), "demo"),
    of_terminal(
        "laser", "what pioneer3 laser shows", laser_in_terminal, (1142, 759), "cli/laser.py"
    ),
    Picture(
        file="docs/images/sonar-angle.svg",
        shows="what a sonar hears of a wall, over the angle to it",
        scene=sonar_angle,
        size=None,
        parts=("sim/realism.py", "sim/sensors.py"),
    ),
    *map(of_architecture, ("layers", *(way.name for way in WAYS))),
    *(
        row
        for page in ("drive", "sonar", "wander", "kitchen", "class")
        for row in of_tutorial(page)
    ),
    Picture(
        file="docs/images/tutorial/real-robot-cable.svg",
        shows="the cable to a robot, drawn by hand",
        scene=by_hand,
        size=None,
        parts=(),
    ),
    *map(of_app, ("icon-192", "icon-512", "maskable-512", "apple-180")),
)
PICTURES = {row.name: row for row in ROWS}
"""The rows by the names of their pictures."""
