"""Fathom from Python: recordings as numpy arrays, identified models to fly, the sensor check and the diagnosis.

    import fathom
    run = fathom.open("RUN.lcmlog")              # any recording that `fathom import` reads
    run["STATE"]["p_WB"]                         # (n, 3); run["STATE"].unit["p_WB"] is "m"
    fathom.check("V.yaml", ["RUN.lcmlog"])       # a dictionary as docs/schema/check-1.schema.json says
    result = fathom.diagnose("V.yaml", ["RUN.lcmlog"], out="DIR")  # docs/schema/diagnosis-2.schema.json
    model = fathom.load_model("DIR")
    model.fly(t, force)                          # position, attitude, velocities over time

SI units and radians; W is north-east-down, B forward-right-down (docs/conventions.md). Recordings, check and diagnose are
read and made by the program `fathom`, which is looked for beside this package, then in PATH; FATHOM_PROGRAM names
another. What it refuses is raised as fathom.Error, with its own line.
"""

from fathom.model import Flight, Model, load_model
from fathom.program import Error, check, diagnose, show
from fathom.recording import Channel, Recording, open  # noqa: A004 - fathom.open, as wave.open

__all__ = ["Channel", "Error", "Flight", "Model", "Recording", "check", "diagnose", "load_model", "open", "show"]
