"""Names of the resource index."""

RESOURCE_INDEX_SUBFOLDER = "share/ament_index/resource_index"
"""The folder of the index, below an installation prefix."""

AMENT_PREFIX_PATH_ENV_VAR = "AMENT_PREFIX_PATH"
"""The environment variable that lists installation prefixes, the first one first."""
