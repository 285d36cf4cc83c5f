// SPDX-License-Identifier: MIT
// Readings of the sensors of robot models. SI units; docs/protocol.md defines the frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace coopdyn::client {

/// The sensor's orientation in the world as a quaternion; angular velocity [rad/s] and acceleration [m/s²] in
/// the sensor's frame: at rest and level, az = 9.81.
struct Imu {
  double qw = 1, qx = 0, qy = 0, qz = 0, wx = 0, wy = 0, wz = 0, ax = 0, ay = 0, az = 0;
};
/// Force [N] and torque [N m] through a joint, in the sensor's frame.
struct Wrench {
  double fx = 0, fy = 0, fz = 0, tx = 0, ty = 0, tz = 0;
};
/// Ranges [m] of a lidar, row by row from the lowest, each from right to left; inf = nothing in range, 0 =
/// nearer than min_range. `azimuth` [rad] of each column, left positive; `elevation` [rad] of each row, up
/// positive.
struct Scan {
  std::vector<double> ranges = {}, azimuth = {}, elevation = {};
  double min_range = 0, max_range = 0;

  /// @pre row < elevation.size() and column < azimuth.size()
  double at(std::size_t row, std::size_t column) const { return ranges[row * azimuth.size() + column]; }
};
/// A contact of the robot: id and name of the other thing (0: the floor; in sense() -1 and no name), force
/// [N], point [m] and the direction of the force on the robot, in the robot's frame.
struct Contact {
  int id = -1;
  std::string name = {};
  double force = 0, x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
};
/// Size, focal lengths and principal point of a camera [pixels], near and far limit of its view [m], and its
/// rate [Hz; 0 = each step].
struct Camera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0, near = 0, far = 0, rate = 0;
};
/// Remaining energy of the battery [J, and as a fraction 0 to 1], and the power drawn [W].
struct Battery {
  double energy = 0, fraction = 0, power = 0;
};
/// Pose since the start and velocity by the wheels' encoders [m, rad, m/s, rad/s].
struct Odometry {
  double x = 0, y = 0, heading = 0, forward = 0, turn = 0;
};

/// The pixels of a picture, row by row from the upper left corner, taken at `time` [s] in `step`.
template <class T>
struct Raster {
  int width = 0, height = 0;
  std::vector<T> data = {};
  double time = 0;
  std::int64_t step = -1;

  /// The pixel in column x and row y, from 0. @pre it is in the picture
  const T& at(int x, int y) const { return data[static_cast<std::size_t>(y) * width + x]; }
};
/// Red, green and blue, 0 to 255.
struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};
struct Image : Raster<Rgb> {
  Rgb rgb(int x, int y) const { return at(x, y); }
};
/// The distance of each pixel along the camera's axis [m]; inf = nothing there.
struct Depth : Raster<float> {};
/// The object that each pixel shows, as a number (0 = nothing), and the objects' names by number.
struct Segmentation : Raster<std::uint16_t> {
  std::map<int, std::string> names = {};
};

}  // namespace coopdyn::client
