"""Runs the program `fathom`: its progress goes to a function, its errors are exceptions, Ctrl-C ends it."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

_PATIENCE = 10  # s, in which the program ends when it is asked to


class Error(Exception):
    """What the program said when it refused."""


def program():
    """Path of `fathom`."""
    named = os.environ.get("FATHOM_PROGRAM")
    if named:
        return named
    here = pathlib.Path(__file__).resolve().parent
    # A build folder's bin beside its python, a prefix's bin above its lib/python3/dist-packages.
    for above in [here.parents[1], *here.parents[3:4]]:
        if (above / "bin" / "fathom").is_file():
            return str(above / "bin" / "fathom")
    found = shutil.which("fathom")
    if found is None:
        raise Error("the program fathom is not in PATH; install it, or name it in FATHOM_PROGRAM")
    return found


def show(line):
    """A progress function: one line on stderr, rewritten."""
    sys.stderr.write("\r\033[K" + line[:78])
    sys.stderr.flush()


def _end(process):
    process.terminate()  # what runs behind a notebook may have been started with SIGINT ignored
    try:
        process.wait(_PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def run(arguments, progress=None):
    """Runs `fathom ARGUMENTS`; gives what it printed. `progress` is called with each line that it says meanwhile."""
    said = []
    with tempfile.TemporaryFile("w+") as printed:
        process = subprocess.Popen([program(), *arguments], stdin=subprocess.DEVNULL, stdout=printed,
                                   stderr=subprocess.PIPE, text=True, errors="replace")
        try:
            for line in process.stderr:
                said.append(line.rstrip("\n"))
                if progress is not None:
                    progress(said[-1])
            code = process.wait()
        except BaseException:  # Ctrl-C above all: nothing goes on behind the caller's back
            _end(process)
            raise
        finally:
            process.stderr.close()
        if code != 0:
            last = [line for line in said if line.strip()]
            raise Error(last[-1] if last else "fathom %s ended with %d" % (arguments[0], code))
        printed.seek(0)
        return printed.read()


def _paths(value):
    return [os.fspath(value)] if isinstance(value, (str, os.PathLike)) else [os.fspath(one) for one in value]


def _options(options):
    """{"time_budget": 60, "no_learning": True} as words of a command line; None and False are left out."""
    words = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is True:
            continue
        if isinstance(value, (list, tuple)):
            words.extend(str(one) for one in value)
        else:
            words.append(os.fspath(value) if isinstance(value, os.PathLike) else str(value))
    return words


def check(vehicle, runs, *, map=None, site=None, progress=None):
    """Do the sensors of these recordings agree? A dictionary as docs/schema/check-1.schema.json describes it."""
    with tempfile.TemporaryDirectory(prefix="fathom-") as folder:
        out = os.path.join(folder, "check.json")
        run(["check", "--vehicle", os.fspath(vehicle), *_options({"map": map, "site": site, "json": out}), "--",
             *_paths(runs)], progress)
        with open(out, encoding="utf-8") as file:
            return json.load(file)


def diagnose(vehicle, train, validate=(), *, out=None, progress=None, **options):
    """What the vehicle's model lacks: result.json as a dictionary (docs/schema/diagnosis-2.schema.json).

    `out`: folder that keeps result.json and report.html; without, both are gone afterwards. `options` are those of
    `fathom diagnose --help`: map, site, config, core, without, candidate, time_budget, no_learning, threads.
    """
    with tempfile.TemporaryDirectory(prefix="fathom-") as folder:
        place = os.fspath(out) if out is not None else folder
        words = ["diagnose", "--vehicle", os.fspath(vehicle), "--out", place, *_options(options), "--train", *_paths(train)]
        held_out = _paths(validate)
        if held_out:
            words += ["--validate", *held_out]
        run(words, progress)
        with open(os.path.join(place, "result.json"), encoding="utf-8") as file:
            return json.load(file)
