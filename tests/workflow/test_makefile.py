"""The lock that `make` holds: a second `make` is refused, one just killed is waited for."""

import fcntl
import json
import re
import subprocess
import threading
from pathlib import Path
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


def test_fuzz_passes_sets_and_scene_to_the_configuration() -> None:
    told = subprocess.run(
        ["make", "-n", "fuzz", "SETS=7", "SCENE=insertion"],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    (given,) = re.findall(r"--config accuracy=(\S+)", told)
    fuzz = {"sets": 7, "scene": "insertion"}
    assert json.loads(given.replace('\\"', '"')) == {"fuzz": fuzz}


@pytest.mark.parametrize(
    ("mounted", "refused"),
    [
        ("nfs4 rw,relatime,vers=4.2,local_lock=none", None),
        ("nfs4 rw,relatime,vers=4.2,local_lock=all", "local_lock=all"),
        ("nfs  rw,relatime,vers=3,nolock,local_lock=all", "local_lock=all, nolock"),
        ("lustre rw,flock", None),
        ("lustre rw,localflock", "localflock"),
        ("ext4 rw,nolock", None),
    ],
)
def test_a_lock_that_other_machines_do_not_see_is_refused(
    mounted: str, refused: str | None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    findmnt = tmp_path / "findmnt"
    findmnt.write_text(f"#!/bin/sh\necho '{mounted}'\n", encoding="utf-8")
    findmnt.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    if refused is None:
        hold.refuse_unsafe(str(tmp_path))
        return
    with pytest.raises(SystemExit, match=f"with {refused}, so that no other machine"):
        hold.refuse_unsafe(str(tmp_path))
