function varargout = @NAME@(command, varargin)
%@UPPER@ The joint @JOINT@, as a model that stands alone.
@ORIGIN@%
%   dy/dt = gain * s, where s is the input, delay seconds late, behind its effects
%
%   y = @NAME@('simulate', u, period_s, y0)   the output for each sample of u, from y0 on
%   y = @NAME@('simulate', u, period_s, y0, p, others)
%
%   s = @NAME@('init', period_s, u0, y0)      the joint at rest in y0, with u0 long held
%   s = @NAME@('init', period_s, u0, y0, p)
%   [y, s] = @NAME@('step', s, u)             the output now; then u is held for one period
%
%   p = @NAME@('parameters')                  what may be changed:
@PARAMETERS@%
%   s.others is the activity of the other joints, 0 to 1: set it before a step.
  switch command
    case 'simulate'
      varargout{1} = simulate(varargin{:});
    case 'init'
      varargout{1} = init(varargin{:});
    case 'step'
      [varargout{1}, varargout{2}] = step(varargin{:});
    case 'parameters'
      varargout{1} = defaults();
    otherwise
      error('@NAME@:command', 'no command is called ''%s''', command);
  end
end

function p = defaults()
  p = struct();
@DEFAULTS@end

function output = simulate(input, period_s, start, p, others)
  if nargin < 4 || isempty(p)
    p = defaults();
  end
  output = zeros(size(input));
  if isempty(input)
    return;
  end
  s = init(period_s, input(1), start, p);
  for k = 1:numel(input)
    if nargin >= 5
      s.others = others(k);
    end
    [output(k), s] = step(s, input(k));
  end
end

function s = init(period_s, input, output, p)
  if nargin < 4
    p = defaults();
  end
  s = struct();
  s.p = p;
  s.others = 0;
  s.period_s = period_s;
  s.sample = 0;
  s.before = input;
  s.since = 0;
  s.level = input;
  s.times = [];
  s.levels = [];
  s.angle = 0;
  s.velocity = 0;
  s.measured = 0;
  s.load_adds = 0;
@MEMORY@  at = moment(s, input, 0, period_s);
@SETTLE_DRIVE@  at = moment(s, 0, 0, period_s);
@SETTLE_LIMITS@  s.angle = at.signal;
  at = moment(s, s.angle, 0, period_s);
@SETTLE_SENSOR@  play = s.angle - at.signal;
  at = moment(s, output, 0, period_s);
@SETTLE_SENSOR@  s.angle = output + play;
  s = measure(s, 0, period_s);
end

function [output, s] = step(s, input)
  output = s.measured;
  start = s.sample * s.period_s;
  s.sample = s.sample + 1;
  s = advance(s, input, start, s.sample * s.period_s);
end

function s = advance(s, input, start, finish)
  if input ~= s.before
    s = command_level(s, input, start);
  end
  while ~isempty(s.times) && s.times(1) <= start
    s = arrive(s);
  end
  if isempty(s.times) || ~(s.times(1) < finish)
    s = pass(s, s.level, start, s.period_s);
    return;
  end
  now_s = start;
  while ~isempty(s.times) && s.times(1) < finish
    change = s.times(1);
    s = pass(s, s.level, now_s, change - now_s);
    now_s = change;
    s = arrive(s);
  end
  s = pass(s, s.level, now_s, finish - now_s);
end

% The first of the changes on their way acts from now on.
function s = arrive(s)
  s.level = s.levels(1);
  s.times(1) = [];
  s.levels(1) = [];
end

% The input changes to a level, which arrives later. A change that would act before an
% earlier one takes its place.
function s = command_level(s, level, now_s)
  delay = s.p.delay;
@TRANSPORT@  arrives = now_s + max(delay, 0);
  kept = s.times < arrives;
  s.times = [s.times(kept), arrives];
  s.levels = [s.levels(kept), level];
  s.before = level;
  s.since = now_s;
end

% Lets dt seconds pass with a constant input.
function s = pass(s, input, time, dt)
  if ~(dt > 0)
    return;
  end
  at = moment(s, input, time, dt);
@DRIVE@  at.signal = s.p.gain * at.signal;
@LOAD@  s.velocity = at.signal;
  s.angle = s.angle + s.velocity * dt;
@LIMITS@  s = measure(s, time, dt);
end

% Moves the sensor on to the present angle.
function s = measure(s, time, dt)
  at = moment(s, s.angle, time, dt);
@SENSOR@  s.measured = at.signal;
end

% What an effect sees of the joint.
function at = moment(s, signal, time, dt)
  at = struct('signal', signal, 'position', s.angle, 'velocity', s.velocity, ...
              'time', s.p.start_s + time, 'dt', dt, 'others', s.others);
end

% One of two numbers.
function number = pick(condition, yes, no)
  if condition
    number = yes;
  else
    number = no;
  end
end

% Functions of real numbers: no number where the result is none.
function y = real_sqrt(x)
  y = pick(x >= 0, sqrt(abs(x)), NaN);
end

function y = real_log(x)
  y = pick(x >= 0, log(abs(x)), NaN);
end

function y = real_log1p(x)
  y = pick(x >= -1, log1p(max(x, -1)), NaN);
end

function y = real_pow(x, n)
  y = pick(x >= 0 || n == floor(n), real(x ^ n), NaN);
end
@EFFECTS@
