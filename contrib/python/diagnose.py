"""Diagnoses a vehicle from recordings and draws the prediction error before and after.

    python3 diagnose.py VEHICLE.yaml RUN... [--out DIR] [--plot FILE.png]
"""

import argparse

import numpy

import fathom

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("vehicle")
parser.add_argument("runs", nargs="+")
parser.add_argument("--out", default="diagnosis")
parser.add_argument("--threads", default="2")
parser.add_argument("--plot", default="diagnosis.png")
asked = parser.parse_args()

result = fathom.diagnose(asked.vehicle, asked.runs, out=asked.out, threads=asked.threads, progress=fathom.show)
print("%s: %s" % (result["vehicle"], result["verdict"]))
print(result["paragraph"])
for name, number in result["parameters"]["after"].items():
    print("%-8s %10.4g +- %-9.2g %s" % (name, number["value"], number["std"] or numpy.nan, number["unit"]))


def error(when):
    """Horizons [s] and the rms over the axes that are simulated."""
    rows = result["error"][when]["prediction"]
    return ([row["horizon_s"] for row in rows],
            [numpy.sqrt(numpy.mean([e * e for e in row["rmse"].values() if e is not None])) for row in rows])


try:
    from matplotlib import pyplot
except ImportError:
    print("no plot: matplotlib is not installed")
else:
    for when in ("before", "after"):
        pyplot.plot(*error(when), "o-", label=when)
    pyplot.xlabel("horizon [s]")
    pyplot.ylabel("error of prediction [m/s, rad/s]")
    pyplot.legend()
    pyplot.savefig(asked.plot)
    print("plot  " + asked.plot)
