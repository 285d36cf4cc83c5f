% SPDX-License-Identifier: MIT
% needs: daemon transport --mode lockstep
% A call of a function or operator costs Octave microseconds, nearly all the time of a step: a step makes few calls.
sim = coopdyn.connect();
team = sim.team();
team.select('distances', 'targets', 'support', 'pose');
V = zeros(team.n, 2);
team.step(V);
least = Inf;
for k = 1:20  % a reply that is late costs more
  profile clear
  profile on
  team.step(V);
  profile off
  least = min(least, sum([profile('info').FunctionTable.NumCalls]));
end
assert(least < 130, sprintf('%d calls', least));
sim.close();
disp('passed')
