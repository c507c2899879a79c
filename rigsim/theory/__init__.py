"""What should happen: triangulation, uncertainty, sensitivity and limits; numpy only, knows no image."""
