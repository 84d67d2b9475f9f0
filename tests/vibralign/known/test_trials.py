"""Tables of trials: what is read, and a clear word for what cannot be."""

import math

import pytest

from tests.vibralign.known.test_ranges import device_file
from vibralign import load_device
from vibralign.known.trials import distrusted, notes_on, read_trials

TABLE = """frequency,press_force,misalignment,result,note
60 Hz,0.20 N,0.5 ± 0.1 mm,91.6 ms,
60 Hz,0.30 N,,fails,by hand

100 Hz,,,fails after 2 s,
100 Hz,0.15 N,,> 500 ms,
100 Hz,0.15 N,,91.6 ± 5 ms,
"""


def read(folder, text: str):
    path = folder / "trials.csv"
    path.write_bytes(text.encode())
    return read_trials(load_device(device_file(folder)), path)


def test_every_kind_of_cell_is_read(tmp_path):
    one, two, three, four, five = read(tmp_path, TABLE)
    assert [each.row for each in (one, two, three, four, five)] == [2, 3, 5, 6, 7]
    assert (one.time, one.waited) == (pytest.approx(0.0916), None)
    assert one.device.quantities["frequency"] == 60.0
    assert one.device.tolerances["misalignment"].width == pytest.approx(1e-4)
    assert one.device.unknown.keys() == {"friction", "lateral_stiffness"}
    assert (two.time, two.waited) == (None, None)
    assert two.device.quantities["misalignment"] == pytest.approx(6e-4)  # as in the file
    assert (three.waited, four.waited) == (2.0, 0.5)
    assert five.error == pytest.approx(5.0 / 91.6)


# The same trials, as spreadsheets of other countries save them, and as rows.
SAVED = [
    "\ufefffrequency [Hz];press_force [N];result [ms]\r\n60;0,2;91,6\r\n60;0,3;fails after 2000",
    "frequency [Hz]\tpress_force [N]\tresult [ms]\n60\t0.2\t91.6\n60\t0.3\tfails after 2000\n",
    "frequency,press_force (mN),result\n60 Hz,200,91.6 ms\n60 Hz,300,fails after 2 s\n",
]


@pytest.mark.parametrize("text", SAVED)
def test_tables_of_any_spreadsheet_are_alike(tmp_path, text):
    one, two = read(tmp_path, text)
    assert one.time == pytest.approx(0.0916)
    assert one.device.quantities["press_force"] == pytest.approx(0.2)
    assert two.waited == pytest.approx(2.0)
    rows = [{"press_force": 0.2, "result": "91.6 ms"}, {"press_force": None, "result": "fails"},
            {"amplitude": "1 mm", "result": "fails"}]  # fmt: skip
    first, second, third = read_trials(load_device(device_file(tmp_path)), rows)
    assert first.device.quantities["press_force"] == 0.2
    assert (second.setting, second.row) == ({}, 2)
    assert third.setting == {"amplitude": "1 mm"}, "a column that the first row has not"


HEAD = "frequency,press_force,result\n"
FINE = "60 Hz,0.2 N,91.6 ms\n"
REFUSED = [
    ("frequency,preis,result\n" + FINE, ["row 1: ", "'preis'", "remarks `note`"]),
    (HEAD + FINE + "60 Hz,0.2 N,60\n", ["row 3", "has no unit", "60 ms", "`result [ms]`"]),
    ("frequency,result,result\n" + FINE, ["two columns `result`"]),
    ("frequency,press_force\n60 Hz,0.2 N\n", ["no column `result`", "press_force"]),
    ("friction,press_force,result\n0.1,0.2 N,91 ms\n", ["`friction`: is unknown"]),
    ("press_force [mm],result\n1,90 ms\n", ["row 1: column head 'press_force [mm]': must be in N"]),
    ("press_force,result [N]\n1 N,9\n", ["row 1: column head 'result [N]': must be in s", "in N"]),
    ("press_force [x],result\n1,9 ms\n", ["row 1: column head 'press_force [x]': unknown unit"]),
    (HEAD + "60 mm,0.2 N,91.6 ms\n", ["row 2", "frequency = '60 mm'"]),
    (HEAD + FINE + "60 Hz,0.2 N,quick\n", ["row 3", "result = 'quick'", "fails after 2 s"]),
    (HEAD + FINE + "60 Hz,0.2 N,\n", ["row 3", "result is blank"]),
    (HEAD + FINE + "60 Hz,0.2 N,-3 ms\n", ["row 3", "finite time > 0"]),
    (HEAD + FINE + "60 Hz,-1 N,9 ms\n", ["row 3", "press_force = -1.0"]),
    (HEAD + FINE + "60 Hz,05.Mrz,9 ms\n", ["row 3", "'05.Mrz'", "unknown unit 'Mrz'"]),
    (HEAD + FINE + "60 Hz,01.02.2026,9 ms\n", ["row 3", "must be a number"]),
    (HEAD + '60 Hz,"0,2 N",91.6 ms\n', ["row 2", "'0,2 N'", "semicolons"]),
    (HEAD + "60 Hz,0,2 N,91.6 ms\n", ["row 2", "4 cells under 3 heads", "decimal comma"]),
    ("press_force;result\n0,2 N;91.6 ms\n", ["decimal commas and decimal points"]),
    (HEAD + FINE, ["1 trials", "at least 2"]),
    (HEAD, ["0 trials"]),
    ("", ["is empty"]),
]


@pytest.mark.parametrize(("text", "words"), REFUSED)
def test_bad_tables_are_refused_with_row_and_cell(tmp_path, text, words):
    with pytest.raises(ValueError, match=r"trials\.csv") as refusal:
        read(tmp_path, text)
    assert all(each in str(refusal.value) for each in words), refusal.value


def test_a_bad_head_of_rows_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"trials: columns: column head 'mass \[N\]'"):
        read_trials(load_device(device_file(tmp_path)), [{"mass [N]": "1", "result": "1 ms"}])


def test_tables_that_tell_little_are_noted(tmp_path):
    alike = read(tmp_path, HEAD + "60 Hz,0.2 N,fails\n" * 2)
    assert len(notes_on(alike, 2)) == 3
    assert notes_on(read(tmp_path, TABLE), 2) == []
    assert math.isclose(alike[0].error, 0.05)


def test_trials_on_a_base_too_soft_for_the_model_are_noted(tmp_path):
    trials = read(tmp_path, TABLE)
    assert distrusted(trials, {}) == []
    first, more = distrusted(trials, {"contact_stiffness": 1e4})
    assert first.startswith("row 2 (frequency = 60 Hz")
    assert "do not trust the verdict" in first
    assert more == "the same holds for 4 more trials"
