"""Whether a robot has a device, and the evidence."""

from dataclasses import dataclass

from pioneer3.robot.supervisor import RobotInfo


@dataclass(frozen=True, slots=True)
class Presence:
    """Whether a device is there, `None` while unknown; and the evidence or advice, a sentence."""

    there: bool | None
    reason: str

    def __str__(self) -> str:
        return self.reason


def bumpers_of(info: RobotInfo) -> Presence:
    """Return whether there are bumpers, and how many segments."""
    config, model = info.config, info.model
    front, rear = (config.front_bumpers, config.rear_bumpers) if config else (None, None)
    if front or rear:
        return Presence(True, f"The robot has bumpers: {_segments(front, rear)}, says its CONFIG.")
    if model.front_bumpers or model.rear_bumpers:
        segments = _segments(model.front_bumpers, model.rear_bumpers)
        return Presence(True, f"A {model.title} has bumpers: {segments}; its CONFIG names none.")
    if front is None:
        return Presence(None, f"A {model.title} comes without bumpers, and CONFIG does not tell.")
    return Presence(False, "The robot has no bumpers: its CONFIG says FrontBumps 0, RearBumps 0.")


def sonars_of(info: RobotInfo) -> Presence:
    """Return whether there are sonars."""
    config, count = info.config, len(info.model.sonars)
    if config and (config.has_front_sonar or config.has_rear_sonar):
        arrays = {"front": config.has_front_sonar, "rear": config.has_rear_sonar}
        fitted = " and ".join(name for name, there in arrays.items() if there)
        return Presence(True, f"The robot has sonars: {fitted}, says its CONFIG.")
    if config and config.has_front_sonar == 0:
        return Presence(False, "The robot has no sonars: its CONFIG says FrontSonar 0.")
    if count:
        return Presence(True, f"A {info.model.title} has {count} sonars.")
    return Presence(None, "Nobody knows of sonars: neither CONFIG nor the model tells.")


def _segments(front: int | None, rear: int | None) -> str:
    return f"{front or 0} segments in front, {rear or 0} behind"
