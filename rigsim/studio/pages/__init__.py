"""One module a page: what stands where. What it says comes from `rigsim.studio.logic`."""
