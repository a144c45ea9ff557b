"""What the robot's sensors are like. The rays are cast by the kernels."""

SONAR_RANGE = 5.0
"""What a transducer reports when nothing echoes, and the farthest it hears [m] (facts.md 7.2)."""
SONAR_MIN = 0.1
"""Nearer echoes come while the transducer still rings [m] (facts.md 9.6)."""
LASER_RANGE = 32.0
"""Of a SICK LMS-200 in 10 mm mode [m]."""
