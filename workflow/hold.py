"""Run a command holding a lock on a file: ``python workflow/hold.py wait|refuse FILE COMMAND...``.

The system drops the lock with the process that holds it, however that dies. Only the standard
library is needed, which has flock everywhere; the command of that name is missing on some systems.

A network file system must make the lock known to every machine. Some do so by a mount option only:
where the mount says that locks stay on this machine, the command is refused.
"""

import fcntl
import os
import subprocess
import sys
import time

# Mount options by which a file system keeps locks on the machine, or has none.
UNSAFE = {
    "nfs": {"nolock", "local_lock=flock", "local_lock=all"},
    "nfs4": {"nolock", "local_lock=flock", "local_lock=all"},
    "lustre": {"localflock", "noflock"},
    "cifs": {"nobrl"},
}


def refuse_unsafe(path: str) -> None:
    """Exit if locks of the file system that holds ``path`` do not hold on other machines."""
    question = ["findmnt", "--first-only", "--noheadings", "--output=FSTYPE,OPTIONS", "--target"]
    try:
        asked = subprocess.run([*question, path], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):  # no Linux
        return
    kind, options = asked.stdout.rstrip().split(maxsplit=1)
    if told := sorted(UNSAFE.get(kind, set()).intersection(options.split(","))):
        sys.exit(f"{path}: {kind} is mounted here with {', '.join(told)}, so that no other machine "
                 "sees a lock: have it mounted without, or work in another folder")  # fmt: skip


def main() -> None:
    """Take the lock, and become the command."""
    mode, path, *command = sys.argv[1:]
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    refuse_unsafe(path)
    patience = time.monotonic() + 5  # a process that was just killed may still hold it for a moment
    while True:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | (fcntl.LOCK_NB if mode == "refuse" else 0))
            break
        except BlockingIOError:
            if time.monotonic() > patience:
                sys.exit("another make runs the study in this directory; wait for it or stop it")
            time.sleep(0.1)
        except OSError as error:
            sys.exit(f"{path}: the file system has no locks ({error}): work in another folder")
    os.set_inheritable(handle, True)  # the command keeps the lock until it ends
    os.execvp(command[0], command)  # noqa: S606


if __name__ == "__main__":
    main()
