% SPDX-License-Identifier: MIT
% Prints the readings of all sensors of robot1; sensor_program.py and sensor_program.cc are the same program.
1;
function show(what, values)
  disp([what lower(sprintf(' %.17g', double(values)))]);
end

function show_struct(what, s)
  show(what, cell2mat(struct2cell(s)));
end

function show_contacts(contacts)
  for c = contacts
    show(['contact ' c.name], [c.id c.force c.x c.y c.z c.nx c.ny c.nz]);
  end
end

function show_scan(scan)
  for k = 1:size(scan.ranges, 1)
    show('ranges', scan.ranges(k, :));
  end
  show('azimuth', scan.azimuth);
  show('elevation', scan.elevation);
  show('limits', [scan.min_range scan.max_range]);
end

function show_image(image)
  assert(isa(image, 'uint8') && size(image, 3) == 3);
  show('image', [size(image, 2), size(image, 1), sum(double(image(:))), double(squeeze(image(2, 3, :))'), ...
                 double(squeeze(image(1, end, :))')]);
end

sim = coopdyn.connect();
r = sim.robot('robot1');
sim.step(7);
show_struct('imu', r.get_imu());
show_struct('imu', r.get_imu('mast_imu'));
show_struct('wrench', r.get_wrench());
show_scan(r.get_scan());
show_scan(r.get_scan('rear_lidar'));
show_contacts(r.get_contacts());
show('bumper', r.get_bumper());
show('sonar', r.get_sonar());
show('infrared', r.get_infrared());
show('light', r.get_light());
show_struct('battery', r.get_battery());
show_struct('odometry', r.get_odometry());
show_struct('camera', r.get_camera());
[image, time, step] = r.get_image();
show_image(image);
show('when', [time step sim.steps]);
show_image(r.get_image('right_camera'));
jpeg = r.get_jpeg();
assert(isa(jpeg, 'uint8'));
show('jpeg', [numel(jpeg) double(jpeg(1:2)) sum(double(jpeg))]);
depth = r.get_depth();
assert(isa(depth, 'single'));
seen = depth(isfinite(depth));
show('depth', [size(depth, 2), size(depth, 1), depth(2, 3), depth(3, 1), min(seen), max(seen), numel(depth) - numel(seen)]);
[labels, names] = r.get_segmentation();
assert(isa(labels, 'uint16'));
show('segmentation', [size(labels, 2), size(labels, 1), double(labels(2, 3)), sum(double(labels(:)))]);
for name = names
  disp(sprintf('name %d %s', name.id, name.name));
end
for k = 1:3
  sim.step();
  s = r.sense();
  show('sense', [s.time s.step sim.steps]);
  show_struct('imu', s.imu);
  show_struct('wrench', s.wrench);
  show_scan(s.scan);
  show_contacts(s.contacts);
  show('sonar', s.sonar);
  show('infrared', s.infrared);
  show('light', s.light);
  show_struct('battery', s.battery);
  show_struct('odometry', s.odometry);
  [image, time, step] = r.get_image();
  show('when', [step sim.steps]);
end
r.subscribe('light');
r.subscribe('rear_lidar');
sim.step();
for module = {'light', 'rear_lidar'}
  pushed = r.next(module{1}, 'timeout', 60);
  show('pushed', pushed.value);
end
sim.close();
