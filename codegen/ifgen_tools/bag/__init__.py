"""`ifgen bag`: records, plays, and looks into bags."""
