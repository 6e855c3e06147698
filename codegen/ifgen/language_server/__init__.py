"""The server behind `ifgen lsp`: answers editors while somebody writes interfaces and node descriptions."""
