#!/usr/bin/env python3
"""What has become of a Slurm job, for Snakemake: slurm_status.py JOB prints running, success or failed. Asks the
controller, since small clusters keep no accounts; one that cannot be reached reveals nothing about the job."""
import re
import subprocess
import sys

OVER = ("BOOT_FAIL", "CANCELLED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "TIMEOUT", "REVOKED")


def status(job):
    # The cluster's name may stand behind the number.
    done = subprocess.run(
        ["scontrol", "--oneliner", "show", "job", job.split(";")[0]], capture_output=True, text=True, check=False
    )
    state = re.search(r"\bJobState=(\w+)", done.stdout)
    if state is None:
        # The controller forgets a job some minutes after its end. If it was finished, the next try sees that.
        return "failed" if "Invalid job id" in done.stderr else "running"
    if state[1] == "COMPLETED":
        return "success"
    return "failed" if state[1] in OVER else "running"


if __name__ == "__main__":
    print(status(sys.argv[1]))
