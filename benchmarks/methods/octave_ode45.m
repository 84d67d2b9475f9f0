% Octave's ode45 on the benchmark's problems, restarted at every switch; called by octave.py.
% Arguments: a file of cases (a row for each: 18 constants as in equations.Device, 6 of the state,
% first mode, longest step), a file for the answers, tolerance, most seconds, times to stop at.
% Modes and switching functions as in modes.py.
1;

function at = touch (y, p)
  c = cos (y(3)); s = sin (y(3));
  r = p(3) - y(1);
  at.c = c; at.s = s;
  at.along = r * c - y(2) * s;
  at.axis = -r * s - y(2) * c;
  across = y(5) * c - y(4) * s;
  closing = -(across + y(6) * at.along);
  at.depth = p(2) + at.axis;
  at.load = p(10) * at.depth + p(11) * closing;
  at.slip = y(4) * c + y(5) * s - y(6) * at.axis;
  at.drift = y(6) * (across - closing);
end

function a = accelerations (t, y, p, at, load, friction)
  a = [friction * at.c - load * at.s - p(7) * y(4) - p(5) * (y(1) - p(16));
       load * at.c + friction * at.s - p(8) * y(5) - (y(2) - p(17)) - p(13) ...
         - sin(p(14) * t + p(15));
       (load * at.along - friction * at.axis - p(9) * y(6) - p(6) * (y(3) - p(18))) / p(4)];
end

function a = slip_acceleration (t, y, p, at, load, friction)
  a = [at.c, at.s, -at.axis] * accelerations (t, y, p, at, load, friction) + at.drift;
end

function friction = sticking_friction (t, y, p, at)
  friction = -slip_acceleration (t, y, p, at, at.load, 0) / (1 + at.axis ^ 2 / p(4));
end

function dy = rates (t, y, p, mode)
  at = touch (y, p);
  load = 0; friction = 0;
  switch mode
    case 3
      load = at.load; friction = -p(12) * load;
    case 4
      load = at.load; friction = p(12) * load;
    case 5
      load = at.load; friction = sticking_friction (t, y, p, at);
  end
  dy = [y(4:6); accelerations(t, y, p, at, load, friction)];
end

function [value, terminal, direction] = switches (t, y, p, mode)
  at = touch (y, p);
  value = [at.load; 1; p(1) - at.along];
  switch mode
    case 0
      value(1) = -at.depth;
    case 1
      value = [1; 1; -value(3)];
    case 2
      value(1:2) = [-at.load; at.depth];
    case 3
      value(2) = at.slip;
    case 4
      value(2) = -at.slip;
    case 5
      value(2) = p(12) * at.load - abs (sticking_friction (t, y, p, at));
  end
  terminal = [1; 1; 1];
  direction = [-1; -1; -1];
end

function mode = sliding (slip)
  mode = 3 + (slip < 0);
end

function [mode, y] = next_mode (t, y, p, mode, which)
  at = touch (y, p);
  if (mode == 1)
    mode = 0;
  elseif (which == 3)
    corner = y(1:2) - p(1) * [at.c; at.s] - p(2) * [-at.s; at.c];
    mode = ifelse_ (corner(1) >= -p(3) && corner(2) < 0, 6, 1);
  elseif (mode == 0)
    mode = sliding (at.slip);
  elseif (mode == 2)
    mode = ifelse_ (which == 2, 0, sliding (at.slip));
  elseif (which == 1)
    mode = ifelse_ (at.depth > 0, 2, 0);
  else
    friction = sticking_friction (t, y, p, at);
    if (mode == 5)
      mode = sliding (-friction);
    else
      impulse = -at.slip / (1 + at.axis ^ 2 / p(4));
      y(4:6) += impulse * [at.c; at.s; -at.axis / p(4)];
      free = slip_acceleration (t, y, p, at, at.load, 0);
      mode = ifelse_ (abs (friction) <= p(12) * at.load, 5, sliding (free));
    end
  end
end

function value = ifelse_ (condition, yes, no)
  if (condition) value = yes; else value = no; end
end

function answer = trajectory (case_, stops, tolerance, latest)
  p = case_(1:18); y = case_(19:24)'; mode = case_(25); longest = case_(26);
  t = 0; answer = [];
  for stop = stops
    while (t < stop && mode != 6)
      if (time () > latest) error ("out of time"); end
      for first = [longest / 10, 1e-4, 1e-6]
        options = odeset ("RelTol", tolerance, "AbsTol", tolerance, "MaxStep", longest, ...
          "InitialStep", min (first, stop - t), "Events", @(t, y) switches (t, y, p, mode));
        [times, states, te, ye, ie] = ode45 (@(t, y) rates (t, y, p, mode), [t, stop], y, options);
        if (isempty (ie) || times(end) > t + 1e-12) break; end
      end
      t = times(end); y = states(end, :)';
      if (isempty (ie) || t >= stop) continue; end
      [mode, y] = next_mode (t, y, p, mode, ie(end));
    end
    answer = [answer, y'];
  end
  if (numel (stops) == 1) answer = ifelse_ (mode == 6, t, NaN); end
  if (numel (stops) > 1 && mode == 6) answer(:) = NaN; end
end

arguments_ = argv ();
cases = load (arguments_{1});
tolerance = str2double (arguments_{3});
latest = time () + str2double (arguments_{4});
stops = cellfun (@str2double, arguments_(5:end))';
answers = [];
started = cputime ();
for i = 1:rows (cases)
  answers(i, :) = trajectory (cases(i, :), stops, tolerance, latest);
end
seconds = cputime () - started;
dlmwrite (arguments_{2}, [seconds * ones(rows (cases), 1), answers], "precision", "%.17g");
