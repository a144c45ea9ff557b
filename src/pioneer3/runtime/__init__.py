"""The composition root: joins links, driver, behaviors, simulator and adapters."""
