"""What the robot wants to do: actions with priorities, merged by one resolver. Pure."""
