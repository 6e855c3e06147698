"""Launch files in XML: `ifgen launch` reads them, so here is only what other launch files import."""
