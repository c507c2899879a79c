"""From a page's words to its answer, without a browser."""
