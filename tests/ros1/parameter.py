"""Prints a parameter as JSON, without rosparam's line breaks.

Usage: /usr/bin/python3 parameter.py NAME
"""

from __future__ import annotations

import json
import sys

import rosgraph

sys.stdout.write(json.dumps(rosgraph.Master("/parameter").getParam(sys.argv[1])))
