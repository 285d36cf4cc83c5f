// SPDX-License-Identifier: MIT
#include "server/model/section_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "server/model/readers.h"
#include "server/model/text_file.h"
#include "server/model/textures.h"

namespace coopdyn {

namespace {

constexpr double kMaxFriction = 1e3, kMaxLightPower = 1e6;

const std::array<std::string, 3> kTypes = {"box", "cylinder", "sphere"};

/// True if `a` and `b` are equal up to rounding.
bool Same(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::abs(a);
}

std::optional<Shape> ReadShape(SectionReader& reader, std::size_t type) {
  const auto numbers = [&](std::initializer_list<std::size_t> counts, const std::string& form) {
    return reader.Numbers("size", Quantity::kLength, counts, form, kMinFileSize_m, kMaxFileLength_m);
  };
  if (type == 0) {
    const auto size = numbers({3}, "length width height of a box");
    if (!size) return std::nullopt;
    return Box{Vector3((*size)[0], (*size)[1], (*size)[2])};
  }
  if (type == 1) {
    const auto size = numbers({3}, "diameter diameter height of a cylinder");
    if (!size) return std::nullopt;
    if (!Same((*size)[0], (*size)[1])) {
      reader.ErrorAt("size", "the two diameters of a cylinder must be equal, not " +
                                 FormatNumber((*size)[0]) + " and " + FormatNumber((*size)[1]));
      return std::nullopt;
    }
    return Cylinder{(*size)[0] / 2, (*size)[2]};
  }
  const auto size = numbers({1, 3}, "diameter of a sphere");
  if (!size) return std::nullopt;
  if (size->size() == 3 && (!Same((*size)[0], (*size)[1]) || !Same((*size)[0], (*size)[2]))) {
    reader.ErrorAt("size", "the three diameters of a sphere must be equal: write one");
    return std::nullopt;
  }
  return Sphere{(*size)[0] / 2};
}

/// The default rolling friction of a moving thing: 0.5 % of its radius, so that balls of all sizes roll
/// equally far.
double UsualRollingFriction_m(const Shape& shape) {
  constexpr double kShare = 0.005;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return kShare * sphere->radius_m;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return kShare * cylinder->radius_m;
  return 0;
}

/// The vector x y z of `key`, of length at most `most`.
std::optional<Vector3> ReadMotion(SectionReader& reader, const std::string& key, Quantity quantity,
                                  const std::string& unit, double most) {
  const auto numbers = reader.Numbers(key, quantity, {3}, "x y z in " + unit, -most, most);
  if (!numbers) return std::nullopt;
  const Vector3 motion((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  if (motion.norm() <= most) return motion;
  reader.ErrorAt(key, "'" + key + "' is at most " + FormatNumber(most) + " " + unit + " in all, not " +
                          FormatNumber(motion.norm()));
  return std::nullopt;
}

/// Reads a thing's contact properties and initial motion. @pre `object` has its shape and mass
void ReadTouchAndMotion(SectionReader& reader, WorldObject& object) {
  constexpr double kMaxSpeed_m_s = 90,
                   kMaxTurnRate_rad_s = 9000;  // physics freezes a body slightly above these
  Take(reader.Number("friction", Quantity::kPlain, 0, kMaxFriction), object.friction);
  Take(reader.Number("bounce", Quantity::kPlain, 0, 1), object.restitution);
  if (!object.is_static()) object.rolling_friction_m = UsualRollingFriction_m(object.shape);
  Take(reader.Number("rolling_friction", Quantity::kLength, 0, kMaxFriction), object.rolling_friction_m);
  Take(ReadMotion(reader, "velocity", Quantity::kPlain, "m/s", kMaxSpeed_m_s), object.v_WO);
  Take(ReadMotion(reader, "turn_rate", Quantity::kAngle, "rad/s", kMaxTurnRate_rad_s), object.w_WO);
  for (const char* key : {"velocity", "turn_rate"}) {
    if (!object.is_static() || !reader.Has(key)) continue;
    reader.ErrorAt(key, "'" + std::string(key) + "' needs a 'mass', for example 'mass 1': without it " +
                            reader.title() + " never moves");
  }
}

}  // namespace

Floor ReadFloor(SectionReader& reader, Textures& textures, std::optional<double>& ambient_light) {
  Floor floor;
  floor.where = reader.where();
  reader.Has("angles");
  const auto size = reader.Numbers("size", Quantity::kLength, {2, 3}, "length width height", kMinFileSize_m,
                                   kMaxFileLength_m);
  if (size) {
    floor.length_m = (*size)[0];
    floor.width_m = (*size)[1];
    if (size->size() == 3) floor.height_m = (*size)[2];
  }
  Take(reader.ColorValue("color"), floor.color);
  Take(reader.Number("friction", Quantity::kPlain, 0, kMaxFriction), floor.friction);
  floor.texture = textures.Read(reader, floor.color);
  if (const auto light = ReadAmbientLight(reader)) ambient_light = light;
  reader.Finish();
  return floor;
}

std::optional<double> ReadAmbientLight(SectionReader& reader) {
  return reader.Number("ambient_light", Quantity::kPlain, 0, kMaxLightPower);
}

std::optional<double> ReadWatchdog(SectionReader& reader) {
  constexpr const char* kKey = "watchdog";
  constexpr double kMin_s = 0.1, kMax_s = 1e6;
  const std::optional<std::string> text = reader.Text(kKey);
  if (!text) return std::nullopt;
  if (ToLower(*text) == "off") return 0.0;
  if (std::isdigit(static_cast<unsigned char>(text->front())) != 0)
    return reader.Number(kKey, Quantity::kTime, kMin_s, kMax_s);
  reader.ErrorAt(kKey,
                 "'watchdog' says how long a robot's client may be silent, for example 'watchdog 2s', or is "
                 "'off', not '" +
                     *text + "'");
  return std::nullopt;
}

std::optional<PointLight> ReadLight(SectionReader& reader) {
  PointLight light;
  light.name = reader.section().name;
  light.where = reader.where();
  reader.Require("position", "position 2 0 1.5");
  const auto position =
      reader.Numbers("position", Quantity::kLength, {3}, "x y z", -kMaxFileLength_m, kMaxFileLength_m);
  Take(reader.ColorValue("color"), light.color);
  Take(reader.Number("power", Quantity::kPlain, 0, kMaxLightPower), light.power);
  Take(reader.YesNo("shadows"), light.casts_shadows);
  if (reader.Has("type") || reader.Has("size")) {
    reader.Error(reader.title() +
                 " is a lamp, with position, color, power and shadows: call a thing otherwise");
    return std::nullopt;
  }
  reader.Finish();
  if (!position) return std::nullopt;
  light.p_WP = Vector3((*position)[0], (*position)[1], (*position)[2]);
  return light;
}

std::optional<FloorArea> ReadArea(SectionReader& reader) {
  const auto area = reader.Numbers("area", Quantity::kLength, {4}, "x y of the centre, length, width",
                                   -kMaxFileLength_m, kMaxFileLength_m);
  if (!area) return std::nullopt;
  if ((*area)[2] <= 0 || (*area)[3] <= 0) {
    reader.ErrorAt("area", "length and width of the area must be above 0");
    return std::nullopt;
  }
  return FloorArea{(*area)[0], (*area)[1], (*area)[2], (*area)[3]};
}

ObjectSection ReadObject(SectionReader& reader, std::span<const std::string> other_sections,
                         Textures& textures) {
  const std::string near = Nearest(reader.section().name, other_sections);
  WorldObject object;
  object.name = reader.section().name;
  object.where = reader.where();
  const bool has_type = reader.Has("type");
  const std::optional<std::size_t> type = reader.Choice("type", kTypes);
  if (!has_type) {
    reader.Error(reader.title() + " is an object and needs 'type box', 'type cylinder' or 'type sphere'" +
                 (near.empty() ? "" : "; or did you mean [" + near + "]?"));
  }
  reader.Require("size", "size 1 0.5 0.3");
  const bool many = reader.Has("count");
  if (!many) reader.Require("position", "position 2 0");
  // A size can only be checked if the type is known.
  const std::optional<Shape> shape = type ? ReadShape(reader, *type) : std::nullopt;
  if (!type) reader.Has("size");
  const auto position = reader.Numbers("position", Quantity::kLength, {2, 3}, "x y, or x y z of the centre",
                                       -kMaxFileLength_m, kMaxFileLength_m);
  Take(reader.Orientation("orientation"), object.X_WO.q);
  if (const auto mass = reader.Number("mass", Quantity::kMass, 0, kMaxFileMass_kg)) {
    object.mass_kg = *mass;
    if (*mass > 0 && *mass < kMinFileMass_kg) {
      reader.ErrorAt("mass", "a mass below 1 mg cannot be simulated: write 0 for something that never moves");
    }
  }
  Take(reader.ColorValue("color"), object.color);
  if (shape) object.shape = *shape;
  ReadTouchAndMotion(reader, object);
  object.texture = textures.Read(reader, object.color);
  ScatteredObjects scattered;
  const auto count = reader.WholeNumber("count", 1, kMaxSwarm);
  if (many) {
    scattered.count = count.value_or(0);
    scattered.spacing_m = reader.Number("spacing", Quantity::kLength, 0, kMaxFileLength_m);
    scattered.area = ReadArea(reader);
    scattered.seed = reader.WholeNumber("seed", 0, kMaxSeed);
    if (reader.Has("position")) {
      reader.ErrorAt("position",
                     "'position' and 'count' exclude each other: with 'count' the places are found, in an "
                     "'area x y length width' if given");
    }
  }
  // If the section's name is misspelt, every key would be unknown: one diagnostic is enough.
  if (has_type || near.empty()) reader.Finish();
  if (!shape) return {};
  if (many) {
    if (!count) return {};
    scattered.object = std::move(object);
    return {std::nullopt, std::move(scattered)};
  }
  if (!position) return {};
  const double z = position->size() == 3 ? (*position)[2] : HalfExtents(object.shape, object.X_WO.q).z();
  object.X_WO.p = Vector3((*position)[0], (*position)[1], z);
  return {std::move(object), std::nullopt};
}

bool IsNumbered(const std::string& word, const std::string& kind) {
  return word == kind || word.starts_with(kind + "_");
}

WorldModel ReadWorld(const std::string& text, const std::string& file, Diagnostics& diagnostics,
                     Textures* textures) {
  WorldModel world;
  Textures none;
  if (textures == nullptr) textures = &none;
  world.file = file;
  std::optional<std::string> decoded = DecodeText(text, {file, 0}, diagnostics);
  if (!decoded) return world;
  world.text = std::move(*decoded);
  const std::vector<Section> sections = ReadSections(world.text, file, diagnostics);
  const auto floor =
      std::find_if(sections.begin(), sections.end(), [](const Section& s) { return s.word == "floor"; });
  const bool degrees = floor != sections.end() && SaysDegrees(*floor, file, diagnostics);
  const std::vector<std::string> own = {"FLOOR", "LIGHT_1"};
  for (const Section& section : sections) {
    if (diagnostics.StopAt({file, section.line})) break;
    SectionReader reader(section, file, degrees, diagnostics);
    if (section.word == "floor") {
      if (!world.floor) world.floor = ReadFloor(reader, *textures, world.ambient_light);
      continue;
    }
    if (IsNumbered(section.word, "light")) {
      if (auto light = ReadLight(reader)) world.lights.push_back(std::move(*light));
      continue;
    }
    const bool scenarios = section.word == "world" || section.word == "simulation" ||
                           section.word == "target" || IsNumbered(section.word, "robot") ||
                           IsNumbered(section.word, "swarm") || IsNumbered(section.word, "random");
    if (scenarios) {
      reader.Error(reader.title() +
                   " belongs into a .scenario; a .world has [FLOOR], lights and objects only");
      continue;
    }
    ObjectSection read = ReadObject(reader, own, *textures);
    if (read.object) world.objects.push_back(std::move(*read.object));
    if (read.scattered) world.scattered.push_back(std::move(*read.scattered));
  }
  return world;
}

}  // namespace coopdyn
