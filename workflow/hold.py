"""Run a command holding a lock on a file: ``python workflow/hold.py wait|refuse FILE COMMAND...``.

The system drops the lock with the process that holds it, however that dies. Only the standard
library is needed, which has flock everywhere; the command of that name is missing on some systems.
"""

import fcntl
import os
import sys
import time

mode, path, *command = sys.argv[1:]
handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
patience = time.monotonic() + 5  # a process that was just killed may still hold it for a moment
while True:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (fcntl.LOCK_NB if mode == "refuse" else 0))
        break
    except BlockingIOError:
        if time.monotonic() > patience:
            sys.exit("another make runs the study in this directory; wait for it or stop it")
        time.sleep(0.1)
os.set_inheritable(handle, True)  # the command keeps the lock until it ends
os.execvp(command[0], command)  # noqa: S606
