"""The nodes of the humanoid: each connects a class of this package to the interface of its description."""
