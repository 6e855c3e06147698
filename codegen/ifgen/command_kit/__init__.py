"""Options, completion, printing and errors of commands, for those of other distributions, too."""
