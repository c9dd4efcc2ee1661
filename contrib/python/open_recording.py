"""Opens any recording and draws one field of it.

    python3 open_recording.py RUN.lcmlog [CHANNEL FIELD] [--plot FILE.png]
"""

import argparse

import fathom

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("recording")
parser.add_argument("channel", nargs="?", help="without: the one with the most messages")
parser.add_argument("field", nargs="?")
parser.add_argument("--plot", default="recording.png")
asked = parser.parse_args()

run = fathom.open(asked.recording)
for name, channel in run.items():
    print("%-16s %6d messages  %s" % (name, len(channel.t), channel.comment))

name = asked.channel or max(run, key=lambda each: len(run[each].t))
channel = run[name]
field = asked.field or next(each for each in channel if each != "utime" and channel[each].dtype.kind == "f")
values = channel[field].reshape(len(channel.t), -1)
print("%s.%s [%s]: mean %s" % (name, field, channel.unit[field], values.mean(axis=0)))

try:
    from matplotlib import pyplot
except ImportError:
    print("no plot: matplotlib is not installed")
else:
    pyplot.plot(channel.t, values)
    pyplot.xlabel("t [s]")
    pyplot.ylabel("%s.%s [%s]" % (name, field, channel.unit[field]))
    pyplot.savefig(asked.plot)
    print("plot  " + asked.plot)
