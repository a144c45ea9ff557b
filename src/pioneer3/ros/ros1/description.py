"""The robot's description on the ROS parameter server, where rviz looks for it."""

from contextlib import suppress
from typing import Final

from pioneer3.ros.description.urdf import MAKER

NAME: Final = "robot_description"


class Description:
    """Sets `robot_description`, unless somebody else has; takes it away again.

    Its methods talk to the master, so they are called in a thread.
    """

    def __init__(self) -> None:
        self._ours: str | None = None

    def set(self, urdf: str) -> None:
        """Describe the robot; leave a description alone that is not one of this package's."""
        import rospy  # noqa: PLC0415

        there = rospy.get_param(NAME, "")
        if there and MAKER not in str(there):
            rospy.logwarn(f"{rospy.resolve_name(NAME)} is somebody else's: it stays as it is")
            return
        if there != urdf:
            rospy.set_param(NAME, urdf)
        self._ours = urdf

    def forget(self) -> None:
        """Take the description away, if it is still the one that was set."""
        import rospy  # noqa: PLC0415

        with suppress(OSError, KeyError, rospy.ROSException):  # the master may be gone
            if self._ours is not None and rospy.get_param(NAME, "") == self._ours:
                rospy.delete_param(NAME)
