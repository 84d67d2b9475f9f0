"""The lock that `make` holds: a second `make` is refused, one just killed is waited for."""

import fcntl
import os
import threading
from typing import Any

import hold
import pytest


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


@pytest.mark.parametrize(
    ("mounted", "refused"),
    [
        ("nfs4 server:/home rw,vers=4.2,local_lock=none", []),
        ("nfs4 server:/home rw,vers=4.2,local_lock=all", ["local_lock=all"]),
        ("nfs server:/home rw,vers=3,nolock", ["nolock"]),
        ("lustre mds:/scratch rw,flock", []),
        ("lustre mds:/scratch rw,localflock", ["localflock"]),
        ("ext4 /dev/sda1 rw,nolock", []),
    ],
)
def test_a_lock_that_other_machines_do_not_see_is_refused(
    mounted: str, refused: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    device = tmp_path.stat().st_dev
    line = f"9 1 {os.major(device)}:{os.minor(device)} / /home rw,relatime - {mounted}\n"
    table = tmp_path / "mountinfo"
    table.write_text(line, encoding="utf-8")
    monkeypatch.setattr(hold, "MOUNTS", table)
    if not refused:
        hold.refuse_unsafe(tmp_path)
        return
    with pytest.raises(SystemExit, match=f"with {', '.join(refused)}, so that no other machine"):
        hold.refuse_unsafe(tmp_path)
