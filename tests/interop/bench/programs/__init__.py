"""Programs that do what they are told: one for each implementation, with its public API.

Each is run by the interpreter that has what it imports, which need not have ifgen. So they import nothing of
ifgen but each other, and what they are about by name.
"""
