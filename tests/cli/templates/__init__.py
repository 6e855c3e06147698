"""Tests of `ifgen templates` and of templates in projects."""
