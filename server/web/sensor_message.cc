// SPDX-License-Identifier: MIT
#include "server/web/sensor_message.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "server/sensing/sensor_shapes.h"

namespace coopdyn {

namespace {

void AppendU32(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift & 0xffU);
}

/// Vertices: first all places, then all colours.
class Vertices {
 public:
  void Add(const Vector3& p_W, const Rgba& color) {
    for (const double x : p_W) AppendU32(places_, std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    for (const double part : {color.r, color.g, color.b, color.a})
      colors_ += static_cast<char>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
  }
  void AppendTo(std::string& bytes) const { bytes.append(places_).append(colors_); }

 private:
  std::string places_, colors_;
};

}  // namespace

std::string SensorMessage(const Frame& frame, std::size_t most) {
  const SensorShapes shapes = ShapesOfSensors(
      frame, [](const Vector3&, double) { return true; }, most);
  Vertices vertices;
  for (const auto& [corners_W, color] : shapes.triangles) {
    for (const Vector3& corner_W : corners_W) vertices.Add(corner_W, color);
  }
  for (const SensorShapes::Line& line : shapes.lines) {
    vertices.Add(line.from_W, line.color);
    vertices.Add(line.to_W, line.color);
  }
  for (const SensorShapes::Dot& dot : shapes.dots) vertices.Add(dot.p_W, dot.color);
  std::string message{kSensorMessageType, 0, 0, 0};
  for (const std::size_t count : {shapes.triangles.size(), shapes.lines.size(), shapes.dots.size()})
    AppendU32(message, static_cast<std::uint32_t>(count));
  vertices.AppendTo(message);
  return message;
}

}  // namespace coopdyn
