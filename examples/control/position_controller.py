"""Designs a position controller for a joint with python-control, from a log.

    pip install './python[control]'
    python examples/control/position_controller.py data/hidden_effect.csv boom

The linear part of the fitted model, an integrator with dead time, gives the gain of a
proportional controller for a phase margin of 60 degrees. The exported model then simulates the
closed loop with all effects, at the sample period of the log.
"""

import importlib.util
import math
import sys
import tempfile
from pathlib import Path

import control
import numpy as np
import tauscope


def exported(model: tauscope.Model, joint: str):
    """The model as a module of its own, which can be stepped sample by sample."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{joint}.py"
        model.export(path, joint)
        spec = importlib.util.spec_from_file_location(joint, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


def closed_loop(plant, gain: float, reference: np.ndarray) -> np.ndarray:
    """The output with the input ``gain * (reference - output)``, held for a sample period."""
    output, level = np.empty(len(reference)), 0.0
    for k, wanted in enumerate(reference):
        output[k] = plant.step(level)
        level = gain * (wanted - output[k])
    return output


def main() -> None:
    log, joint = sys.argv[1:]
    period_s = tauscope.read(log)[joint].trials[0].sample_period
    model = tauscope.improve(log, joint=joint, progress=False).model
    linear, dead_time_s = model.to_control(joint)
    padded, _ = model.to_control(joint, pade=5)

    # Dead time L turns an integrator's phase by -w L: 60 degrees are left at w = 30 degrees / L.
    crossover = math.radians(30) / (dead_time_s + 0.5 * period_s)
    gain = 1 / abs(control.evalfr(linear, 1j * crossover))
    gain_margin, phase_margin, *_ = control.margin(gain * padded)
    effects = ", ".join(effect.kind for effect in model[joint].effects)
    print(f"{joint}: effects beside the integrator: {effects or 'none'}")
    print(f"gain {gain:.4f}, crossover {crossover:.2f} rad/s, phase margin {phase_margin:.1f} deg, "
          f"gain margin {gain_margin:.2f}")

    time_s = np.arange(0, 5, period_s)
    reference = np.full(len(time_s), 10.0)
    expected = control.forced_response(
        control.feedback(gain * padded), time_s, reference
    ).outputs
    simulated = closed_loop(exported(model, joint).Model(period_s), gain, reference)
    print(f"step of 10: overshoot {max(expected) - 10:.2f} linear, {max(simulated) - 10:.2f} with "
          f"all effects; error after {time_s[-1]:.0f} s: {10 - expected[-1]:.2f} and "
          f"{10 - simulated[-1]:.2f}")


if __name__ == "__main__":
    main()
