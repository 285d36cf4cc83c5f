// SPDX-License-Identifier: MIT
// The worlds of `coopdyn bench sensors`: a room with sixty things and a robot with every kind of sensor; and
// hills of 100,352 triangles. Pure except for reading the shipped turtle.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/app/options.h"
#include "server/state/frame.h"

namespace coopdyn {

struct CameraSize {
  const char* module;
  int width, height;
};
/// Of the robot's cameras.
inline constexpr std::array<CameraSize, 3> kCameraSizes{
    {{"camera_64", 64, 48}, {"camera_320", 320, 240}, {"camera_640", 640, 480}}};

/// The sensors that replace the turtle's.
enum class Sensors { kNone, kComputed, kAll };  // kComputed: without those that physics measures

/// The SDF of a turtle with these sensors. Throws std::runtime_error if there is no turtle.
std::string TurtleWith(Sensors sensors, const SearchPath& path);

/// The files of the room with `robots` robots: robots/bench_turtle/model.sdf and bench.scenario.
std::map<std::string, std::string> RoomFiles(Sensors sensors, int robots, const SearchPath& path);

/// The scene of such files. Throws std::runtime_error with the errors.
std::shared_ptr<const Scene> RoomOf(const std::map<std::string, std::string>& files, const SearchPath& path);

/// Hills around the robot, without the room.
std::shared_ptr<const Scene> HillsAround(const Scene& room);

/// `count` frames in which the first robot has different poses; the others stay. Measurements of physics are
/// 0.
std::vector<std::unique_ptr<const Frame>> FramesOf(const std::shared_ptr<const Scene>& scene, int count);

}  // namespace coopdyn
