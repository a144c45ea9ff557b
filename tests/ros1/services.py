"""Prints the type of every service on the master, but for loggers, as JSON, in one go.

Usage: /usr/bin/python3 services.py
"""

from __future__ import annotations

import json
import sys

import rosservice

# all nodes have these, and those of a program that has been killed do not answer
LOGGERS = ("/get_loggers", "/set_logger_level")
names = [name for name in rosservice.get_service_list() if not name.endswith(LOGGERS)]
sys.stdout.write(json.dumps({name: rosservice.get_service_type(name) for name in names}))
