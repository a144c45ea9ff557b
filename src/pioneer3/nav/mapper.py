"""Makes a map: where the robot is, live, from scans and odometry."""

from math import hypot

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import Edge, KeyFrame
from pioneer3.nav.matching import Cloud, Match, Prior, Submap
from pioneer3.nav.loops import *

Float = NDArray[np.float64]

APART, TURNED = 0.25, 0.25
"""A key frame is made so far from the last one [m, rad]."""
RECENT = 30
"""Scans are matched against so many key frames."""


class Mapper:
    def __init__(self, start: Pose2 = ORIGIN) -> None:
        self.frames: tuple[KeyFrame, ...] = ()
        self.poses: tuple[Pose2, ...] = ()
        self.edges: tuple[Edge, ...] = ()
        self._here = start
        self._odom: Pose2 | None = None
        self._scan_odom = ORIGIN
        self.way = self.turn = 0.0
        self._seen_way = self._seen_turn = 0.0
        self._submap = Submap((), ())
        self._looked = 0
        self._waiting = ()

    def move(self, robot_in_odom: Pose2) -> None:
        if self._odom is not None:
            step = self._odom.inverse() @ robot_in_odom
            self.way += hypot(step.x, step.y)
            self.turn += abs(step.theta)
        self._odom = robot_in_odom

    def add(self, beams: Beams) -> Pose2:
        self.move(beams.robot_in_odom)
        cloud = Cloud.of(beams)
        if not self.frames:
            self._keep(beams, cloud, self._here, None)
            return self._here
        key = self.frames[-1]
        way, turn = self.way - key.way, self.turn - key.turn
        sigma, sigma_theta = 0.01 + 0.05 * way, 0.01 + 0.1 * turn + 0.05 * way
        expected = self.poses[-1] @ (key.beams.robot_in_odom.inverse() @ beams.robot_in_odom)
        self.prior = prior = Prior.around(expected, sigma, sigma_theta)
        guess = self._here @ (self._scan_odom.inverse() @ beams.robot_in_odom)
        way, turn = self.way - self._seen_way, self.turn - self._seen_turn
        window, window_theta = 0.05 + 0.12 * way, 0.04 + 0.15 * turn + 0.07 * way
        if window > 0.1 or window_theta > 0.1:
            guess, worth = self._submap.search(cloud.points, guess, window, window_theta)
        match = self._submap.match(cloud.points, guess, prior)
        self.match = match
        here = match.pose if match.inliers > 0.3 else expected
        self._here, self._scan_odom = here, beams.robot_in_odom
        self._seen_way, self._seen_turn = self.way, self.turn
        step = self.poses[-1].inverse() @ here
        if hypot(step.x, step.y) >= APART or abs(step.theta) >= TURNED:
            self._keep(beams, cloud, here, match)
        return here

    def _keep(self, beams, cloud, here, match):
        self.frames += (KeyFrame.of(beams, cloud, self.way, self.turn),)
        if match is not None:
            k = len(self.frames)-1
            self.edges += (Edge(k-1,k,self.poses[-1].inverse() @ here, certainty(match, self.prior)),)
        self.poses += (here,)
        self._recall()
        self._scan_odom = beams.robot_in_odom
        self._seen_way, self._seen_turn = self.way, self.turn

    def _recall(self):
        recent = slice(-RECENT, None)
        self._submap = Submap([f.cloud for f in self.frames[recent]], self.poses[recent])

    def snapshot(self):
        return Snapshot(frames=self.frames,poses=self.poses,edges=self.edges,looked=self._looked,waiting=self._waiting)

    def apply(self, imp):
        n=len(imp.poses)
        edges = imp.edges + tuple(e for e in self.edges if e.second >= n)
        self.edges=edges
        self._looked, self._waiting = imp.looked, imp.waiting
        if imp.poses == self.poses[:n]: return
        c = imp.poses[-1] @ self.poses[n-1].inverse()
        self.poses = imp.poses + tuple(c @ p for p in self.poses[n:])
        self._here = c @ self._here
        self._recall()
