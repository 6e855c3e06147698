"""From folders with definitions to folders with Python: read, resolve, plan, render, write."""
