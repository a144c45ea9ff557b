"""A class at the page: students drive a robot each, and the teacher sees to all of them.

=========  =================================================================================
module     contents
=========  =================================================================================
downloads  routes to the wheel, the wheelhouse and the programs of lessons
live       `pioneer3 class`: robots with a bridge each, the page, and the class, in one loop
classroom  a class: students join and get a robot each
robot      one robot of a class
=========  =================================================================================
"""
