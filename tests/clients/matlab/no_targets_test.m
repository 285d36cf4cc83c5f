% SPDX-License-Identifier: MIT
% needs: fake --no-targets
% A world without targets: empty 1 x 0 structs with the usual fields, and an error that says so.
sim = coopdyn.connect();
r = sim.robot(1);
for k = 1:2
  s = r.sense();
  assert(isequal(size(s.targets), [1 0]) && isfield(s.targets, 'colour'));
  sim.step();
end
assert(isequal(size(r.get_targets()), [1 0]));
assert(isequal(size(r.get_robots()), [1 0]));
expect_error('coopdyn:no_such_name', @() r.sense('red'), 'there are: none');
expect_error('coopdyn:no_such_name', @() r.get_target('red'));
disp('passed')
