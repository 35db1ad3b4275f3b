"""What is wrong with an experiment, in one sentence."""
import difflib


class SweepError(Exception):
    """Bad input, or something that is missing; its text is the message for the user."""


def nearest(name, known):
    """What a sentence about an unknown name ends with: a question for at most three that it may be."""
    # A path may be given without its beginning.
    near = [each for each in sorted(known) if each.endswith("." + name)]
    near = (near or difflib.get_close_matches(name, sorted(known), n=3))[:3]
    if not near:
        return ""
    return f": did you mean {', '.join(near[:-1])}{' or ' if near[1:] else ''}{near[-1]}?"
