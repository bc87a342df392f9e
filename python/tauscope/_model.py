"""Models: read, simulated, fitted, and handed on."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _tauscope
from ._functions import Parameter, own_function, written
from ._inputs import gathered
from ._logs import read
from ._messages import in_python, translated
from ._progress import Progress
from ._run import run, warn
from ._settings import arguments

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import CompareOptions, ReadOptions

#: Radians in one unit of an angle; of any other unit, a degree.
RADIANS = {"rad": 1.0, "mrad": 1e-3, "rev": 2 * math.pi, "turn": 2 * math.pi}


@dataclass(frozen=True)
class Effect:
    """An effect of a model: its kind, where it acts, and the values of its parameters."""

    kind: str
    stage: str
    summary: str
    parameters: dict[str, float]


@dataclass(frozen=True)
class JointModel:
    """The model of one joint: ``dy/dt = gain · s(t − delay)``, with effects on it."""

    joint: str
    gain: float
    delay: float
    effects: list[Effect]


class Model:
    """The models of several joints, as a model file holds them (``tauscope/model/1``).

    ``functions`` are the effects in it that are functions of Python, which its text only names.

    >>> model = Model.integrator(gain=10.0, delay=0.15)
    >>> model = model.with_effect("dead_band", lower=-0.5, upper=0.5)
    >>> [effect.kind for effect in model.effects]
    ['dead_band']
    >>> y = model.predict([0.0, 1.0, 1.0, 1.0], sample_period=0.1)
    >>> [round(value, 3) for value in y.tolist()]
    [0.0, 0.0, 0.0, 0.25]
    """

    def __init__(
        self,
        text: str,
        name: str = "model.toml",
        functions: Sequence[_tauscope.Function] = (),
    ) -> None:
        self.text = text
        self.name = name
        self.functions = tuple(functions)
        self.joints: list[str] = _tauscope.check(text, name, self.functions)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], functions: Sequence[_tauscope.Function] = ()
    ) -> Model:
        """Reads a model file; ``functions`` are the Python functions whose names are in it."""
        return cls(Path(path).read_text(encoding="utf-8"), Path(path).name, functions)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the model file."""
        Path(path).write_text(self.text, encoding="utf-8")
        return Path(path)

    @classmethod
    def integrator(cls, gain: float, delay: float, joint: str = "joint") -> Model:
        """A plain integrator: gain in output units per second and input unit, delay in s."""
        text = (
            f'schema = "tauscope/model/1"\n[joint.{json.dumps(joint)}]\nstructure = "integrator"\n'
            f"parameters = {{ gain = {float(gain)!r}, delay = {float(delay)!r} }}\n"
        )
        return cls(text)

    def _joint(self, joint: str | None) -> str:
        if joint is None and len(self.joints) == 1:
            return self.joints[0]
        if joint is None:
            raise TypeError(f"say which joint: {', '.join(self.joints)}")
        return joint

    def __getitem__(self, joint: str) -> JointModel:
        gain, delay, effects = _tauscope.describe(self.text, joint, self.functions)
        found = [Effect(kind, stage, about, dict(values)) for kind, stage, about, values in effects]
        return JointModel(joint, gain, delay, found)

    @property
    def effects(self) -> list[Effect]:
        """The effects of a model of one joint; of several joints use ``model["boom"].effects``."""
        return self[self._joint(None)].effects

    def with_effect(
        self,
        kind: str,
        joint: str | None = None,
        *,
        expression: str | None = None,
        function: Callable[..., Any] | None = None,
        stage: str = "input",
        states: Mapping[str, Any] | None = None,
        **parameters: Parameter,
    ) -> Model:
        """This model with another effect after those it has; neutral where no value is given.

        With ``expression`` or ``function`` the effect is a user's own: ``kind`` is its name, and
        ``stage`` where it acts: ``input``, ``transport``, ``dynamics``, ``load`` or ``output``.
        A parameter is a value, or a dictionary with ``value``, ``min``, ``max``, ``fixed`` and,
        of an effect of one's own, ``neutral``: where it changes nothing, 0 unless said.

        The arguments of a function are, by their names, parameters and signals: ``signal``,
        ``position``, ``velocity``, ``time``, ``dt``, ``others``, ``radians``; of the transport
        stage ``before``, ``after``, ``held``, ``time``. It gets numbers in the units of the log
        and seconds, and gives the signal after the effect; of the transport stage the seconds by
        which a change of the input arrives later. It is called for every sample of every
        simulation, or, if it takes ``signal`` alone, for every level of the input; and never with
        a parameter below its ``min`` or above its ``max``.

        ``states`` are numbers that the effect remembers. Of an expression each has the expression
        of its next value, or a dictionary with ``start`` and ``next``. Of a function each is one of
        its arguments and has its start, a number or ``"signal"``; the function returns the signal
        and the next value of each state, in their order.

        >>> model = Model.integrator(gain=10.0, delay=0.0)
        >>> model = model.with_effect("weak", function=lambda signal, a: signal * (1 - a), a=0.5)
        >>> model.predict([1.0, 1.0, 1.0], sample_period=0.1).tolist()
        [0.0, 0.5, 1.0]
        >>> def halfway(signal, x):
        ...     x = x + 0.5 * (signal - x)
        ...     return x, x
        >>> model = Model.integrator(gain=10.0, delay=0.0)
        >>> model = model.with_effect("halfway", function=halfway, states={"x": "signal"})
        >>> model.predict([0.0, 1.0, 1.0, 1.0], sample_period=0.1).tolist()
        [0.0, 0.0, 0.5, 1.25]
        """
        lines = [f"\n[[joint.{json.dumps(self._joint(joint))}.effect]]"]
        functions, given = self.functions, {**parameters}
        if function is not None:
            own, given = own_function(kind, stage, function, states or {}, parameters)
            functions = (*(each for each in functions if each.id != kind), own)
        if expression is None:
            lines.append(f"kind = {json.dumps(kind)}")
        else:
            lines.append('kind = "expression"')
            header = {"id": kind, "stage": stage, "expression": expression}
            lines.extend(f"{key} = {json.dumps(value)}" for key, value in header.items())
            if states:
                lines.append(f"states = {{ {written(states)} }}")
        lines.append(f"parameters = {{ {written(given)} }}")
        text = self.text.rstrip("\n") + "\n".join(["", *lines]) + "\n"
        return Model(text, self.name, functions)

    def with_values(self, joint: str | None = None, /, **values: float) -> Model:
        """This model with other values: ``gain=…``, ``dead_band__upper=…``."""
        named = [(name.replace("__", "."), float(value)) for name, value in values.items()]
        text = _tauscope.refitted(self.text, self._joint(joint), named, self.functions)
        return Model(text, self.name, self.functions)

    def simulate(
        self,
        input: npt.ArrayLike,
        sample_period: float,
        joint: str | None = None,
        *,
        output: float = 0.0,
        start_s: float = 0.0,
        others: npt.ArrayLike | None = None,
        output_unit: str = "deg",
        trial: str = "",
    ) -> npt.NDArray[np.float64]:
        """The output for each of the n samples of ``input``, from ``output`` on.

        The first level has long been held. ``others`` is the activity of the other joints, 0 to
        1, n samples; ``start_s`` the time of the record at the first one. ``trial`` is a label:
        effects such as ``gravity_load[H]`` act where it has their word.
        """
        return _tauscope.simulate(
            self.text,
            self._joint(joint),
            np.ascontiguousarray(input, dtype=np.float64),
            float(sample_period),
            float(output),
            float(start_s),
            None if others is None else np.ascontiguousarray(others, dtype=np.float64),
            RADIANS.get(output_unit, math.pi / 180),
            trial,
            self.functions,
        )

    predict = simulate

    def fit(
        self, data: Any, *, progress: Progress = None, **settings: Unpack[CompareOptions]
    ) -> Model:
        """This model fitted to ``data``, from its values; a new model.

        ``settings`` are those of :func:`compare`.
        """
        rest: dict[str, Any] = {**settings, "fit": True}
        done = run(["compare"], *gathered(data, rest), rest, progress=progress, model=self)
        warn(done.messages, stacklevel=2)
        fitted: Model = self
        for joint in json.loads(done.printed.text())["joints"]:
            values = [(name, of["value"]) for name, of in joint["parameters"].items()]
            text = _tauscope.refitted(fitted.text, joint["joint"], values, self.functions)
            fitted = Model(text, self.name, self.functions)
        return fitted

    def score(self, data: Any, **settings: Unpack[ReadOptions]) -> float:
        """The coefficient of determination R² of free simulations over all trials."""
        missed = total = 0.0
        for name, joint in read(data, **settings).items():
            if name not in self.joints:
                continue
            for trial in joint.trials:
                found = self.simulate(
                    trial.input,
                    trial.sample_period,
                    name,
                    output=float(trial.output[0]),
                    start_s=trial.start_s,
                    output_unit=joint.output_unit or "deg",
                )
                missed += float(np.sum((trial.output - found) ** 2))
                total += float(np.sum((trial.output - trial.output.mean()) ** 2))
        if total == 0.0:
            raise ValueError(f"no joint of the model is in the data: {', '.join(self.joints)}")
        return 1.0 - missed / total

    def to_control(self, joint: str | None = None, *, pade: int = 0) -> tuple[Any, float]:
        """The linear part as a ``control.TransferFunction`` and its dead time in seconds.

        gain / s, with the actuator's lag and the resonance. With ``pade`` the dead time is in
        the transfer function, as a Padé approximation of that order, and 0 is left. Needs
        python-control.
        """
        import control

        model = self[self._joint(joint)]
        linear = control.tf([model.gain], [1.0, 0.0])
        for effect in model.effects:
            of = effect.parameters
            if effect.kind == "actuator_lag":
                linear = linear * control.tf([1.0], [of["time_constant"], 1.0])
            elif effect.kind == "resonance" and of["period"] > 0:
                omega = 2 * math.pi / of["period"]
                swing = control.tf([omega**2], [1.0, 2 * of["damping"] * omega, omega**2])
                linear = linear * swing
        if pade > 0:
            numerator, denominator = control.pade(model.delay, pade)
            return linear * control.tf(numerator, denominator), 0.0
        return linear, model.delay

    def export(
        self,
        path: str | os.PathLike[str],
        joint: str | None = None,
        *,
        input_unit: str | None = None,
        output_unit: str | None = None,
        trial: str | None = None,
    ) -> list[str]:
        """Writes the model as source code or as an FMU: ``.c``, ``.h``, ``.py``, ``.m``, ``.fmu``.

        Where effects act in some trials alone, ``trial`` is the label whose effects are meant, or
        ``"none"``. Gives what is to be said of it, such as that there is no compiler for the
        binary.
        """
        given = {"input_unit": input_unit, "output_unit": output_unit, "trial": trial}
        typed = arguments("export", {"joint": self._joint(joint), **given})
        with tempfile.TemporaryDirectory() as folder, in_python("export"):
            kept = self.save(Path(folder) / self.name)
            words = ["export", str(kept), os.fspath(path), *typed]
            _, _, messages, _ = _tauscope.run(words, None, None, False, self.functions)
        return [translated("export", said) for kind, said in messages if kind == "note"]

    def __repr__(self) -> str:
        parts = []
        for name in self.joints:
            kinds = " + ".join(["integrator", *(effect.kind for effect in self[name].effects)])
            parts.append(f"{name}: {kinds}")
        return f"<Model {'; '.join(parts)}>"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text)}</pre>"
