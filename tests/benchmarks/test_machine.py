"""What the benchmark says of the machine and of the lanes."""

from benchmarks.machine import Counted, lane_operations, rate_operations, step_operations


def test_operations_are_counted():
    number = Counted()
    Counted.made = 0
    _ = -(2.0 * number + number) / 3.0 - 1.0
    assert Counted.made == 5


def test_a_right_hand_side_takes_what_its_terms_say():
    # Some fifty of the contact and the accelerations, twice a sine with its cosine.
    assert 130 <= rate_operations() <= 200
    # Twelve stages with 4 to 12 terms, of six components.
    assert 6 * 2 * 60 <= step_operations() <= 6 * 2 * 250


def test_shares_of_the_lanes_add_up():
    found = lane_operations(64)
    assert found["useful_gflops"] > 0.0
    lost = found["evaluations_rejected_share"], found["evaluations_at_switches_share"]
    assert all(0.0 < share < 0.5 for share in lost)
