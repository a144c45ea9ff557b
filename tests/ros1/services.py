"""Prints the type of every service on the master as JSON, in one go.

Usage: /usr/bin/python3 services.py
"""

from __future__ import annotations

import json
import sys

import rosservice

names = rosservice.get_service_list()
sys.stdout.write(json.dumps({name: rosservice.get_service_type(name) for name in names}))
