"""
A device known in part
======================

Friction and tilt stiffness of a peg are known as ranges. Left: it is reliable for a part of what is
possible. Right: what six trials of a made-up bench leave possible, darker where more likely.
"""

import matplotlib.pyplot as plt

from vibralign import calibrate, known_in_part, load_device

device = load_device("bench.yaml")
possible = known_in_part(device, sets=256, touch_downs_tried=16)
for each in possible.unknowns:
    print(f"{each.name}: decides {each.share:.2f}, measuring it is worth {each.worth:.2f}")

trials = [
    {"press_force": "10 N", "amplitude": "2 mm", "result": "80 ms"},
    {"press_force": "14 N", "amplitude": "2 mm", "result": "46 ms"},
    {"press_force": "8 N", "amplitude": "2.5 mm", "result": "70 ms"},
    {"press_force": "4 N", "amplitude": "1.2 mm", "result": "190 ± 10 ms"},
    {"press_force": "12 N", "amplitude": "3 mm", "result": "68 ms"},
    {"press_force": "7 N", "amplitude": "1.5 mm", "result": "> 50 ms"},
]
found = calibrate(device, trials, touch_downs_tried=8)
print(f"the model fits: {found.fit.fits}, {found.intervals()}")

figure, (before, after) = plt.subplots(1, 2, figsize=(9, 4), sharey=True, layout="constrained")
for verdict, mark, name in ((True, "o", "reliable"), (False, "x", "not reliable")):
    some = possible.reliable == verdict
    sets = {name: values[some] for name, values in possible.sets.items()}
    before.plot(sets["friction"], sets["tilt_stiffness"], mark, label=name)
before.set(xlabel="friction", ylabel="tilt stiffness (N m/rad)", title="possible")
before.legend()
weights = found.samples.weights / found.samples.weights.max()
after.scatter(found.sets["friction"], found.sets["tilt_stiffness"], alpha=weights, color="C0")
after.set(xlabel="friction", title="after six trials")
plt.show()
