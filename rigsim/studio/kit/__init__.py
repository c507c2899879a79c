"""What pages share: a tab's session, the frame of the page, controls, numbers."""
