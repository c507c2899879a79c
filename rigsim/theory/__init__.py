"""What should happen: triangulation and the closed forms of its errors; knows no image."""
