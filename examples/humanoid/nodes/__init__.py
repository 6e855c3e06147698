"""The nodes of the humanoid: each puts a class of this package behind the interface of its description."""
