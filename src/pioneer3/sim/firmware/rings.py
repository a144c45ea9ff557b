"""Which sonars a host lets fire, and in which order (POLLING, SONAR).

As the operations manuals of the Pioneer 3 describe it, "Enabling and configuring sonar": each array
of eight has an order of its own and a switch of its own.
"""

from collections.abc import Sequence
from itertools import compress

from pioneer3.arcos.reports import SipFlag
from pioneer3.sim.firing import ARRAY, Firing, in_order

FLAGS = SipFlag.SONAR_1, SipFlag.SONAR_2, SipFlag.SONAR_3, SipFlag.SONAR_4
LONGEST = 16
"""Transducers in the order of an array."""


class Rings:
    """The arrays of a robot with `count` transducers, each as delivered and off at first.

    Attributes:
        firing: What fires.
        flags: Which arrays are on.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self.reset(on=False)

    def reset(self, *, on: bool) -> None:
        """Go back to the order as delivered."""
        self._orders = [*in_order(self._count)]
        self._on = [on] * len(FLAGS)
        self._tell()

    def switch(self, on: bool, array: int) -> None:
        """Switch one array, 1 to 4, or all of them, 0."""
        for each in range(len(FLAGS)):
            if array in {0, each + 1}:
                self._on[each] = on
        self._tell()

    def poll(self, numbers: Sequence[int]) -> None:
        """Set the order of those arrays that `numbers`, from 1, are of; none switch all off."""
        if not numbers:
            self.switch(on=False, array=0)
        for array in range(len(self._orders)):
            those = range(array * ARRAY, min((array + 1) * ARRAY, self._count))
            order = tuple(number - 1 for number in numbers if number - 1 in those)
            if order:
                self._orders[array] = order[:LONGEST]
        self._tell()

    def _tell(self) -> None:
        pairs = zip(self._orders, self._on, strict=False)
        self.firing: Firing = tuple(order if on else () for order, on in pairs)
        self.flags = SipFlag(0)
        for flag in compress(FLAGS, self._on):
            self.flags |= flag
