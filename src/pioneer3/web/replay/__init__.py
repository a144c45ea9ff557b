"""Logs on the page as if they were live; nothing in them can be driven.

========  ====================================================================
module    contents
========  ====================================================================
live      `pioneer3 replay`
replay    plays logs to the clients of a page: the time, what they are sent
recorded  one robot of a log: what is known of it at any time
view      that as the messages by which pages are told of a driven robot
marks     the events of a log, in words: stops, stalls, modes, goals
========  ====================================================================
"""
