"""Headless Chromium, which by itself asks for as little as can be, and what a page in it has asked for."""
import json
import shutil

PROGRAMS = ("chromium-headless-shell", "chromium")
# No updates, accounts, dictionaries, reports or first steps.
QUIET = (
    "--disable-background-networking",
    "--disable-breakpad",
    "--disable-client-side-phishing-detection",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-domain-reliability",
    "--disable-extensions",
    "--disable-features=AutofillServerCommunication,CertificateTransparencyComponentUpdater,MediaRouter,"
    "OptimizationHints,Translate",
    "--disable-search-engine-choice-screen",
    "--disable-sync",
    "--metrics-recording-only",
    "--no-default-browser-check",
    "--no-first-run",
    "--no-pings",
    "--password-store=basic",
)
# In a net log the origins of a page that was opened from disk; the browser's own requests have none ("not an origin"),
# or one of its services'.
PAGE_ORIGINS = ("file://", "null")


def program():
    """Path of the browser, or None."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


def command(profile, *options):
    """What starts it with a profile folder of its own; the last of the options is the page's address."""
    return [program(), "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom", f"--user-data-dir={profile}",
            *QUIET, *options]  # fmt: skip


def asked_by_page(log):
    """The addresses on a network that the page has asked for, of the text of a net log (--log-net-log). A log that has
    no requests at all, because it is of another form, is a ValueError."""
    net = json.loads(log)
    try:
        start = net["constants"]["logEventTypes"]["URL_REQUEST_START_JOB"]
        requests = [event["params"] for event in net["events"] if event["type"] == start and "params" in event]
    except (KeyError, TypeError) as error:
        raise ValueError(f"this is no net log of Chromium: {error}") from error
    asked = {request["url"] for request in requests if request.get("initiator") in PAGE_ORIGINS}
    return {url for url in asked if not url.startswith(("file:", "data:"))}
