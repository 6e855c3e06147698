"""Which node talks to which: from node descriptions or a running system to Mermaid, DOT and SVG."""
