"""The syntax of a NoDL document, in YAML or JSON, before its meaning."""
