"""The generators that come with ifgen: each in a room of its own, on the public interface alone.

They import `ifgen.model` and `ifgen.generators`, as anybody's do, and are found by their entry points.
"""
