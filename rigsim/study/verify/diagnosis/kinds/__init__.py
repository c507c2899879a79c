"""The known mistakes by what is done wrong."""
