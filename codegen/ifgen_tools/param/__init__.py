"""`ifgen param`: looks at parameters of running nodes, and sets them."""
