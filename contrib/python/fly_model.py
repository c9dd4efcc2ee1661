"""Flies an identified model: ten seconds ahead and ten seconds coasting, and its acceleration at the start.

    python3 fly_model.py DIAGNOSIS [--vehicle VEHICLE.yaml] [--plot FILE.png]
"""

import argparse

import numpy

import fathom

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("result", help="result.json or its folder")
parser.add_argument("--vehicle", help="without: the file that was diagnosed")
parser.add_argument("--wrench", action="store_true", help="the recordings told the wrench, not thrusters")
parser.add_argument("--plot", default="flight.png")
asked = parser.parse_args()

model = fathom.load_model(asked.result, asked.vehicle, asked.wrench)
print(model, "simulated:", " ".join(model.axes))

t = numpy.linspace(0.0, 20.0, 401)
count = len(model.thrusters) if model.thrusters and not asked.wrench else 6
force = numpy.zeros((len(t), count))
force[t < 10.0, 0] = 5.0  # N: the first thruster, or X

print("at rest:", model.acceleration(numpy.zeros(6), force[0])[0], "m/s^2, rad/s^2")
flight = model.fly(t, force)
print("after %.0f s: at %s m, %.3f m/s" % (t[-1], flight.position[-1].round(3), numpy.linalg.norm(flight.nu[-1, :3])))

try:
    from matplotlib import pyplot
except ImportError:
    print("no plot: matplotlib is not installed")
else:
    pyplot.plot(flight.t, flight.nu, label=["u", "v", "w", "p", "q", "r"])
    pyplot.xlabel("t [s]")
    pyplot.ylabel("velocity [m/s, rad/s]")
    pyplot.legend()
    pyplot.savefig(asked.plot)
    print("plot  " + asked.plot)
