// SPDX-License-Identifier: MIT
// What an experiment says, whatever its grammar: SI units, poses in the world.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

/// A shape of a rigid body.
struct Part {
  Shape shape = Sphere{};
  Pose X_BG;  // in its body
  double mass_kg = 0;
  std::string colour;  // "r g b"; empty: its body's
  int line = 0;
  std::string mesh_file{};  // of a Mesh, whose data nobody has read yet
};

struct Body {
  std::string name;
  Pose X_WB;
  std::vector<Part> parts;
  double mass_kg = 0;  // of all its parts; 0: it stands fixed
  double friction = 0;
  double restitution = 0;
  std::optional<Vector3> centre_of_mass;  // instead of that of its parts
  std::string colour;
  int line = 0;
};

/// What sensors and joints name: a body, or a part of it.
struct Named {
  std::string name;
  int body = 0;  // index into Movable::bodies
  Pose X_WN;
  int line = 0;
};

struct Joint {
  enum class Kind { kHinge, kSlider, kBall, kFixed, kSixAxis };
  static constexpr int kWorld = -1;

  std::string name;
  Kind kind = Kind::kHinge;
  int source = 0, destination = kWorld;  // index into Movable::bodies
  Pose X_WJ;                             // its axis is x
  /// Its position counts how the source moves against the destination, not the other way round.
  bool counts_source = true;
  bool is_driven = false;
  bool is_wheel = false;  // driven by velocity
  double max_effort = 0, max_velocity = 0;
  std::optional<std::pair<double, double>> limit;  // least and most position, rad or m
  double friction = 0, damping = 0, stiffness = 0, rest = 0;
  /// Of a kSixAxis, from the source on: hinges and sliders called x, y, z, rx, ry, rz, along the axes of
  /// X_WJ.
  std::vector<Joint> axes{};
  int line = 0;
};

struct Sensor {
  enum class Kind { kProximity, kLight, kCompass, kContact, kImu, kSharp, kCamera };

  std::string name;
  Kind kind = Kind::kProximity;
  int body = 0;
  Pose X_WS;  // it looks along x
  double range_m = 0;
  double opening_deg = 0;  // of the whole cone or fan
  int rays = 1;
  double noise = 0;
  int width = 320, height = 240;
  int line = 0;
};

/// What each reset draws: x, y, z, gamma (degrees), mass, friction, power or value, from the least to the
/// most.
struct Random {
  std::map<std::string, std::pair<double, double>> ranges;
  int line = 0;
};

/// A robot, or what stands or lies about: bodies and what joins them.
struct Movable {
  std::string name;
  Pose X_WM;  // its own pose
  std::vector<Body> bodies;
  std::vector<Named> names;
  std::vector<Joint> joints;
  std::vector<Sensor> sensors;
  std::string controller;  // "NAME key=value …"; empty: clients drive it
  std::string colour;
  Random random;
  bool is_robot = false;
  int line = 0;
};

struct Light {
  Vector3 p_W = Vector3::Zero();
  std::string colour;
  double power = 1;
  bool shadows = true;
  Random random;
  int line = 0;
};

/// A line of a section: its key with its value.
struct Setting {
  std::string text;
  int line = 0;
};

struct Experiment {
  std::vector<Setting> simulation, floor;  // lines of these sections
  std::optional<std::pair<double, double>> floor_size;
  Random ambient;  // its value
  std::vector<Light> lights;
  std::vector<Movable> things, robots;
};

}  // namespace coopdyn::rosiml
