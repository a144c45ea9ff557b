"""Close and open the gripper; it needs one: `pioneer3 sim --fit gripper`.

ARIA: ArGripper, getType, gripOpen, gripClose, liftUp, liftDown, getBreakBeamState, isGripMoving,
isLiftMaxed, getPaddleState.
"""

import sys
import time

from pioneer3 import DeviceError, connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    gripper = robot.devices.gripper
    try:
        print("the paddles are", gripper.reading().paddles)
    except DeviceError as error:  # getType() == NOGRIPPER
        sys.exit(str(error))
    for act, wanted in ((gripper.close, "closed"), (gripper.open, "open")):
        act()
        end = time.monotonic() + 6
        for reading in gripper.values():  # getPaddleState, isGripMoving
            if reading.paddles == wanted or time.monotonic() > end:
                break
        print(f"the paddles are {reading.paddles}, beam broken: {reading.inner_beam_broken}")
