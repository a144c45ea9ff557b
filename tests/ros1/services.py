"""Prints the type of every service of a node on the master as JSON, in one go.

Usage: /usr/bin/python3 services.py
"""

from __future__ import annotations

import json
import sys

import rosservice

# those of a tool that has just ended do not answer
names = [name for name in rosservice.get_service_list() if not name.startswith("/ros")]
sys.stdout.write(json.dumps({name: rosservice.get_service_type(name) for name in names}))
