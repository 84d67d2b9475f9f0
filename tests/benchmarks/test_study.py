"""The study against its graph with empty jobs: what is printed of the jobs."""

from benchmarks.study import by_rule


def test_seconds_of_jobs_are_summed_by_rule_the_longest_first(tmp_path):
    lines = ["run,rule,wall_seconds", "a/0,a,1.5", "b,b,4", "a/1,a,2.0", "c,c,"]
    (tmp_path / "runs.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    found = by_rule(tmp_path)
    assert [line.split() for line in found] == [
        ["4.0", "s", "b", "(1)"],
        ["3.5", "s", "a", "(2)"],
        ["0.0", "s", "c", "(1)"],
    ]
