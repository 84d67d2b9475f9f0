"""
A figure redrawn from its dataset
=================================

A netCDF file of the study says by itself what it holds: this script needs nothing of vibralign.
"""

import sys

import matplotlib.pyplot as plt
import xarray

path = sys.argv[1] if len(sys.argv) > 1 else "../results/data/fig06.nc"
with xarray.open_dataset(path) as dataset:
    dataset.load()
family, swept = (dataset[name] for name in dataset["tau_align"].dims)

duration = dataset["tau_align"]

figure, axes = plt.subplots(layout="constrained")
for value in family.values:
    curve = duration.sel({family.name: value})
    axes.plot(swept, curve, ".-", label=f"{family.attrs['symbol']} = {value:g}")
axes.set_title(dataset.attrs["title"], wrap=True)
axes.set_xlabel(f"{swept.attrs['long_name']}, {swept.attrs['symbol']}")
axes.set_ylabel(f"{duration.attrs['long_name'].partition(';')[0]}, {duration.attrs['symbol']}")
axes.legend(title=family.attrs["long_name"])
plt.show()
