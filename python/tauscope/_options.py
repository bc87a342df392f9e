"""The keyword arguments of each command, as types; ``python stubs.py`` writes this file.

``None`` is as good as leaving a setting out.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Literal, TypedDict

File = str | os.PathLike[str]


class ReadOptions(TypedDict, total=False):
    """How logs are read."""

    joint: str | Sequence[str] | None
    """A joint to use, by name; or `NAME=INPUT_COLUMN:OUTPUT_COLUMN` where the columns have other
    names. May be a list."""
    time: str | None
    """Column of the time in seconds."""
    trial: str | None
    """Column that names the trial of a row, or `none`."""
    sample_period: float | None
    """Seconds between samples, for a log without a time column."""
    columns: File | None
    """A TOML file that says which columns are the time and the inputs and outputs, as `tauscope
    columns -w` writes it."""
    resample: float | None
    """Put unevenly sampled logs on a grid of this period: output linear, input held."""
    fill: float | None
    """Fill gaps of the output up to this long; longer ones split the trial in two. An input that is
    missing is held."""
    max_memory: int | str | None
    """Limit of the memory for reading logs, in bytes or as `500MB` or `4GB`: a log that needs more
    is refused [default: half of the machine's]."""
    input_unit: str | None
    """Of arrays: the unit, as in a log."""
    output_unit: str | None
    """Of arrays: the unit, as in a log."""


class EstimateOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.estimate`."""

    method: (
        Literal["auto", "two-line", "hinge", "lag-aware"]
        | Sequence[Literal["auto", "two-line", "hinge", "lag-aware"]]
        | None
    )
    """How a delay is found. May be a list: the first one is the answer, the others are reported
    beside it [default: auto; two-line with `paper=True` and `--follow`]."""
    alpha: float | str | None
    """How far a segment extends before its input step and after the next one, in samples or in
    seconds as in `0.1s` [default: 10]."""
    beta: float | str | None
    """Samples, or seconds, between two candidate breakpoints [default: 5]."""
    passband: float | Literal["none"] | None
    """Zero-phase low-pass on the output that Algorithm 1's lines are fitted to: its cutoff, or
    `none` [default: 5]."""
    confidence: float | Literal["none"] | None
    """Reject a step as `nothing_happened` unless a reaction is significant at this confidence
    level; `none`: no test [default: 0.99; `none` for two-line]."""
    interval: float | None
    """Confidence level of the interval of a delay [default: 0.95]."""
    filter_order: int | None
    """Order of the low-pass [default: 4]."""
    min_delay: float | str | None
    """Reject a step that is held for fewer samples (`τ_min`), or seconds as in `0.2s` [default:
    0]."""
    max_delay: float | str | None
    """Longest delay that is searched, in samples or in seconds as in `0.5s`: useful where the
    output reaches an end stop within a hold."""
    output_limits: tuple[float, float] | str | None
    """Reject a step when the output touches a limit."""
    min_slope_change: float | None
    """Reject a step when the slope changes by less, in output units per sample [default: 0]."""
    max_sse: float | None
    """Reject a step unless the squared error of its lines is below this."""
    first_last: Literal["auto", "reject", "keep"] | None
    """Whether the first and the last step of a trial are judged [default: auto]."""
    keep_first_last: bool
    """Judge the first and the last step of a trial, as `first_last="keep"` does."""
    paper: bool
    """Algorithm 1 of Albrecht and Taylor to the letter, on any log: no rest or stop of the joint is
    looked for, and the first and the last step are rejected."""
    accept_anyway: bool
    """Accept delays although the output leads its input, does not follow it, or reacts later than
    the next step."""
    min_step: float | None
    """Count a change of the input as a step when it is more than this: for an input that was
    measured, and that has steps [default: 0]."""
    input: Literal["auto", "steps", "continuous"] | None
    """Take the input as steps, each of which has a delay, or as moving all the time, with one dead
    time over the record; `auto` decides it for each joint from the record [default: auto]."""
    interpolate: Literal["hold", "linear"] | None
    """The delay between two steps [default: hold]."""
    review: File | None
    """Apply a person's review, which overrides the conditions: a table with the columns
    `joint,trial,i,verdict,delay_s,note,reviewer`, as `tauscope.estimate(review_sheet=)` writes it
    and `tauscope.report(interactive=True)` saves it."""
    against: File | Sequence[File] | None
    """Show where decisions differ from those of another result: the JSON of an earlier `estimate
    --format json`, its table of `decisions=`, or another log of the experiment, which is estimated
    with the same settings. May be a list."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""
    detail: Literal["auto", "full", "lean"] | None
    """Candidates in the recording: all, or fewer of accepted segments that are not doubtful
    [default: auto]."""
    decisions: File | None
    """Write the table of decisions, as CSV or Parquet by the name's ending."""
    review_sheet: File | None
    """Write a review sheet: a table for `review=` to fill in, the most doubtful decision first."""
    delays: File | None
    """Write the delay of every sample, as CSV or Parquet."""
    table: File | None
    """Write and show the delay table: the delays by kind of step (start, stop, change, reversal)
    and level, as CSV or Parquet."""
    export: File | None
    """Write the delay table as source code that a controller looks delays up in: C99, MATLAB or
    Octave, or Python, by the name's ending."""
    steps: bool
    """Show every step: its delay with the interval, and how near the verdict was."""
    against_state: bool
    """Show what the delays depend on: speed, step size, direction, dwell, angle, time and further
    signals."""


class SweepOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.sweep`."""

    method: str | Sequence[str] | None
    """The methods by which delays are found [default: two-line,hinge,lag-aware]."""
    alpha: float | str | Sequence[float | str] | None
    """How far a segment extends before its input step and after the next one, in samples or in
    seconds as in `0.05s,0.1s` [default: 5,10,20]."""
    beta: float | str | Sequence[float | str] | None
    """Samples, or seconds, between two candidate breakpoints; for `two-line` alone [default:
    1,2,5,10]."""
    passband: float | str | Sequence[float | str] | None
    """Cutoffs of the low-pass in Hz, and `none` [default: 2,5,10,none]; for `two-line` alone."""
    tolerance: float | None
    """Two delays agree if they differ by no more than this, beyond the resolution of each (± β/2,
    or its interval) [default: 2]."""
    confidence: float | Literal["none"] | None
    """Reject a step as `nothing_happened` unless a reaction is significant at this confidence
    level; `none`: no test [default: 0.99; `none` for two-line]."""
    interval: float | None
    """Confidence level of the interval of a delay [default: 0.95]."""
    filter_order: int | None
    """Order of the low-pass [default: 4]."""
    min_delay: float | str | None
    """Reject a step that is held for fewer samples (`τ_min`), or seconds as in `0.2s` [default:
    0]."""
    max_delay: float | str | None
    """Longest delay that is searched, in samples or in seconds as in `0.5s`: useful where the
    output reaches an end stop within a hold."""
    output_limits: tuple[float, float] | str | None
    """Reject a step when the output touches a limit."""
    min_slope_change: float | None
    """Reject a step when the slope changes by less, in output units per sample [default: 0]."""
    max_sse: float | None
    """Reject a step unless the squared error of its lines is below this."""
    first_last: Literal["auto", "reject", "keep"] | None
    """Whether the first and the last step of a trial are judged [default: auto]."""
    keep_first_last: bool
    """Judge the first and the last step of a trial, as `first_last="keep"` does."""
    paper: bool
    """Algorithm 1 of Albrecht and Taylor to the letter, on any log: no rest or stop of the joint is
    looked for, and the first and the last step are rejected."""
    accept_anyway: bool
    """Accept delays although the output leads its input, does not follow it, or reacts later than
    the next step."""
    min_step: float | None
    """Count a change of the input as a step when it is more than this: for an input that was
    measured, and that has steps [default: 0]."""
    input: Literal["auto", "steps", "continuous"] | None
    """Take the input as steps, each of which has a delay, or as moving all the time, with one dead
    time over the record; `auto` decides it for each joint from the record [default: auto]."""
    steps: bool
    """Show all steps that depend on a setting, not only those that do most."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""


class CompareOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.compare`."""

    against: File | Sequence[File] | None
    """A model to compare the first one with: its errors beside the first one's, where each is
    better, and whether the difference is more than chance. The same is said of further `model=`
    files. May be a list."""
    fit: bool
    """Fit the free parameters of the model files, starting at their values."""
    horizon: float | Literal["auto", "free", "steps"] | None
    """How long a simulation runs before its angle is set to the measured one: `free` (never),
    `steps` (at every step of the input, in long holds every 2 s), seconds, or `auto`: free where
    the output follows its input, as a speed or a pressure does, else steps, where an error counts
    where it is made [default: auto]."""
    split: float | Literal["blocks", "trials"] | None
    """Share of each trial's time that is for training; `blocks`: every third block of four runs is
    for validation; or `trials`: every third trial is [default: trials from six on, else blocks]."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""


class ExplainOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.explain`."""

    effects: str | Sequence[str] | None
    """Effects that are tried, separated by commas [default: the catalogue and the candidates of the
    model file]."""
    horizon: float | Literal["auto", "free", "steps"] | None
    """How long a simulation runs before its angle is set to the measured one: `free` (never),
    `steps` (at every step of the input, in long holds every 2 s), seconds, or `auto`: free where
    the output follows its input, as a speed or a pressure does, else steps, where an error counts
    where it is made [default: auto]."""
    split: float | Literal["blocks", "trials"] | None
    """Share of each trial's time that is for training; `blocks`: every third block of four runs is
    for validation; or `trials`: every third trial is [default: trials from six on, else blocks]."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""


class AddOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.add`."""

    horizon: float | Literal["auto", "free", "steps"] | None
    """How long a simulation runs before its angle is set to the measured one: `free` (never),
    `steps` (at every step of the input, in long holds every 2 s), seconds, or `auto`: free where
    the output follows its input, as a speed or a pressure does, else steps, where an error counts
    where it is made [default: auto]."""
    split: float | Literal["blocks", "trials"] | None
    """Share of each trial's time that is for training; `blocks`: every third block of four runs is
    for validation; or `trials`: every third trial is [default: trials from six on, else blocks]."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""


class ImproveOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.improve`."""

    effects: str | Sequence[str] | None
    """Effects that are tried, separated by commas [default: the catalogue and the candidates of the
    model file]."""
    max_effects: int | None
    """How many effects are added at most [default: 8]."""
    refine: bool
    """Keep effects that are significant but have no practical consequence: without them the error
    grows by less than 3 % of the initial error beyond the noise."""
    horizon: float | Literal["auto", "free", "steps"] | None
    """How long a simulation runs before its angle is set to the measured one: `free` (never),
    `steps` (at every step of the input, in long holds every 2 s), seconds, or `auto`: free where
    the output follows its input, as a speed or a pressure does, else steps, where an error counts
    where it is made [default: auto]."""
    split: float | Literal["blocks", "trials"] | None
    """Share of each trial's time that is for training; `blocks`: every third block of four runs is
    for validation; or `trials`: every third trial is [default: trials from six on, else blocks]."""
    output: File | None
    """Record the results for the Rerun viewer."""
    threads: int | None
    """Threads to use [default: all processors]."""


class ReportOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.report`."""

    method: (
        Literal["auto", "two-line", "hinge", "lag-aware"]
        | Sequence[Literal["auto", "two-line", "hinge", "lag-aware"]]
        | None
    )
    """How a delay is found. May be a list: the first one is the answer, the others are reported
    beside it [default: auto; two-line with `paper=True` and `--follow`]."""
    alpha: float | str | None
    """How far a segment extends before its input step and after the next one, in samples or in
    seconds as in `0.1s` [default: 10]."""
    beta: float | str | None
    """Samples, or seconds, between two candidate breakpoints [default: 5]."""
    passband: float | Literal["none"] | None
    """Zero-phase low-pass on the output that Algorithm 1's lines are fitted to: its cutoff, or
    `none` [default: 5]."""
    confidence: float | Literal["none"] | None
    """Reject a step as `nothing_happened` unless a reaction is significant at this confidence
    level; `none`: no test [default: 0.99; `none` for two-line]."""
    interval: float | None
    """Confidence level of the interval of a delay [default: 0.95]."""
    filter_order: int | None
    """Order of the low-pass [default: 4]."""
    min_delay: float | str | None
    """Reject a step that is held for fewer samples (`τ_min`), or seconds as in `0.2s` [default:
    0]."""
    max_delay: float | str | None
    """Longest delay that is searched, in samples or in seconds as in `0.5s`: useful where the
    output reaches an end stop within a hold."""
    output_limits: tuple[float, float] | str | None
    """Reject a step when the output touches a limit."""
    min_slope_change: float | None
    """Reject a step when the slope changes by less, in output units per sample [default: 0]."""
    max_sse: float | None
    """Reject a step unless the squared error of its lines is below this."""
    first_last: Literal["auto", "reject", "keep"] | None
    """Whether the first and the last step of a trial are judged [default: auto]."""
    keep_first_last: bool
    """Judge the first and the last step of a trial, as `first_last="keep"` does."""
    paper: bool
    """Algorithm 1 of Albrecht and Taylor to the letter, on any log: no rest or stop of the joint is
    looked for, and the first and the last step are rejected."""
    accept_anyway: bool
    """Accept delays although the output leads its input, does not follow it, or reacts later than
    the next step."""
    min_step: float | None
    """Count a change of the input as a step when it is more than this: for an input that was
    measured, and that has steps [default: 0]."""
    input: Literal["auto", "steps", "continuous"] | None
    """Take the input as steps, each of which has a delay, or as moving all the time, with one dead
    time over the record; `auto` decides it for each joint from the record [default: auto]."""
    interpolate: Literal["hold", "linear"] | None
    """The delay between two steps [default: hold]."""
    review: File | None
    """Apply a person's review, which overrides the conditions: a table with the columns
    `joint,trial,i,verdict,delay_s,note,reviewer`, as `tauscope.estimate(review_sheet=)` writes it
    and `tauscope.report(interactive=True)` saves it."""
    against: File | Sequence[File] | None
    """Show where decisions differ from those of another result: the JSON of an earlier `estimate
    --format json`, its table of `--decisions`, or another log of the experiment, which is estimated
    with the same settings. May be a list."""
    improve: bool
    """Add to the model what it lacks, and report the error of each revision. Without a model each
    joint starts as a plain integrator; no model file is written."""
    effects: str | Sequence[str] | None
    """Effects that are tried, separated by commas [default: the catalogue and the candidates of the
    model file]."""
    max_effects: int | None
    """How many effects `improve=True` adds at most [default: 8]."""
    horizon: float | Literal["auto", "free", "steps"] | None
    """How long a simulation runs before its angle is set to the measured one: `free` (never),
    `steps` (at every step of the input, in long holds every 2 s), seconds, or `auto`: free where
    the output follows its input, as a speed or a pressure does, else steps, where an error counts
    where it is made [default: auto]."""
    split: float | Literal["blocks", "trials"] | None
    """Share of each trial's time that is for training; `blocks`: every third block of four runs is
    for validation; or `trials`: every third trial is [default: trials from six on, else blocks]."""
    no_recording: bool
    """Write no recording."""
    interactive: bool
    """Write a page beside the report, `FILE_review.html`, on which a person goes through the
    decisions, the most doubtful first, and saves a review."""
    title: str | None
    """The title of the report, instead of the log's name."""
    threads: int | None
    """Threads to use [default: all processors]."""


class DesignOptions(ReadOptions, total=False):
    """The settings of :func:`tauscope.design`."""

    uncertainty: float | None
    """Relative standard deviation of the parameters of a model given without a log [default:
    0.1]."""
    levels: float | str | Sequence[float | str] | None
    """The levels: a list, or a range with its step, as in -2,-1,0,1,2 or -2..2:0.5."""
    largest: float | None
    """Largest magnitude of the input, or of its difference to where the joint rests, where levels
    are not given [default: that of the logs, else what suits the model, else 2]."""
    hold: tuple[float, float] | str | None
    """Shortest and longest hold in seconds [default: longer than the model takes to respond, else
    1,2.5]."""
    duration: float | None
    """Length in seconds; with `separate=` the longest that is tried [default: 120, or less where
    the range cannot be kept as long; with `separate=` 60]."""
    trials: int | None
    """Largest number of trials; before each the joint is brought back to its start. 1: an
    uninterrupted input [default: as many as the range needs]."""
    rate: float | None
    """Samples per second [default: as the logs, but no more than 100 without `separate=`]."""
    seed: int | None
    """Seed of everything random [default: 1]."""
    output_range: tuple[float, float] | str | None
    """Lowest and highest output allowed; needs a model or a log. The design keeps this range with a
    margin for the error of its predictions, measured on the log, or is refused [default with
    `separate=` and a log: where the log has been]."""
    start: float | None
    """The output at which it starts [default: the middle of the range; without one, of the log, or
    0]."""
    separate: str | Sequence[str] | None
    """Two effects to distinguish. The model has one of them, or a log is given."""
    power: float | None
    """The probability of success that is wanted [default: 0.95]."""
    noise: float | None
    """Standard deviation of the measurement noise [default: that of the log, else the error in the
    model file's history]."""
    rehearsals: int | None
    """Number of simulated experiments (rehearsals) with each of the two effects [default: 40]."""
    output: File | None
    """The file of the input: `time_s`, and `<joint>.input` of each joint."""
    preview: File | None
    """Also write the input with the expected output: a table (.csv), or a page with figures
    (.html)."""
    threads: int | None
    """Threads to use [default: all processors]."""


class SimulateOptions(TypedDict, total=False):
    """The settings of :func:`tauscope.simulate`."""

    effect: str | Sequence[str] | None
    """What the joint hides, without a plant file: an effect of the catalogue or outside it, with
    the keys of its table in a plant file; without them its size follows from `strength=`. May be a
    list."""
    strength: Literal["weak", "clear"] | None
    """How clearly an effect without numbers shows: the nearest plain integrator is wrong by some 3
    times the noise, or 12 times [default: clear]."""
    seed: int | None
    """Seed of everything random [default: the plant file's, or 1]."""
    noise: float | None
    """Standard deviation of the noise of every joint [default: the plant file's, or 0.05]."""
    noise_correlation: float | None
    """Correlation of the noise of neighbouring samples [default: the plant file's, or 0]."""
    duration: float | None
    """Length of the log [default: the plant file's, or 120]."""
