"""A pan-tilt-zoom camera by hand: its make, its port, then its keys (facts.md 8.6)."""

from collections.abc import Callable, Mapping
from math import radians

from pioneer3.demo.mode import Context, DemoMode, Description, Gauge
from pioneer3.errors import PioneerError
from pioneer3.robot.devices import Camera, CameraName, Presence
from pioneer3.units import DEGREE

PAN = radians(5)
"""Angle that a key pans by [rad]."""
TILT = radians(3)
"""Angle that a key tilts by [rad]."""
ZOOM = 0.01
"""Share of the range that a key zooms by."""
ON_AUX: Mapping[str, CameraName] = {"1": "sony", "2": "vcc4", "5": "vcc4-inverted"}
UNKNOWN = {"3": "DPPTU", "4": "AMPTU"}
ON_COMPUTER = "!@#$%^"
CHOICES = (
    "on the robot's AUX port:",
    "1: Sony",
    "2: Canon VCC4",
    "5: inverted Canon",
    "3, 4: DPPTU, AMPTU",
    "!@#$%^: on the computer",
)
PORTS = ("1: AUX1", "2: AUX2")


def camera(context: Context, about: Description) -> DemoMode:
    """Return the mode that aims a camera."""
    hand = _Aiming(context)
    return DemoMode(
        about,
        presence=hand.presence,
        begin=hand.begin,
        on_key=hand.on_key,
        gauges=hand.gauges,
        details=hand.details,
    )


class _Aiming:
    def __init__(self, context: Context) -> None:
        self._context = context
        self._make: CameraName | None = None
        self._camera: Camera | None = None
        self._end_exercise: Callable[[], None] = lambda: None

    def presence(self) -> Presence:
        if self._camera is not None:
            return self._camera.presence
        return Presence(None, "CONFIG does not tell of cameras: choose one, and it is asked.")

    def begin(self) -> None:
        """Begin with the choice, as long as no camera has been chosen that answers."""
        if self._camera is None or not self._camera.presence.there:
            self._make = self._camera = None

    def on_key(self, key: str) -> bool:
        if self._camera is not None:
            return self._aim(self._camera, key)
        if self._make is not None:
            return self._choose_port(self._make, key)
        return self._choose_make(key)

    def gauges(self) -> tuple[Gauge, ...]:
        if self._camera is None:
            return ()
        aim, kind = self._camera.aim, self._camera.kind
        return (
            Gauge(
                name="pan",
                share=-aim.pan / max(kind.pan.high, -kind.pan.low),
                text=f"{aim.pan / DEGREE:+z.0f}°",
                signed=True,
            ),
            Gauge(
                name="tilt",
                share=aim.tilt / max(kind.tilt.high, -kind.tilt.low),
                text=f"{aim.tilt / DEGREE:+z.0f}°",
                signed=True,
            ),
            Gauge(name="zoom", share=aim.zoom, text=f"{100 * aim.zoom:.0f} %"),
        )

    def details(self) -> tuple[str, ...]:
        if self._camera is not None:
            return (str(self._camera.presence),)
        return CHOICES if self._make is None else (f"{self._make} on which port?", *PORTS)

    def _choose_make(self, key: str) -> bool:
        if key in ON_AUX:
            self._make = ON_AUX[key]
            self._context.say(f"Camera {self._make}. On which port? {', '.join(PORTS)}")
        elif key in UNKNOWN:
            self._context.say(f"{UNKNOWN[key]}: the bytes of this unit are not documented.")
        elif len(key) == 1 and key in ON_COMPUTER:
            self._context.say("Cameras on a port of the computer are not built; AUX ports are.")
        else:
            return False
        return True

    def _choose_port(self, make: CameraName, key: str) -> bool:
        if key not in {"1", "2"}:
            return False
        self._camera = self._context.robot.devices.camera(make, int(key))
        self._context.work(self._connect(self._camera))
        return True

    async def _connect(self, camera: Camera) -> None:
        try:
            await camera.connect()
        except PioneerError:
            self._make = self._camera = None  # choose again
            raise
        self._context.say(str(camera.presence))

    def _aim(self, camera: Camera, key: str) -> bool:
        match key.lower():
            case "up":
                camera.turn(tilt=TILT)
            case "down":
                camera.turn(tilt=-TILT)
            case "left":
                camera.turn(pan=PAN)
            case "right":
                camera.turn(pan=-PAN)
            case "space":
                camera.centre()
            case "z":
                camera.zoom(camera.aim.zoom + ZOOM)
            case "x":
                camera.zoom(camera.aim.zoom - ZOOM)
            case "e":
                self._end_exercise()
                self._end_exercise = self._context.work(camera.exercise())
                return True
            case _:
                return False
        self._end_exercise()
        return True
