"""Tables to people: plots, the HTML report and console tables."""
