// SPDX-License-Identifier: MIT
// [ROBOT_n] and [SWARM_n] of a scenario.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/model/readers.h"
#include "server/model/section_reader.h"
#include "server/model/swarm.h"

namespace coopdyn {

/// Reads the robots of one scenario, in file order. Everything passed in outlives it. One thread.
class RobotSections {
 public:
  /// `beside`: the scenario's folder, where controllers may lie; nothing if it came by socket.
  RobotSections(Scenario& scenario, RobotLibrary& library, std::optional<std::filesystem::path> beside,
                Diagnostics& diagnostics)
      : scenario_(scenario), library_(library), beside_(std::move(beside)), diagnostics_(diagnostics) {}

  /// Adds the robot of a [ROBOT_n], or the two of a team2; the bar on those two, which is to be added.
  std::optional<WorldObject> ReadRobot(SectionReader& reader);
  /// Adds the robots of a [SWARM_n]; their places are those left by objects and robots added before, so read
  /// swarms after everything else and call SortAsInFile() then.
  void ReadSwarm(SectionReader& reader);
  /// A robot that stands there already: swarms leave it its place, others its name.
  void AddAround(RobotEntry robot) {
    const SourceLine where = robot.where;
    Add(std::move(robot), where);
  }
  /// Where the robots read up to now stand.
  std::vector<FloorPlace> TakenPlaces() const;
  /// Puts the robots into the order of their sections, then numbers them; says where each swarm stands.
  void SortAsInFile();

 private:
  /// The model of `type`; `team`: two of them. Null with an error.
  std::shared_ptr<const RobotModel> ReadType(SectionReader& reader, bool& team);
  /// The scenario carries the text of the `model` that it asked for as `type`.
  void KeepSource(const std::string& type, const RobotModel& model);
  void ReadShared(SectionReader& reader, RobotEntry& entry);
  /// Reports what a robot with a controller cannot have.
  void CheckDriver(SectionReader& reader, const RobotEntry& entry);
  void ReadLosses(SectionReader& reader, RobotEntry& entry);
  void ReadWaitsFor(SectionReader& reader, RobotEntry& entry);
  /// The bar of a team2 whose leader is `leader`, which has no name yet but that of the team.
  std::optional<WorldObject> ReadBar(SectionReader& reader, const RobotEntry& leader);
  /// `where`: of its name, for messages.
  void Add(RobotEntry entry, const SourceLine& where);
  /// What a swarm is called, by its name or its section; false, and reported, if a robot or another swarm is
  /// called so. Swarms are read after all robots but their own.
  bool TakeSwarmName(const std::string& name, const SourceLine& where, const std::string& remedy);

  Scenario& scenario_;
  RobotLibrary& library_;
  const std::optional<std::filesystem::path> beside_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string, SourceLine> names_;        // of robots, lower case
  std::unordered_map<std::string, SourceLine> swarm_names_;  // likewise, with what their sections are called
  std::uint64_t wanted_ = 0;                                 // robots of all swarms up to now
  std::unordered_map<std::string, bool> broken_types_;       // said what is wrong with them
};

inline constexpr const char* kControllerKey = "controller";
inline constexpr const char* kSupervisorKey = "supervisor";

/// The controller that `key` of the section names, its file found; empty if none, or with errors reported.
/// `beside`: the scenario's folder; nothing if the text came over a socket, and then only a bare name on
/// the library's path will do. What a recording names and is not there any more is a warning: its `file` is
/// empty.
ControllerChoice ReadController(SectionReader& reader, const std::string& key, const RobotLibrary& library,
                                const std::optional<std::filesystem::path>& beside);

}  // namespace coopdyn
