function varargout = {{ name }}(command, varargin)
%{{ name | upper }} The joint {{ joint }}, as a model that stands alone.
{% for line in origin %}
%   {{ line }}
{% endfor %}
%
%   dy/dt = gain * s, where s is the input, delay seconds late, after its effects
%
%   y = {{ name }}('simulate', u, period_s, y0)   the output for each sample of u, from y0 on
%   y = {{ name }}('simulate', u, period_s, y0, p, others)
%
%   s = {{ name }}('init', period_s, u0, y0)      the joint at rest in y0, with u0 long held
%   s = {{ name }}('init', period_s, u0, y0, p)
%   [y, s] = {{ name }}('step', s, u)             the output now; then u is held for one period
%
%   p = {{ name }}('parameters')                  what may be changed:
{% for p in parameters %}
%     p.{{ p.name }}: {{ p.described }}; {{ p.value }}
{% endfor %}
%
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
      error('{{ name }}:command', 'no command is called ''%s''', command);
  end
end

function p = defaults()
  p = struct();
{% for p in parameters %}
  p.{{ p.name }} = {{ p.value }};
{% endfor %}
end

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
{% for name in memory %}
  s.{{ name }} = 0;
{% endfor %}
  at = moment(s, input, 0, period_s);
{% for e in drive %}
{% if e.settle.lines %}
  s = effect_{{ e.id }}_settle(s, at);
{% endif %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  at = moment(s, 0, 0, period_s);
{% for e in limits %}
{% if e.settle.lines %}
  s = effect_{{ e.id }}_settle(s, at);
{% endif %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  s.angle = at.signal;
  at = moment(s, s.angle, 0, period_s);
{% for e in sensor %}
{% if e.settle.lines %}
  s = effect_{{ e.id }}_settle(s, at);
{% endif %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  play = s.angle - at.signal;
  at = moment(s, output, 0, period_s);
{% for e in sensor %}
{% if e.settle.lines %}
  s = effect_{{ e.id }}_settle(s, at);
{% endif %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  s.angle = output + play;
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
{% if transport %}
  at = struct('before', s.before, 'after', level, 'held', now_s - s.since, ...
              'time', s.p.start_s + now_s);
{% for e in transport %}
  delay = delay + effect_{{ e.id }}(s, at);
{% endfor %}
{% endif %}
  arrives = now_s + max(delay, 0);
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
{% for e in drive %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  at.signal = s.p.gain * at.signal;
{% if load %}
  commanded = at.signal;
  at.position = at.position + 0.5 * dt * (commanded + s.load_adds);
  at.time = at.time + 0.5 * dt;
{% for e in load %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  s.load_adds = at.signal - commanded;
{% endif %}
  s.velocity = at.signal;
  s.angle = s.angle + s.velocity * dt;
{% if limits %}
  at = moment(s, s.angle, time, dt);
{% for e in limits %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  if at.signal ~= s.angle
    s.velocity = 0;
  end
  s.angle = at.signal;
{% endif %}
  s = measure(s, time, dt);
end

% Moves the sensor on to the present angle.
function s = measure(s, time, dt)
  at = moment(s, s.angle, time, dt);
{% for e in sensor %}
  [at.signal, s] = effect_{{ e.id }}(s, at);
{% endfor %}
  s.measured = at.signal;
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
{% for e in effects %}

% {{ e.id }}: {{ e.summary }}
%   {{ e.equation }}
function [{{ e.step.result }}, s] = effect_{{ e.id }}(s, at)
{% for line in e.step.lines %}
  {{ line }}
{% endfor %}
end
{% if e.settle.lines %}

function s = effect_{{ e.id }}_settle(s, at)
{% for line in e.settle.lines %}
  {{ line }}
{% endfor %}
end
{% endif %}
{% endfor %}

