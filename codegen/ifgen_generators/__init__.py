"""The generators of other languages that come with ifgen. They use `ifgen.model` and nothing else of ifgen."""
