// SPDX-License-Identifier: MIT
// The description of a world: floor, objects and lights. Immutable once read; thread-safe.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/base/ids.h"
#include "server/geometry/image.h"
#include "server/geometry/shape.h"

namespace coopdyn {

/// Red, green, blue in 0…1.
struct Color {
  double r = 0.7, g = 0.7, b = 0.7;
  bool operator==(const Color&) const = default;
};

/// The named colours of files, e.g. "red" → (1, 0, 0); nullopt if unknown. Case-insensitive.
std::optional<Color> NamedColor(const std::string& name);
/// All colour words, in the order of the table in docs/formats.md.
const std::vector<std::string>& ColorNames();
/// The word for `color_n` of a [TARGET], n ≥ 1: red, green, blue, …, then repeating.
const std::string& PaletteName(int n);

/// The content of a file that a scenario names. A recording contains these, so it includes its world.
struct SourceText {
  std::string kind;  // world, robot, texture
  std::string
      name;  // as in the scenario: the file's name, the robot's type; WORLD:NAME for a world's texture
  std::string file;  // path as found; for messages
  std::string text;  // for a texture: its bytes in base64
};

/// A repeated picture on a thing, which replaces its colour.
struct Texture {
  std::shared_ptr<const Image> image;                  // null if none
  double width_m = 1, height_m = 1;                    // of one picture
  std::string name = {};                               // as in files: checker, grid, bricks.png
  std::shared_ptr<const SourceText> source = nullptr;  // its file, for recordings; null for patterns
};

struct Floor {
  double length_m = 20, width_m = 20, height_m = 0.1;  // along x, y, z; the top is at z = 0, centred
  Color color{0.85, 0.85, 0.85};
  double friction = 1;
  SourceLine where = {};
  Texture texture = {};

  bool IsUnder(double x_m, double y_m) const {
    return std::abs(x_m) <= length_m / 2 && std::abs(y_m) <= width_m / 2;
  }
};

/// A box, cylinder or sphere of the world; static if it has no mass.
struct WorldObject {
  std::string name;  // the section's name, e.g. WALL_1
  Shape shape;
  Pose X_WO;  // pose of its centre
  double mass_kg = 0;
  Color color;
  double friction = 1;
  SourceLine where = {};
  Texture texture = {};           // on a box: on each side
  double restitution = 0;         // fraction of the impact speed that remains: 0…1
  double rolling_friction_m = 0;  // torque against rolling, and a ball's spinning, N m per N of load
  // Initial velocities of its centre, in the world.
  Vector3 v_WO = Vector3::Zero();  // m/s
  Vector3 w_WO = Vector3::Zero();  // rad/s

  bool is_static() const { return mass_kg <= 0; }
  /// True if the objects are the same for physics, except for pose and velocity.
  bool IsAlike(const WorldObject& other) const {
    return shape == other.shape && mass_kg == other.mass_kg && friction == other.friction &&
           restitution == other.restitution && rolling_friction_m == other.rolling_friction_m;
  }
};

/// A lamp that light sensors and cameras see. Its light falls off with the square of the distance.
struct PointLight {
  std::string name;  // the section's name, e.g. LIGHT_1
  Vector3 p_WP = Vector3(0, 0, 2);
  Color color{1, 1, 1};
  double power = 1;           // reading of a sensor at 1 m
  bool casts_shadows = true;  // things hide it from light sensors
  SourceLine where;
};

/// A rectangle on the floor.
struct FloorArea {
  double center_x_m = 0, center_y_m = 0;
  double length_m = 0, width_m = 0;  // along x and y
};

/// An object section with `count` instead of `position`: copies at random places.
struct ScatteredObjects {
  WorldObject object;  // the pattern; X_WO.q: orientation before the random heading
  std::size_t count = 0;
  std::optional<double> spacing_m;    // minimum distance between the centres of two copies
  std::optional<FloorArea> area;      // copies lie completely inside; default: the floor
  std::optional<std::uint64_t> seed;  // default: the run's
};

/// The content of a .world file.
struct WorldModel {
  std::string file;  // path as found; empty if none
  std::string text;  // as read
  std::optional<Floor> floor;
  std::vector<WorldObject> objects;         // in file order
  std::vector<ScatteredObjects> scattered;  // in file order
  std::vector<PointLight> lights;           // in file order
  std::optional<double> ambient_light;      // reading of a light sensor without lamps
};

/// A coloured landmark without collision.
struct Target {
  TargetId id;
  std::string color_name;  // lower case, e.g. "red"
  Color color;
  Vector3 p_WT = Vector3::Zero();
  SourceLine where;
};

}  // namespace coopdyn
