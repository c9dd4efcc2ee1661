"""Asks whether the sensors of recordings agree, and draws what disagrees.

    python3 check_sensors.py VEHICLE.yaml RUN... [--plot FILE.png]
"""

import argparse

import fathom

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("vehicle")
parser.add_argument("runs", nargs="+")
parser.add_argument("--plot", default="check.png")
asked = parser.parse_args()

found = fathom.check(asked.vehicle, asked.runs, progress=fathom.show)
print("\n".join(found["compared"]))
print(found["conclusion"] or "%d findings" % len(found["consistency"]))
for one in found["consistency"]:
    print("%(run)s: %(signal)s against %(reference)s: %(finding)s, %(size)g %(unit)s. %(evidence)s" % one)

try:
    from matplotlib import pyplot
except ImportError:
    print("no plot: matplotlib is not installed")
else:
    names = ["%(signal)s: %(finding)s [%(unit)s]" % one for one in found["consistency"]]
    pyplot.barh(names, [abs(one["size"] or 0.0) for one in found["consistency"]])
    pyplot.tight_layout()
    pyplot.savefig(asked.plot)
    print("plot  " + asked.plot)
