"""The lock that `make` holds: a second `make` is refused, one just killed is waited for."""

import fcntl
import threading
from typing import Any


def test_a_second_make_in_the_same_folder_is_refused(workspace: Any) -> None:
    with (workspace.folder / ".make-study.lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        run = workspace.make("-n")
    assert run.returncode != 0
    assert "another make runs the study in this directory" in run.stderr
    assert not (workspace.folder / "tiny").exists()


def test_a_make_that_is_just_dying_is_waited_for(workspace: Any) -> None:
    lock = (workspace.folder / ".make-study.lock").open("w", encoding="utf-8")
    fcntl.flock(lock, fcntl.LOCK_EX)
    dying = threading.Timer(1.0, lock.close)
    dying.start()
    run = workspace.make("-n", *workspace.DATA)
    dying.join()
    assert run.returncode == 0, run.stdout + run.stderr
