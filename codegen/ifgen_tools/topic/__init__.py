"""`ifgen topic`: looks at topics, listens to them and publishes on them."""
