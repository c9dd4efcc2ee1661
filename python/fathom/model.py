"""An identified model: its accelerations and its flights."""

import hashlib
import json
import os
import warnings
from collections import namedtuple

import numpy

from fathom._model import Flyer

AXES = ("u", "v", "w", "p", "q", "r")

# t [s]; position [m] in W; attitude [rad] roll, pitch, yaw; nu [m/s, rad/s] u v w p q r
Flight = namedtuple("Flight", "t position attitude nu")


def _rows(value, width, rows):
    array = numpy.asarray(value, dtype=float)
    if array.ndim == 1 and width == 1:
        array = array[:, None]
    return numpy.ascontiguousarray(numpy.broadcast_to(array, (rows, width)))


class Model:
    """A vehicle with numbers. `vehicle`: its file; `result`: result.json of a diagnosis, or its folder; without one,
    the file's priors. `wrench`: the forces are X Y Z K M N at Bo, not thrusters (the vehicle has none, or the recording
    tells the wrench alone).

    parameters: base parameters by name, SI. effects: those that act. unflown: what the result holds and this cannot
    fly, in words. thrusters: their names, the order of `force`. axes: those that are simulated.
    """

    def __init__(self, vehicle, result=None, wrench=False):
        path, effects = "", []
        if result is not None:
            path = os.fspath(result)
            if os.path.isdir(path):
                path = os.path.join(path, "result.json")
            with open(path, encoding="utf-8") as file:
                data = json.load(file)
            for one in data.get("effects", []):
                if one["accepted"]:
                    numbers = [(name, number["value"]) for name, number in one["parameters"].items()]
                    effects.append((one["name"], one["variant"], numbers))
        self._flyer = Flyer(os.fspath(vehicle), wrench, path, effects)
        self.name = self._flyer.name
        self.parameters = self._flyer.parameters
        self.effects = self._flyer.effects
        self.unflown = self._flyer.unflown
        self.thrusters = self._flyer.thrusters
        self.axes = [axis for axis, free in zip(AXES, self._flyer.dof) if free]
        for words in self.unflown:
            warnings.warn("not flown: " + words, stacklevel=2)

    def __repr__(self):
        return "<model of %s%s>" % (self.name, " with " + ", ".join(self.effects) if self.effects else "")

    def thrust(self, pwm_us, voltage=0.0):
        """Forces [N], (n, thrusters), of commands [us] by the vehicle file's curve; voltage [V], 0: unknown."""
        pwm = numpy.ascontiguousarray(numpy.atleast_2d(numpy.asarray(pwm_us, dtype=float)))
        return self._flyer.thrust(pwm, _rows(voltage, 1, len(pwm)))

    def acceleration(self, nu, force, *, attitude=0.0, position=0.0, t=0.0, voltage=0.0):
        """nu_dot [m/s^2, rad/s^2], (n, 6), of motions nu (n, 6) under forces [N] (n, thrusters). Attitude [rad] is roll,
        pitch, yaw; position [m] in W; each a row for all, or a row per motion. Effects with a memory are settled."""
        nu = numpy.ascontiguousarray(numpy.atleast_2d(numpy.asarray(nu, dtype=float)))
        n = len(nu)
        return self._flyer.acceleration(_rows(t, 1, n), _rows(position, 3, n), _rows(attitude, 3, n), nu,
                                        _rows(force, self._flyer.actuators, n), _rows(voltage, 1, n))

    def fly(self, t, force, *, position=(0, 0, 0), attitude=(0, 0, 0), nu=(0, 0, 0, 0, 0, 0), voltage=0.0):
        """The open-loop motion from a start, at the times t [s], equally far apart; between them forces go along
        straight lines. Axes that the vehicle file leaves out rest. Gives a Flight."""
        t = numpy.asarray(t, dtype=float)
        if t.ndim != 1 or len(t) < 2:
            raise ValueError("t: two times at least are needed")
        dt = (t[-1] - t[0]) / (len(t) - 1)
        if not numpy.allclose(numpy.diff(t), dt, rtol=1e-3, atol=0.0):
            raise ValueError("t: times must be equally far apart; interpolate the forces first")
        flown = self._flyer.fly(t[0], dt, _rows(position, 3, 1), _rows(attitude, 3, 1), _rows(nu, 6, 1),
                                _rows(force, self._flyer.actuators, len(t)), _rows(voltage, 1, len(t)))
        return Flight(t, *flown)


def load_model(result, vehicle=None, wrench=False):
    """The model of a diagnosis (result.json or its folder). `vehicle`: its file; without, the one that was diagnosed."""
    path = os.fspath(result)
    if os.path.isdir(path):
        path = os.path.join(path, "result.json")
    with open(path, encoding="utf-8") as file:
        files = json.load(file).get("files", [])
    listed = next((one for one in files if one["role"] == "vehicle"), None)
    if vehicle is None and listed is None:
        raise ValueError("%s: does not say which vehicle file it rests on; give it as `vehicle`" % path)
    vehicle = vehicle if vehicle is not None else listed["path"]
    if not os.path.exists(vehicle):
        raise ValueError("%s: is not there any more; give the vehicle's file as `vehicle`" % vehicle)
    if listed is not None:
        with open(vehicle, "rb") as file:
            if hashlib.sha256(file.read()).hexdigest() != listed["sha256"]:
                warnings.warn("%s is not what the diagnosis read: it is taken as it is now" % vehicle, stacklevel=2)
    return Model(vehicle, path, wrench)
