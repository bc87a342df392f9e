"""The joint {{ joint | plain }}, as a model that stands alone.

{% for line in origin %}
{{ line | plain }}
{% endfor %}

    dy/dt = gain * s, where s is the input, delay seconds late, after its effects

A whole record at once, or sample by sample:

    output = simulate(input, period_s=0.01, output=0.0)

    joint = Model(period_s=0.01, input=0.0, output=0.0)
    output = joint.step(input)
"""

from collections import deque
from dataclasses import astuple, dataclass

import numpy as np


@dataclass
class Parameters:
    """What may be changed."""

{% for p in parameters %}
    #: {{ p.described }}
    {{ p.name }}: float = {{ p.value }}
{% endfor %}


class _Moment:
    """What an effect sees of the joint."""

    __slots__ = ("signal", "position", "velocity", "time", "dt", "others")

    def __init__(self, model, signal, time, dt):
        self.signal = signal
        self.position = model.angle
        self.velocity = model.velocity
        self.time = model.p.start_s + time
        self.dt = dt
        self.others = model.others


class _Change:
    """A change of the input, as it is commanded."""

    __slots__ = ("before", "after", "held", "time")

    def __init__(self, before, after, held, time):
        self.before = before
        self.after = after
        self.held = held
        self.time = time


class Model:
    """The joint, sample by sample.

    At first it is at rest in the output ``output``, and the input ``input`` has long been
    held. ``others`` is the activity of the other joints, 0 to 1: set it before a step.
    """

    def __init__(self, period_s, input=0.0, output=0.0, parameters=None):
        # Numbers of NumPy: a division by zero is infinite, and no exception.
        self.p = Parameters(*(np.float64(p) for p in astuple(parameters or Parameters())))
        self.period_s = np.float64(period_s)
        self.others = np.float64(0.0)
        self.sample = 0
        self.level = self.before = np.float64(input)
        self.since = np.float64(0.0)
        self.coming = deque()
        self.angle = self.velocity = self.measured = self.load_adds = np.float64(0.0)
{% for name in memory %}
        self.{{ name }} = np.float64(0.0)
{% endfor %}
        with np.errstate(all="ignore"):
            self._settle(self.level, np.float64(output))

    def step(self, input):
        """The output now; then ``input`` is held for one period."""
        with np.errstate(all="ignore"):
            return self._step(np.float64(input))

    def _step(self, input):
        output = self.measured
        start = self.sample * self.period_s
        self.sample += 1
        self._advance(input, start, self.sample * self.period_s)
        return output

    def _settle(self, input, output):
        dt = self.period_s
        at = _Moment(self, input, 0.0, dt)
{% for e in drive %}
{% if e.settle.lines %}
        self._effect_{{ e.id }}_settle(at)
{% endif %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        at = _Moment(self, self.angle, 0.0, dt)
{% for e in limits %}
{% if e.settle.lines %}
        self._effect_{{ e.id }}_settle(at)
{% endif %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        self.angle = at.signal
        at = _Moment(self, self.angle, 0.0, dt)
{% for e in sensor %}
{% if e.settle.lines %}
        self._effect_{{ e.id }}_settle(at)
{% endif %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        play = self.angle - at.signal
        at = _Moment(self, output, 0.0, dt)
{% for e in sensor %}
{% if e.settle.lines %}
        self._effect_{{ e.id }}_settle(at)
{% endif %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        self.angle = output + play
        self._measure(0.0, dt)

    def _advance(self, input, start, end):
        if input != self.before:
            self._command(input, start)
        while self.coming and self.coming[0][0] <= start:
            self.level = self.coming.popleft()[1]
        if not (self.coming and self.coming[0][0] < end):
            self._pass(self.level, start, self.period_s)
            return
        now = start
        while self.coming and self.coming[0][0] < end:
            change, level = self.coming.popleft()
            self._pass(self.level, now, change - now)
            now, self.level = change, level
        self._pass(self.level, now, end - now)

    def _command(self, level, now):
        """The input changes to ``level``, which arrives later.

        A change that would act before an earlier one takes its place.
        """
        delay = self.p.delay
{% if transport %}
        at = _Change(self.before, level, now - self.since, self.p.start_s + now)
{% for e in transport %}
        delay = delay + self._effect_{{ e.id }}(at)
{% endfor %}
{% endif %}
        arrives = now + max(delay, 0.0)
        while self.coming and self.coming[-1][0] >= arrives:
            self.coming.pop()
        self.coming.append((arrives, level))
        self.before, self.since = level, now

    def _pass(self, input, time, dt):
        """Lets ``dt`` seconds pass with a constant input."""
        if not dt > 0.0:
            return
        at = _Moment(self, input, time, dt)
{% for e in drive %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        at.signal = self.p.gain * at.signal
{% if load %}
        commanded = at.signal
        at.position = at.position + 0.5 * dt * (commanded + self.load_adds)
        at.time = at.time + 0.5 * dt
{% for e in load %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        self.load_adds = at.signal - commanded
{% endif %}
        self.velocity = at.signal
        self.angle = self.angle + self.velocity * dt
{% if limits %}
        at = _Moment(self, self.angle, time, dt)
{% for e in limits %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        if at.signal != self.angle:
            self.velocity = np.float64(0.0)
        self.angle = at.signal
{% endif %}
        self._measure(time, dt)

    def _measure(self, time, dt):
        """Moves the sensor on to the present angle."""
        at = _Moment(self, self.angle, time, dt)
{% for e in sensor %}
        at.signal = self._effect_{{ e.id }}(at)
{% endfor %}
        self.measured = at.signal
{% for e in effects %}

    def _effect_{{ e.id }}(self, at):
        """{{ e.summary | plain }}: {{ e.equation | plain }}"""
{% for line in e.step.lines %}
        {{ line }}
{% endfor %}
        return {{ e.step.result }}
{% if e.settle.lines %}

    def _effect_{{ e.id }}_settle(self, at):
{% for line in e.settle.lines %}
        {{ line }}
{% endfor %}
{% endif %}
{% endfor %}


def simulate(input, period_s, output=0.0, others=None, parameters=None):
    """The output for each sample of ``input``, an array of NumPy.

    The first level of the input has long been held, and the joint is at ``output``.
    ``others`` is the activity of the other joints, 0 to 1, one number a sample.
    """
    input = np.asarray(input, dtype=np.float64)
    found = np.empty(input.shape)
    if input.size == 0:
        return found
    model = Model(period_s, input[0], output, parameters)
    with np.errstate(all="ignore"):
        for k, level in enumerate(input):
            if others is not None:
                model.others = np.float64(others[k])
            found[k] = model._step(level)
    return found
