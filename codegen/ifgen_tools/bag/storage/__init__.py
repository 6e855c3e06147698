"""Bags as they are written: files of both formats, folders with their metadata, all or nothing."""
