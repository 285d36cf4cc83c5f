% SPDX-License-Identifier: MIT
function connect_as(name)
%CONNECT_AS Another client takes robot1.
  sim = coopdyn.connect('name', name);
  sim.robot(1);
end
