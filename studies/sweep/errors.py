"""What is wrong with an experiment, in one sentence."""
import difflib
import os


class SweepError(Exception):
    """Bad input, or something that is missing; its text is the message for the user."""


def close_names(name, known):
    """At most three of `known` that a mistyped name may be."""
    # A path may be given without its beginning.
    near = [each for each in sorted(known) if each.endswith("." + name)]
    return (near or difflib.get_close_matches(name, sorted(known), n=3))[:3]


def question(near):
    """What a sentence about an unknown name ends with, which asks for the names that it may be."""
    if not near:
        return ""
    return f": did you mean {', '.join(near[:-1])}{' or ' if near[1:] else ''}{near[-1]}?"


def nearest(name, known):
    """The question for those of `known` that a mistyped name may be."""
    return question(close_names(name, known))


def nearest_file(path, folders):
    """The same for a JSON file that is not there, among those beside it, else among those of `folders`."""
    name = os.path.basename(path).removesuffix(".json")
    for folder in (os.path.dirname(path) or ".", *folders):
        listed = os.listdir(folder) if os.path.isdir(folder) else []
        near = close_names(name, [each.removesuffix(".json") for each in listed if each.endswith(".json")])
        if near:
            return question([os.path.relpath(os.path.join(folder, each + ".json")) for each in near])
    return ""
