"""Names of the frames of one robot."""

from dataclasses import dataclass, fields, replace


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """Names of the frames, without a leading slash.

    Attributes:
        odom: Fixed where the robot began.
        base: The robot: on the floor, in the centre of its rotation.
        footprint: The same under its other name (REP 120).
        bumpers: Of the bumpers; the robot's own pose.
        sonar: Of all sonars together; the robot's own pose: their points are in robot coordinates.
        sonar_prefix: Before the number of a transducer, which looks along its frame's x axis.
        laser: Of the laser range finder.
        imu: Of the gyro.
    """

    odom: str = "odom"
    base: str = "base_link"
    footprint: str = "base_footprint"
    bumpers: str = "bumpers"
    sonar: str = "sonar"
    sonar_prefix: str = "sonar_"
    laser: str = "laser"
    imu: str = "imu_link"

    def transducer(self, number: int) -> str:
        """Return the frame of one sonar transducer."""
        return f"{self.sonar_prefix}{number}"

    @property
    def bumper_link(self) -> str:
        """What bumpers are part of, also where their messages name the base."""
        return "bumpers" if self.bumpers == self.base else self.bumpers

    def with_prefix(self, prefix: str) -> "Frames":
        """Return the names of one of many robots, such as `robot1/base_link`."""
        names = {each.name: prefix + getattr(self, each.name) for each in fields(self)}
        return replace(self, **names)
