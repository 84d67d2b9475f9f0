"""Input that the commands of the study refuse, and configurations that are no study."""

import errno
import os
from pathlib import Path

import pytest

from study import __main__ as cli
from study.config import ConfigError, check_study, load_study, read_study, study_path
from tests.vibralign.commands.test_bad_input import is_refused, root

__all__ = ["root"]

# The command line, and what the one line that refuses it must hold. ROOT is an empty folder.
LINES = [
    (["claims", "--root", "ROOT"], ["ROOT", "holds no claims"]),
    (["runs", "--root", "ROOT/nowhere"], ["nowhere"]),
    (["runs", "--root", "ROOT", "--figure", "6"], ["ROOT", "build the study first"]),
    (["runs", "--root", "ROOT", "--figure", "fig77"], ["unknown figure 'fig77'"]),
    (["runs", "--root", "ROOT", "--figure", "6", "--starts"], ["--figure", "runs"]),
    (["runs", "--root", "ROOT", "--outcome", "don"], ["Did you mean 'done'?"]),
    (["runs", "--root", "ROOT", "--starts"], ["ROOT", "build the study first"]),
    (["show", "--root", "ROOT/nowhere", "last"], ["nowhere"]),
    (["diff", "other", "ROOT"], ["other: is no results folder"]),
    (["diff", "ROOT", "ROOT"], ["ROOT: holds no records"]),
    (["diff", "ROOT"], ["B"]),
    (["verify", "--root", "ROOT/nowhere"], ["nowhere", "make smoke"]),
    (["verify", "--root", "ROOT", "--figure", "0"], ["fig00"]),
    (["accept", "--root", "ROOT"], ["--reason"]),
    (["accept", "--root", "ROOT", "--reason", "so"], ["name what to accept: --figure"]),
    (["accept", "--root", "ROOT", "--reason", "", "--figure", "6"], ["reason", "words"]),
]


@pytest.mark.parametrize(("line", "words"), LINES, ids=[" ".join(line) for line, _ in LINES])
def test_a_command_line(capsys, monkeypatch, root, line, words):
    monkeypatch.chdir(root)
    is_refused(cli.main, capsys, root, line, words)


@pytest.mark.parametrize("command", [["runs"], ["show", "last"]])
def test_a_folder_that_may_not_be_read(capsys, monkeypatch, root, command):
    # Not by chmod: root, whom containers run as, may read everywhere.
    def denied(path, *_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    monkeypatch.setattr(Path, "is_dir", denied)
    assert cli.main([*command, "--root", str(root)]) == cli.FAILED
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert str(root) in err
    assert "allow access to it or choose another place" in err


CONFIGURATIONS = {
    "nothing": b"",
    "a number": b"42\n",
    "half of it": None,
    "a bracket left open": b"figures: {fig06: [1, 2\n",
    "tabs": b"figures:\n\tfig06: 1\n",
    "a picture": b"\x89PNG\r\n\x1a\n\x00\x00",
    "a Python object": b"figures: !!python/object/apply:os.getcwd []\n",
    "a key of two": b"? [a, b]\n: 1\n",
}


@pytest.mark.parametrize("content", CONFIGURATIONS.values(), ids=list(CONFIGURATIONS))
def test_a_configuration(tmp_path, content):
    path = tmp_path / "config.yaml"
    whole = study_path().read_bytes()
    path.write_bytes(whole[: len(whole) // 2] if content is None else content)
    with pytest.raises(ConfigError) as refusal:
        load_study(path)
    assert str(path) in str(refusal.value)


@pytest.mark.parametrize("name", ["", "nowhere/config.yaml"])
def test_a_configuration_that_is_not_there_or_a_folder(tmp_path, name):
    with pytest.raises(ConfigError, match="cannot be read"):
        load_study(tmp_path / name)


def test_text_in_place_of_a_number_is_refused_with_the_remedy():
    stated = read_study(study_path())
    stated["figures"]["fig06"]["swept"]["count"] = "60"  # as Snakemake's --config states it
    with pytest.raises(ConfigError) as refusal:
        check_study(stated)
    assert "figures.fig06.swept.count = '60': is text, must be a number" in str(refusal.value)
    assert "--configfile FILE" in str(refusal.value)
