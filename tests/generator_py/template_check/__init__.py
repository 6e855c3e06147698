"""Tests of the static check of templates."""
