"""The text of node packages: what stands in their files, worked out before a template sees it."""
