"""The Python module as a user has it: run by python_test.cpp, with the folder of its files as the only argument."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import unittest
import warnings

import numpy

import fathom

SOURCE = pathlib.Path(__file__).resolve().parents[3]
FOLDER = pathlib.Path(sys.argv.pop(1))
HEAVY = SOURCE / "config/vehicles/bluerov2_heavy.yaml"


def against_schema(data, name):
    """What the validator objects to; nothing where there is no validator."""
    try:
        import jsonschema
    except ImportError:
        return []
    schema = json.loads((SOURCE / "docs/schema" / (name + ".schema.json")).read_text())
    return [error.message for error in jsonschema.Draft202012Validator(schema).iter_errors(data)]


def rotation(attitude):
    (cr, cp, cy), (sr, sp, sy) = numpy.cos(attitude), numpy.sin(attitude)
    return numpy.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], [-sp, cp * sr, cp * cr]])


def turning(attitude, rates):
    """Derivatives of roll, pitch, yaw [rad/s] (Fossen 2011, eq. 2.28)."""
    r, p, _ = attitude
    return numpy.array([[1, numpy.sin(r) * numpy.tan(p), numpy.cos(r) * numpy.tan(p)], [0, numpy.cos(r), -numpy.sin(r)],
                        [0, numpy.sin(r) / numpy.cos(p), numpy.cos(r) / numpy.cos(p)]]) @ rates


def made_up_result(folder, vehicle, effects=()):
    """A result.json with the vehicle file's own numbers and these effects."""
    numbers = {name: {"value": value} for name, value in vehicle.parameters.items() if value != 0.0}
    folder.mkdir(exist_ok=True)
    (folder / "result.json").write_text(json.dumps({
        "fathom_version": "test", "vehicle": vehicle.name, "parameters": {"after": numbers}, "effects": list(effects)}))
    return folder


def effect(name, variant, **numbers):
    return {"name": name, "variant": variant, "accepted": True, "acts_last": False,
            "parameters": {key: {"value": value} for key, value in numbers.items()}}


class Recordings(unittest.TestCase):
    def test_a_table_and_the_log_made_of_it_are_the_same_arrays(self):
        table = numpy.genfromtxt(FOLDER / "DIVE.csv", delimiter=",", names=True)
        for name in ("DIVE.csv", "RUN.lcmlog"):
            run = fathom.open(FOLDER / name)
            pose = run["POSE_CAPTURE"]
            self.assertEqual(pose["p_WB"].shape, (len(table), 3))
            numpy.testing.assert_array_equal(pose["p_WB"][:, 0], table["x"])
            self.assertEqual(pose.unit["p_WB"], "m")
            self.assertEqual(pose["utime"].dtype, numpy.int64)
            self.assertEqual(len(pose.t), len(table))
            self.assertEqual(run.begin_us, min(one["utime"][0] for one in run.values()))

    def test_channels_can_be_chosen_and_a_wrong_one_is_named(self):
        self.assertEqual(list(fathom.open(FOLDER / "RUN.lcmlog", channels=["THRUSTERS"])), ["THRUSTERS"])
        with self.assertRaisesRegex(fathom.Error, "has no channel SONAR; it has .*THRUSTERS"):
            fathom.open(FOLDER / "RUN.lcmlog", channels=["SONAR"])
        with self.assertRaisesRegex(fathom.Error, "no such file"):
            fathom.open(FOLDER / "nothing.lcmlog")


class Models(unittest.TestCase):
    def setUp(self):
        self.model = fathom.Model(HEAVY)

    def test_a_flight_is_the_integral_of_its_accelerations(self):
        t = numpy.linspace(0.0, 8.0, 161)
        force = 4.0 * numpy.sin(numpy.outer(t, 0.3 + 0.1 * numpy.arange(len(self.model.thrusters))))
        start = {"position": (1.0, -2.0, 3.0), "attitude": (0.05, -0.1, 0.8), "nu": (0.2, 0.1, 0.0, 0.0, 0.05, 0.1)}
        flight = self.model.fly(t, force, **start)

        def slope(time, state):
            f = [numpy.interp(time, t, column) for column in force.T]
            nu_dot = self.model.acceleration(state[6:], f, position=state[:3], attitude=state[3:6], t=time)[0]
            return numpy.concatenate([rotation(state[3:6]) @ state[6:9], turning(state[3:6], state[9:]), nu_dot])

        state, h = numpy.concatenate(list(start.values())), 0.02
        for k in range(400):  # Runge-Kutta of fourth order
            a = slope(k * h, state)
            b = slope((k + 0.5) * h, state + 0.5 * h * a)
            c = slope((k + 0.5) * h, state + 0.5 * h * b)
            state = state + h / 6.0 * (a + 2 * b + 2 * c + slope((k + 1) * h, state + h * c))
        # Ours is of second order with steps of 5 to 50 ms: a thousandth of what has been moved.
        numpy.testing.assert_allclose(flight.position[-1], state[:3], atol=2e-3)
        numpy.testing.assert_allclose(flight.attitude[-1], state[3:6], atol=2e-3)
        numpy.testing.assert_allclose(flight.nu[-1], state[6:], atol=2e-3)
        self.assertGreater(numpy.linalg.norm(flight.position[-1] - flight.position[0]), 0.5)

    def test_acceleration_is_force_over_mass(self):
        p = self.model.parameters
        force = numpy.zeros(len(self.model.thrusters))
        still = self.model.acceleration(numpy.zeros(6), force)[0]
        ahead = self.model.acceleration([[1.0, 0, 0, 0, 0, 0]], force)[0]
        self.assertAlmostEqual(ahead[0] - still[0], (p["X_u"] + p["X_u|u|"]) / p["m_X"], places=12)

    def test_what_a_diagnosis_found_acts(self):
        name = self.model.thrusters[0]
        result = made_up_result(FOLDER / "made_up", self.model, [
            effect("thruster_gain", name, gain_change=-0.25), effect("sensor_latency", "velocity", latency=0.1)])
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            found = fathom.load_model(result, HEAVY)
        self.assertEqual(found.effects, ["thruster_gain"])
        self.assertEqual(found.unflown, ["sensor_latency (velocity): belongs to a sensor, not to the vehicle"])
        self.assertIn("not flown: sensor_latency", str(said[0].message))
        force = numpy.full(len(self.model.thrusters), 6.0)
        weak = force.copy()
        weak[0] *= 0.75
        numpy.testing.assert_allclose(found.acceleration(numpy.zeros(6), force),
                                      self.model.acceleration(numpy.zeros(6), weak), rtol=1e-14)

    def test_bad_input_is_one_line(self):
        for call, words in [(lambda: self.model.fly([0, 1, 3], numpy.zeros((3, 8))), "equally far apart"),
                            (lambda: self.model.acceleration(numpy.zeros(6), numpy.full(8, numpy.nan)), "no number"),
                            (lambda: self.model.fly([0, 60], numpy.full((2, 8), 1e9)), "diverges"),
                            (lambda: fathom.Model(FOLDER / "none.yaml"), "none.yaml")]:
            with self.assertRaisesRegex(ValueError, words):
                call()
        with self.assertRaisesRegex(ValueError, "not of"):
            made_up_result(FOLDER / "other", self.model)
            fathom.Model(SOURCE / "config/vehicles/bluerov2.yaml", FOLDER / "other")


class Programs(unittest.TestCase):
    def test_check_and_diagnose_give_what_the_schemas_say(self):
        found = fathom.check(FOLDER / "V.yaml", FOLDER / "RUN.lcmlog")
        self.assertEqual(against_schema(found, "check-1"), [])
        self.assertEqual(found["vehicle"], "Sled")
        self.assertTrue(found["conclusion"] or found["consistency"])
        result = fathom.diagnose(FOLDER / "V.yaml", FOLDER / "RUN.lcmlog", out=FOLDER / "DIAGNOSIS", threads=1)
        self.assertEqual(against_schema(result, "diagnosis-2"), [])
        self.assertEqual(result, json.loads((FOLDER / "DIAGNOSIS/result.json").read_text()))
        example("fly_model.py", FOLDER / "DIAGNOSIS", "--wrench", words="after 20 s")

    def test_a_refusal_is_the_programs_own_line(self):
        with self.assertRaisesRegex(fathom.Error, "none.yaml: cannot read"):
            fathom.diagnose(FOLDER / "none.yaml", FOLDER / "RUN.lcmlog")

    def test_ctrl_c_ends_the_program_too(self):
        sleeper = FOLDER / "sleeper"
        sleeper.write_text("#!/bin/sh\necho $$ >&2\nexec sleep 600\n")
        sleeper.chmod(0o755)
        os.environ["FATHOM_PROGRAM"] = str(sleeper)
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
        started = []

        def interrupt(line):
            started.append(int(line))
            os.kill(os.getpid(), signal.SIGINT)

        try:
            with self.assertRaises(KeyboardInterrupt):
                fathom.diagnose("V.yaml", "RUN.lcmlog", progress=interrupt)
        finally:
            del os.environ["FATHOM_PROGRAM"]
        with self.assertRaises(ProcessLookupError):
            os.kill(started[0], 0)


def example(name, *arguments, words):
    plot = FOLDER / (name + ".png")
    ran = subprocess.run([sys.executable, SOURCE / "contrib/python" / name, *arguments, "--plot", plot],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if ran.returncode != 0 or words not in ran.stdout:
        raise AssertionError("%s: %s" % (name, ran.stdout))
    if not plot.exists() and "no plot: matplotlib" not in ran.stdout:
        raise AssertionError("%s has drawn nothing: %s" % (name, ran.stdout))


class Examples(unittest.TestCase):  # fly_model.py: above
    def test_open_recording(self):
        example("open_recording.py", FOLDER / "RUN.lcmlog", "POSE_CAPTURE", "p_WB", words="POSE_CAPTURE.p_WB [m]: mean")

    def test_check_sensors(self):
        example("check_sensors.py", FOLDER / "V.yaml", FOLDER / "RUN.lcmlog", words="")

    def test_diagnose(self):
        example("diagnose.py", FOLDER / "V.yaml", FOLDER / "RUN.lcmlog", "--out", FOLDER / "D2", words="Sled: ")


unittest.main(verbosity=1)
