"""The lab's robotDemo in a terminal: modes that know no screen, and two faces for them."""
