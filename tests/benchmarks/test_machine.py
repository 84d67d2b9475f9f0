"""What the benchmark says of the machine and of the lanes."""

from benchmarks.machine import lane_operations


def test_the_lanes_make_operations_and_their_steps_are_cut_by_switches():
    found = lane_operations(64)
    assert found["useful_gflops"] > 0.0
    # W1 makes six switches, and no more steps between two of them than there are to its end.
    assert 1 / 20 < found["switches_a_step"] < 1.0
