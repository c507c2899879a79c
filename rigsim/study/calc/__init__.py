"""What a calculator says beside its numbers."""
