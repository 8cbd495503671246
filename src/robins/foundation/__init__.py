"""The floor that everything stands on: streams of random numbers, small matrices, the earth, files and errors."""
