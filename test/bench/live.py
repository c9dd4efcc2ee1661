#!/usr/bin/env python3
"""Figures of live trials, as docs/live.md states them. Python alone; the programs of a build do the work.

    test/bench/live.py seeds 1001..1020 [--site deep] [--excitation optimal] [--hide EFFECT] [--limit S] [--bin DIR]
    test/bench/live.py latency [--seconds 40]      real time, lcm-logger's clock
    test/bench/live.py memory [--seconds 3600]     lockstep, resident memory of every process over virtual time
    test/bench/live.py dropout 1001..1010          ten seconds without a tag: largest error of the position
    test/bench/live.py agreement 1..30             effects drawn: does `fathom diagnose` say of the log what was said live?
"""
import argparse
import contextlib
import glob
import json
import os
import random
import statistics
import struct
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# All but Y_v|v|, Z_w|w| and W-B: those that the tank's motion reveals.
WELL = ["m_X", "m_Y", "m_Z", "I_Z", "X_u", "Y_v", "Z_w", "N_r", "X_u|u|", "N_r|r|"]


def trial(options, folder, seed, *more, speed="lockstep", limit=None):
    environment = dict(os.environ, FATHOM_BIN=options.bin)
    words = [os.path.join(ROOT, "scripts/live"), folder, options.site, options.vehicle, options.excitation, speed,
             str(seed), str(limit or options.limit), *more]
    return subprocess.run(words, env=environment, capture_output=True, text=True)


def result(folder):
    with open(os.path.join(folder, "result.json")) as file:
        return json.load(file)


def folder_of(options, seed):
    """A folder for one trial: of --keep when that is given, else one that is gone afterwards."""
    if options.keep:
        return contextlib.nullcontext(os.path.join(options.keep, str(seed)))
    return tempfile.TemporaryDirectory()


def seeds_of(text):
    first, last = text.split("..")
    return range(int(first), int(last) + 1)


def newest_build():
    """Programs of the preset that was built last."""
    built = glob.glob(os.path.join(ROOT, "build/*/bin/simulator"))
    return os.path.dirname(max(built, key=os.path.getmtime)) if built else os.path.join(ROOT, "build/release/bin")


def seeds(options):
    ended, covered, within, all_named, settled, adopted, contacts = [], 0, {}, 0, 0, {}, 0
    errors, missed = {}, {}
    rms, normalised, wall, sure = [], [], [], 0.0
    for seed in seeds_of(options.what):
        with folder_of(options, seed) as folder:
            begun = time.time()
            hide = [word for effect in options.hide for word in ("--hide", effect)]
            ran = trial(options, folder, seed, *hide)
            wall.append(time.time() - begun)
            if ran.returncode != 0:
                print(f"seed {seed}: {ran.stderr.splitlines()[-1]}")
                continue
            r = result(folder)
        truth = r["compared_with_truth"]
        p = truth["parameters"]
        covered += sum(one["inside_interval"] for one in p.values())
        all_named += len(p)
        for name, one in p.items():
            if not one["inside_interval"]:
                missed[name] = missed.get(name, 0) + 1
            if one["relative_error"] is not None:  # none where the truth is zero
                errors.setdefault(name, []).append(100.0 * one["relative_error"])
        settled += r["settled"]
        contacts += sum(truth["contacts"].values())
        ended.append(r["seconds"])
        for name in r["adopted_effects"] or ["none"]:
            adopted[name] = adopted.get(name, 0) + 1
        rms.append([truth["state_error"][k]["rms"] for k in "xyzuvw"])
        normalised.append([truth["state_error"][k]["normalised_square"] for k in "xyzuvw"])
        worst = max(abs(errors[name][-1]) for name in WELL if name in errors)
        print(f"seed {seed}: {r['phase']}, {'' if r['settled'] else 'not '}settled after {r['seconds']:.0f} s; "
              f"{sum(one['inside_interval'] for one in p.values())} of {len(p)} intervals hold; "
              f"worst of the well revealed {worst:.2f} %; adopted {r['adopted_effects']}"
              f"{'' if r['settled'] else '; ' + r['reason']}", flush=True)
    n = len(ended)
    print(f"\n{n} seeds: settled {settled}, ended after {statistics.mean(ended):.0f} s on average (longest "
          f"{max(ended):.0f}), contacts {contacts}, wall clock {statistics.mean(wall):.1f} s each")
    print(f"95 % intervals that hold the truth: {covered} of {all_named} ({100.0 * covered / all_named:.1f} %); missed {missed}")
    print(f"in the model at the end: {adopted}")
    print(f"{'':8s} {'mean error':>10s} {'rms':>8s} {'largest':>8s}   within 5 %")
    for name, values in errors.items():
        root = (sum(v * v for v in values) / n) ** 0.5
        print(f"{name:8s} {statistics.mean(values):9.2f}% {root:7.2f}% {max(map(abs, values)):7.2f}%   "
              f"{sum(abs(v) < 5.0 for v in values)} of {n}")
    mean = lambda rows, k: statistics.mean(row[k] for row in rows)
    print("position rms [mm]", " ".join(f"{1e3 * mean(rms, k):.1f}" for k in range(3)), " velocity rms [mm/s]",
          " ".join(f"{1e3 * mean(rms, k):.1f}" for k in range(3, 6)), " normalised squares",
          " ".join(f"{mean(normalised, k):.2f}" for k in range(6)))


def events(path):
    """Channel, logger's time [us] and the message's own utime of every event."""
    with open(path, "rb") as file:
        data = file.read()
    at = 0
    while at + 28 <= len(data):
        _, _, stamp, channel, size = struct.unpack_from(">IqqII", data, at)
        at += 28
        name = data[at:at + channel].decode()
        body = data[at + channel:at + channel + size]
        at += channel + size
        yield name, stamp, struct.unpack_from(">q", body, 8)[0] if size >= 16 else 0


def percentiles(values):
    values = sorted(values)
    pick = lambda share: values[min(len(values) - 1, int(share * len(values)))]
    return f"median {pick(0.5) / 1e3:.3f} ms, 99th percentile {pick(0.99) / 1e3:.3f} ms, largest {values[-1] / 1e3:.3f} ms"


def latency(options):
    with tempfile.TemporaryDirectory() as folder:
        ran = trial(options, folder, 1, speed="real", limit=options.seconds)
        if ran.returncode != 0:
            sys.exit(ran.stderr)
        ahrs, state, states, models, last = {}, [], {}, [], 0
        for name, stamp, utime in events(os.path.join(folder, "run.lcmlog")):
            if name == "AHRS":
                ahrs[utime] = stamp
            elif name == "STATE":
                states[utime] = stamp
                if utime in ahrs:
                    state.append(stamp - ahrs[utime])
            elif name == "MODEL":
                models.append(stamp - last)
            if name in ("STATE", "THRUSTERS"):
                last = stamp
        print(f"AHRS to STATE: {percentiles(state)} ({len(state)} messages)")
        print(f"newest STATE or THRUSTERS to MODEL: {percentiles(models)} ({len(models)} messages)")


def memory(options):
    names = ["estimator", "identifier", "diagnoser", "supervisor", "simulator"]
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, FATHOM_BIN=options.bin, FATHOM_LIVE_WHOLE="yes")
        process = subprocess.Popen([os.path.join(ROOT, "scripts/live"), folder, options.site, options.vehicle,
                                    options.excitation, "lockstep", "1", str(options.seconds)], env=environment,
                                   stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        pids, rows, most, begun = {}, [], {}, time.time()
        while process.poll() is None:
            time.sleep(2.0)
            for pid in filter(str.isdigit, os.listdir("/proc")):
                try:
                    words = open(f"/proc/{pid}/cmdline").read().split("\0")
                    name = os.path.basename(words[0]).removeprefix("fathom-")
                    if name in names and any(folder in word for word in words):
                        pids[name] = pid
                except OSError:
                    pass
            row = {}
            for name, pid in pids.items():
                try:
                    status = open(f"/proc/{pid}/status").read()
                    row[name] = int(status.split("VmRSS:")[1].split()[0]) / 1024.0
                    most[name] = int(status.split("VmHWM:")[1].split()[0]) / 1024.0
                except (OSError, IndexError):
                    pass
            if len(row) == len(names):
                rows.append((time.time() - begun, row))
        if process.returncode != 0:
            sys.exit(process.stderr.read())
        print("resident memory [MB] at 10, 25, 50, 75, 100 % of the run, and the most at any time:")
        for name in names:
            print(f"{name:11s}", " ".join(f"{rows[min(len(rows) - 1, int(s * len(rows)))][1][name]:6.1f}"
                                          for s in (0.1, 0.25, 0.5, 0.75, 1.0)), f" {most[name]:6.1f}")
        print(f"{options.seconds} s of virtual time in {time.time() - begun:.0f} s")


def dropout(options):
    for seed in seeds_of(options.what):
        worst = []
        for failed in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                more = ["--fail", "tag_pose=silent,from:40,to:50"] if failed else []
                ran = trial(options, folder, seed, *more, limit=60)
                if ran.returncode != 0:
                    sys.exit(ran.stderr)
                error = result(folder)["compared_with_truth"]["state_error"]
                worst.append(max(error[k]["largest"] for k in "xyz"))
        print(f"seed {seed}: largest error of an axis {1e3 * worst[0]:.1f} mm with tags, {1e3 * worst[1]:.1f} mm with "
              f"ten seconds without", flush=True)


def hideable(options):
    """Names of all effects, as the simulator lists them when it is asked for one that it does not know."""
    with tempfile.TemporaryDirectory() as folder:
        ran = trial(options, folder, 1, "--hide", "?", limit=1)
    words = (ran.stderr + ran.stdout).split("there are ")[1].splitlines()[0]
    return sorted(word.strip(" .,;") for word in words.replace(" and ", ",").split(","))


def relation(live, later):
    """How the last live verdict stands to that on the whole log."""
    names = {effect["name"] for effect in later["effects"]}
    possible = names.union(*(effect["alternatives"] for effect in later["effects"]))
    first = live["candidates"][0]["name"] if live["candidates"] else ""
    if live["verdict"] == "effect":
        return "same" if first in possible else "other name" if names else "live alone names"
    if live["verdict"] == "ambiguous":
        return "same, live less sure" if {first, live["against"]} & possible else "other name"
    if names:
        return "live names nothing"
    return "same" if live["verdict"] == later["verdict"] else "live " + live["verdict"] + ", later " + later["verdict"]


def agreement(options):
    effects, counts = hideable(options), {}
    for seed in seeds_of(options.what):
        draw = random.Random(seed)
        hidden = draw.choice(effects) if draw.random() < 0.8 else ""
        with folder_of(options, seed) as folder:
            ran = trial(options, folder, seed, *(["--hide", hidden] if hidden else []))
            if ran.returncode != 0:
                print(f"seed {seed}: {hidden or 'nothing'}: {ran.stderr.splitlines()[-1]}", flush=True)
                continue
            live = result(folder)["diagnosis"]
            ran = subprocess.run([os.path.join(options.bin, "fathom"), "diagnose",
                                  "--vehicle", os.path.join(ROOT, f"config/vehicles/{options.vehicle}.yaml"),
                                  "--site", os.path.join(ROOT, f"config/sites/{options.site}.yaml"), "--train",
                                  os.path.join(folder, "run.lcmlog"), "--out", os.path.join(folder, "later")],
                                 capture_output=True, text=True)
            if ran.returncode != 0:
                print(f"seed {seed}: {hidden or 'nothing'}: {ran.stderr.splitlines()[-1]}", flush=True)
                continue
            later = result(os.path.join(folder, "later"))
        kind = relation(live, later)
        counts[kind] = counts.get(kind, 0) + 1
        told = ", ".join(c["name"] for c in live["candidates"][:1]) if live["verdict"] in ("effect", "ambiguous") else ""
        print(f"seed {seed}: hidden {hidden or 'nothing'}; live {live['verdict']} {told} {live['against']}; later "
              f"{later['verdict']} {[e['name'] for e in later['effects']]}: {kind}", flush=True)
    print(f"\n{sum(counts.values())} trials: {counts}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["seeds", "latency", "memory", "dropout", "agreement"])
    parser.add_argument("what", nargs="?", default="1001..1020")
    parser.add_argument("--site", default="tank")
    parser.add_argument("--vehicle", default="seabotix_lbv150")
    parser.add_argument("--excitation", default="paper")
    parser.add_argument("--hide", action="append", default=[])
    parser.add_argument("--limit", type=float, default=1500)
    parser.add_argument("--seconds", type=float, default=None)
    parser.add_argument("--keep", help="folder to keep the trials of `seeds` and `agreement` in, one for each seed")
    parser.add_argument("--bin", default=newest_build(), help="programs; those built last otherwise")
    options = parser.parse_args()
    options.bin = os.path.abspath(options.bin)
    if options.seconds is None:
        options.seconds = 3600 if options.command == "memory" else 40
    {"seeds": seeds, "latency": latency, "memory": memory, "dropout": dropout,
     "agreement": agreement}[options.command](options)


main()
