"""Node descriptions (NoDL v2): what was written, and what it means once included, resolved and checked."""
