"""`ifgen nodl`: descriptions of nodes that run, and the schema of descriptions."""
