"""Reads result.json of `fathom diagnose` and `fathom trial` (docs/schema). Needs numpy alone.

    import fathom_result
    r = fathom_result.load("out/result.json")
    r.verdict, r["paragraph"]
    r.parameters["X_u"].value            # SI units; .std, .unit, .interval (95 %)
    names, P = r.covariance()            # P: numpy, in the units of the names' product
    error = r.error("after", "rmse")     # numpy, horizons x (u v w p q r); NaN where an axis is not simulated

`python3 fathom_result.py RESULT.json` prints what the file says.
"""

import json
import sys
from collections import namedtuple

import numpy

SCHEMAS = (1, 2)  # versions of docs/schema that this module reads
AXES = ("u", "v", "w", "p", "q", "r")

Number = namedtuple("Number", "value std unit interval")


def _real(value):
    """null of the file is no number."""
    return float("nan") if value is None else float(value)


def _numbers(values):
    numbers = {}
    for name, v in values.items():
        interval = v.get("interval_95", (None, None))
        numbers[name] = Number(_real(v["value"]), _real(v["std"]), v["unit"], tuple(_real(x) for x in interval))
    return numbers


class Result:
    """A file's content, `data` as json gives it, and the parts that one computes with as numpy arrays."""

    def __init__(self, data):
        if data.get("schema") not in SCHEMAS:
            raise ValueError("schema %r: this reader knows %s; take the one that came with the program" %
                             (data.get("schema"), " and ".join(map(str, SCHEMAS))))
        self.data = data
        self.kind = data.get("kind", "diagnosis")
        live = self.kind == "live trial"
        self.verdict = data["diagnosis"]["verdict"] if live else data["verdict"]
        self.parameters = _numbers(data["parameters"] if live else data["parameters"]["after"])
        self.effects = {}
        for effect in data.get("effects", []):
            if effect["accepted"]:
                self.effects[effect["name"]] = _numbers(effect["parameters"])
        self.stand_ins = {}  # of the model as well, without a claim of a cause
        for one in data.get("stand_ins", []):
            if one["in_model"]:
                self.stand_ins[one["name"]] = _numbers(one["parameters"])

    def __getitem__(self, key):
        return self.data[key]

    def covariance(self):
        """Names and matrix; None where the file has none."""
        given = self.data.get("covariance")
        if given is None:
            return None
        matrix = numpy.array([[_real(x) for x in row] for row in given["matrix"]])
        return given["names"], matrix

    def horizons(self):
        """s."""
        return numpy.array([p["horizon_s"] for p in self.data["error"]["after"]["prediction"]], dtype=float)

    def error(self, when="after", what="rmse"):
        """Predictions "before" or "after": "rmse" (m/s, rad/s) or "r2"; a row per horizon."""
        rows = self.data["error"][when]["prediction"]
        return numpy.array([[_real(p[what][axis]) for axis in AXES] for p in rows])


def load(path):
    with open(path, encoding="utf-8") as file:
        return Result(json.load(file))


def main(path):
    result = load(path)
    print("%s: %s" % (result["vehicle"], result.verdict))
    if result.data.get("paragraph"):
        print(result["paragraph"])
    groups = [("", result.parameters)] + [(name + ".", numbers) for name, numbers in result.effects.items()]
    for prefix, numbers in groups:
        for name, n in numbers.items():
            print("%-32s %12.5g +- %-10.3g %s" % (prefix + name, n.value, n.std, n.unit))
    covariance = result.covariance()
    if covariance is not None:
        names, matrix = covariance
        sigma = numpy.sqrt(numpy.diag(matrix))
        with numpy.errstate(divide="ignore", invalid="ignore"):
            correlation = matrix / numpy.outer(sigma, sigma)
        numpy.fill_diagonal(correlation, 0.0)
        i, j = numpy.unravel_index(numpy.nanargmax(numpy.abs(correlation)), correlation.shape)
        print("strongest correlation: %.3f of %s and %s" % (correlation[i, j], names[i], names[j]))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: fathom_result.py RESULT.json")
    try:
        main(sys.argv[1])
    except (OSError, ValueError, KeyError) as error:
        sys.exit("%s: %s" % (sys.argv[1], error))
