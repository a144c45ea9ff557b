"""A class at the page: students drive a robot each, and the teacher sees to all of them."""
