% SPDX-License-Identifier: MIT
% needs: fake --robots 2 --mode lockstep
% After a timeout or Ctrl-C, the next reply is the right one: the connection is reopened.
sim = coopdyn.connect();
r = sim.robot(1);
r.set_velocity(0.1, 0);
expect_error('coopdyn:timed_out', @() sim.step('timeout', 0.1), '0.1 s', 'robot2 (no client)');
w = r.get_wheels();
assert(w.left_speed == 0);
other = sim.robot(2);
for k = 1:3
  r.set_velocity(0.3, 0);
  other.set_velocity(0.4, 0);
  sim.step('timeout', 60);
end
p = r.get_pose();
assert(p.forward == 0.3);
p = other.get_pose();
assert(p.forward == 0.4);
% A request whose reply nobody read, as after Ctrl-C: the next use reopens the connection.
a = coopdyn.internal.address('', '', '', 3);
s = coopdyn.internal.Session(a, false);
link = coopdyn.internal.take_robot(s, 'robot1');
c = link.motors;
c.send(13, coopdyn.internal.encode(13, [], []));
assert(~c.idle);
reply = s.read(link, 'motors', 12, [], '');
assert(reply.command == 12 && numel(reply.data) == 6);
disp('passed')
