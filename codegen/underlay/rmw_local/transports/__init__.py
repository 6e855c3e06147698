"""Ways to other processes: what an engine has to offer (`seam`), and how a domain uses one (`link`).

Nothing here is imported, but `reach`, until another process shows up.
"""
