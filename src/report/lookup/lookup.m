function delay_s = {{ name }}(joint, level_from, level_to)
%{{ upper }} Delay in seconds of a step of the input of a joint.
%   delay_s = {{ name }}(joint, level_from, level_to), levels in the units of the log.
%   Between measured levels it is interpolated within starts, stops, changes and
%   reversals of one side and direction; beyond them it stays that of the last level.
%   NaN where no such step was measured; an error where no joint is called so.
%
{% for line in origin %}
%   {{ line }}
{% endfor %}

  % A row per curve: 0 start, 1 stop, 2 change, 3 reversal; side of neutral; whether
  % the input rises; levels; delays in seconds.
  switch joint
{% for joint in joints %}
    case '{{ joint.name }}'
      neutral = [{{ joint.low }}, {{ joint.high }}];
{% if joint.curves %}
      curves = {
{% for curve in joint.curves %}
        {{ curve.key }}, [{{ curve.levels }}], [{{ curve.delays }}] % {{ curve.support }}
{% endfor %}
      };
{% else %}
      curves = cell(0, 5);
{% endif %}
{% endfor %}
    otherwise
      error('{{ name }}:joint', 'no joint is called ''%s''', joint);
  end
  delay_s = NaN;
  before = (level_from > neutral(2)) - (level_from < neutral(1));
  after = (level_to > neutral(2)) - (level_to < neutral(1));
  if before == after
    transition = 2;
  elseif before == 0
    transition = 0;
  elseif after == 0
    transition = 1;
  else
    transition = 3;
  end
  side = after;
  level = level_to;
  if transition == 1
    side = before;
    level = level_from;
  end
  if isnan(level_from) || isnan(level_to)
    return;
  end
  for k = 1:size(curves, 1)
    if isequal([curves{k, 1:3}], [transition, side, level_to > level_from])
      levels = curves{k, 4};
      delays = curves{k, 5};
      if numel(levels) == 1
        delay_s = delays;
      else
        level = min(max(level, levels(1)), levels(end));
        j = min(find(levels <= level, 1, 'last'), numel(levels) - 1);
        part = (level - levels(j)) / (levels(j + 1) - levels(j));
        delay_s = delays(j) + (delays(j + 1) - delays(j)) * part;
      end
    end
  end
end
