"""What is wrong with an experiment, in one sentence."""
import difflib


class SweepError(Exception):
    """Bad input, or something that is missing; its text is the message for the user."""


def nearest(name, known):
    """What a sentence about an unknown name ends with."""
    near = difflib.get_close_matches(name, sorted(known), n=3, cutoff=0.4)
    # A path may be given without its beginning.
    near += [each for each in sorted(known) if each.endswith("." + name) and each not in near]
    return "; near to it: " + ", ".join(near[:4]) if near else ""
