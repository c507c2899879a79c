"""Pictures that follow a hand: SVG and chart options made in a few milliseconds, without matplotlib."""
