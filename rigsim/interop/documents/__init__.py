"""What ``--json`` prints: a module a command, and the schemas that docs/schema holds.

Importing this package costs nothing; its modules load pydantic, `text` alone does not.
"""
