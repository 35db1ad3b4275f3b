"""What stops the page, in one sentence."""


class ReportError(Exception):
    """Bad input, or something that is missing; its text is the message for the user."""
