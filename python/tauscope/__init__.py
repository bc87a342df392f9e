"""The variable delay of hydraulic robot joints, and the physics that a model lacks.

Each command of the program is a function here, with its options as keyword arguments: from a
DataFrame to the delay table, the missing effect and a recording:

.. code-block:: python

    import pandas as pd
    import tauscope

    log = pd.read_csv("data/hidden_effect.csv")
    delays = tauscope.estimate(log)
    delays.delay_table
    better = tauscope.improve(log)
    better.revisions, better.model
    better.save("hidden_effect.rrd")
"""

from ._commands import (
    add,
    compare,
    design,
    estimate,
    explain,
    improve,
    report,
    simulate,
    sweep,
)
from ._logs import Joint, Logs, Trial, read
from ._model import Effect, JointModel, Model
from ._results import (
    Comparison,
    Design,
    Estimate,
    Explanation,
    Improvement,
    Report,
    Result,
    Simulated,
    Sweep,
)
from ._run import TauscopeWarning
from ._settings import keywords
from ._tauscope import HAS_RECORDINGS, TauscopeError, __version__

__all__ = [
    "HAS_RECORDINGS",
    "Comparison",
    "Design",
    "Effect",
    "Estimate",
    "Explanation",
    "Improvement",
    "Joint",
    "JointModel",
    "Logs",
    "Model",
    "Report",
    "Result",
    "Simulated",
    "Sweep",
    "TauscopeError",
    "TauscopeWarning",
    "Trial",
    "__version__",
    "add",
    "compare",
    "design",
    "estimate",
    "explain",
    "improve",
    "keywords",
    "read",
    "report",
    "simulate",
    "sweep",
]
