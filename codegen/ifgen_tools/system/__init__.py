"""The contract of a robot: who meets whom, by its launch files and the documents of its nodes."""
