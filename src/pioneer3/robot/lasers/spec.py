"""Lasers as people write them on a command line."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.lasers.client import AS_DELIVERED, ScanSettings
from pioneer3.links.urls import BARE_HOST, HOST_AND_PORT, opener, split_url
from pioneer3.models import LaserMount, RobotModel
from pioneer3.models.lasers import HOKUYO_PORT, LASERS, LaserProtocol, load_laser
from pioneer3.models.model import REACH, OwnFile, OwnLaser
from pioneer3.models.own import wrong_in_own
from pioneer3.robot.lasers.driver import LaserConfig
from pioneer3.robot.lasers.mounting import Mounting, Sector
from pioneer3.units import ANGLE, LENGTH

UPSIDE_DOWN = "upside-down"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserSpec:
    """A laser of a robot, as it was asked for.

    A `mounting` of `None`, and sectors besides those `masked`, are those of the robot's model. If
    it is `inverted` it hangs head down, also where its place does not say so.
    """

    url: str
    name: str = "laser"
    protocol: LaserProtocol | None = None
    mounting: Mounting | None = None
    inverted: bool = False
    masked: tuple[Sector, ...] = ()
    settings: ScanSettings = AS_DELIVERED
    time_offset: float = 0.0

    def config(self) -> LaserConfig:
        """Return the laser for a driver; ConfigError if the URL names no port."""
        return LaserConfig(
            url=self.url,
            open=opener(self.url, link=self.name),
            name=self.name,
            protocol=self.protocol,
            settings=self.settings,
            time_offset=self.time_offset,
        )

    def mounting_on(self, model: RobotModel | None) -> Mounting:
        """Return its place on a robot of this model; on no robot it is the origin."""
        usual = mounting_of(model.laser) if model and model.laser else Mounting()
        found = self.mounting or usual
        return replace(
            found,
            delay=usual.delay if found.delay is None else found.delay,
            upside_down=found.upside_down or self.inverted,
            masked=found.masked + self.masked,
        )


def mounting_of(mount: LaserMount) -> Mounting:
    """Return the place that a robot's model gives."""
    return Mounting(
        sensor_in_robot=Pose2(mount.x, mount.y, mount.theta),
        upside_down=mount.upside_down,
        masked=tuple(Sector(first, last) for first, last in mount.masked),
        delay=mount.delay,
    )


def parse_lasers(
    lasers: Sequence[str], poses: Sequence[str] = (), masks: Sequence[str] = ()
) -> tuple[LaserSpec, ...]:
    """Read the options of a command line: `[MODEL@]PORT` of each laser.

    Poses are `x,y,heading[,upside-down]`, for the first lasers in their order; masks likewise are
    `first:last[,first:last ...]`. Raises ConfigError if one of them is wrong, or there are more
    poses or masks than lasers.
    """
    for option, given in (("--laser-pose", poses), ("--laser-mask", masks)):
        if len(given) > len(lasers):
            raise ConfigError(f"{option}: {len(given)} given, but lasers: {len(lasers)}")
    specs = []
    for number, text in enumerate(lasers):
        name = "laser" if number == 0 else f"laser{number + 1}"
        spec = replace(parse_laser(text), name=name)
        if number < len(poses):
            spec = replace(spec, mounting=parse_mounting(poses[number]))
        if number < len(masks):
            spec = replace(spec, masked=parse_mask(masks[number]))
        specs.append(spec)
    twice = next((s.url for s in specs if [o.url for o in specs].count(s.url) > 1), None)
    if twice:
        raise ConfigError(f"--laser {twice}: given twice")
    return tuple(specs)


def refuse_robots(specs: Iterable[LaserSpec], robots: Iterable[str]) -> None:
    """Raise ConfigError for a laser at a port of a robot: it would take the robot's bytes."""
    taken = {split_url(url) for url in robots}
    for spec in specs:
        if split_url(spec.url) in taken:
            raise ConfigError(f"--laser {spec.url}: that is the robot's own port")


def own_lasers(own: OwnFile, robots: Iterable[str] = ()) -> tuple[LaserSpec, ...]:
    """Return the lasers of a robot's own file; ConfigError for a port that is none, or taken."""
    kinds = (laser.mount.kind for laser in own.lasers)
    urls = [
        f"{kind}@{laser.port}" if kind in LASERS else laser.port
        for kind, laser in zip(kinds, own.lasers, strict=True)
    ]
    for number, url in enumerate(urls):
        try:
            refuse_robots([parse_laser(url)], robots)
            if url in urls[:number]:
                parse_lasers([url, url])  # says that it is given twice
        except ConfigError as error:
            raise wrong_in_own(own, f"lasers[{number}].port", error) from None
    specs = parse_lasers(urls)
    return tuple(
        replace(spec, mounting=mounting_of(laser.mount))
        for spec, laser in zip(specs, own.lasers, strict=True)
    )


def own_laser(text: str, spec: LaserSpec, model: RobotModel) -> OwnLaser:
    """Return a laser, `text` as it was asked for, as the own file of a robot has it."""
    place = spec.mounting_on(model)
    return OwnLaser(
        port=spec.url,
        mount=LaserMount(
            kind=text.rpartition("@")[0] or "laser",
            x=place.sensor_in_robot.x,
            y=place.sensor_in_robot.y,
            theta=place.sensor_in_robot.theta,
            upside_down=place.upside_down,
            masked=tuple((sector.first, sector.last) for sector in place.masked),
            delay=place.delay or 0.0,
        ),
    )


def parse_laser(text: str) -> LaserSpec:
    """Read `[MODEL@]PORT`, such as `lms-200@/dev/ttyUSB1`; ConfigError for no laser or port."""
    model, at, url = text.rpartition("@")
    if at and model not in LASERS and "/" not in model:
        load_laser(model)  # says which there are
    if not at or model not in LASERS:
        model, url = "", text
    if BARE_HOST.fullmatch(url):
        url = f"tcp://{url}"
    if url.startswith("tcp:") and not HOST_AND_PORT.search(url):
        ports = LASERS[model].tcp_ports if model else ()
        url = f"{url.rstrip('/')}:{ports[0] if ports else HOKUYO_PORT}"
    try:
        split_url(url)
    except ConfigError as error:
        raise ConfigError(f"--laser: {error}") from None
    return LaserSpec(url=url, protocol=LASERS[model].protocol if model else None)


def parse_mounting(text: str) -> Mounting:
    """Read `x,y,heading`, with `,upside-down` for one that hangs head down.

    Numbers are in m and degrees unless they carry units, such as `160mm,0,1.57rad`. Raises
    ConfigError if it is no such place, or not on a robot.
    """
    parts = [part.strip() for part in text.split(",")]
    upside_down = parts[-1] == UPSIDE_DOWN
    try:
        x, y, heading = _exactly(3, parts[: len(parts) - upside_down])
        pose = Pose2(LENGTH.read(x), LENGTH.read(y), wrap(ANGLE.read(heading)))
    except ValueError as error:
        raise ConfigError(
            f"--laser-pose {text}: expected x,y,heading in m and degrees, such as 0.16,0,0 or "
            f"160mm,0,180,{UPSIDE_DOWN}: {error}"
        ) from None
    if not (REACH.holds(pose.x) and REACH.holds(pose.y)):
        raise ConfigError(f"--laser-pose {text}: at most {REACH.high:g} m from the robot's middle")
    return Mounting(sensor_in_robot=pose, upside_down=upside_down)


def parse_mask(text: str) -> tuple[Sector, ...]:
    """Read sectors to leave out [degrees], as in `-135:-120,120:135`; ConfigError for others."""
    try:
        ends = [_exactly(2, part.split(":")) for part in text.split(",")]
        return tuple(Sector(ANGLE.read(first), ANGLE.read(last)) for first, last in ends)
    except ValueError as error:
        raise ConfigError(
            f"--laser-mask {text}: expected sectors in degrees, counter-clockwise, such as "
            f"-135:-120,120:135: {error}"
        ) from None


def _exactly(count: int, parts: list[str]) -> list[str]:
    if len(parts) != count:
        raise ValueError(f"{count} numbers are needed, not {len(parts)}")
    return parts
