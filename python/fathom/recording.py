"""Recordings as numpy arrays with their units."""

import json
import os
import tempfile
from collections.abc import Mapping

import numpy

from fathom import program


class Channel(Mapping):
    """Fields of one channel by name, a row per message: channel["nu"] is (n, 6)."""

    def __init__(self, about, fields):
        self.type = about["type"]
        self.comment = about["comment"]
        self.unit = {name: field["unit"] for name, field in about["fields"].items()}
        self.about = {name: field["comment"] for name, field in about["fields"].items()}
        self.t = fields.pop("t")  # s since the recording's first message, when each was logged
        self._fields = fields

    def __getitem__(self, name):
        return self._fields[name]

    def __iter__(self):
        return iter(self._fields)

    def __len__(self):
        return len(self._fields)

    def __repr__(self):
        return "<%s: %d messages of %s>" % (self.type, len(self.t), ", ".join(self))


class Recording(Mapping):
    """Channels by name. `begin_us`: the first message, us since the epoch; `notes`: what was said while reading."""

    def __init__(self, path, notes):
        with numpy.load(path, allow_pickle=False) as arrays:
            about = json.loads(str(arrays["about"]))
            fields = {name: {} for name in about["channels"]}
            for key in arrays.files:
                if key != "about":
                    channel, _, field = key.rpartition("/")
                    fields[channel][field] = arrays[key]
        self.begin_us = about["begin_us"]
        self.notes = notes
        self._channels = {name: Channel(one, fields[name]) for name, one in about["channels"].items()}

    def __getitem__(self, name):
        return self._channels[name]

    def __iter__(self):
        return iter(self._channels)

    def __len__(self):
        return len(self._channels)

    def __repr__(self):
        return "<recording: %s>" % ", ".join("%s %d" % (name, len(one.t)) for name, one in self._channels.items())


def open(path, *, map=None, channels=None, vehicle=None):
    """Any recording: an LCM log with all its channels; others as `fathom import` reads them.

    `channels`: these alone. `map`, `vehicle`: as `fathom export --help` says, for recordings that are no LCM logs.
    """
    notes = []
    with tempfile.TemporaryDirectory(prefix="fathom-") as folder:
        out = os.path.join(folder, "run.npz")
        words = ["export", os.fspath(path), "--to", "npz", "--out", out]
        words += program._options({"map": map, "vehicle": vehicle, "channel": list(channels) if channels else None})
        program.run(words, notes.append)
        return Recording(out, notes)
