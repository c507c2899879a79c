"""What every mistake that `verify` and `sweep` know is called in a sentence, by what is done wrong."""
