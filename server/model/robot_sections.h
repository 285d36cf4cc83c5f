// SPDX-License-Identifier: MIT
// Reads [ROBOT_n] and [SWARM_n] of a scenario.
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

/// Reads the robots of one scenario, in file order. All arguments must outlive it. One thread.
class RobotSections {
 public:
  /// `beside`: the scenario's folder, which may hold controllers; nullopt if the scenario came by socket.
  RobotSections(Scenario& scenario, RobotLibrary& library, std::optional<std::filesystem::path> beside,
                Diagnostics& diagnostics)
      : scenario_(scenario), library_(library), beside_(std::move(beside)), diagnostics_(diagnostics) {}

  /// Adds the robot of a [ROBOT_n], or the two robots of a team2. Returns the bar on a team2's robots, which
  /// the caller must add.
  std::optional<WorldObject> ReadRobot(SectionReader& reader);
  /// Adds the robots of a [SWARM_n] at places clear of the objects and robots added before. So read swarms
  /// after everything else, then call SortAsInFile().
  void ReadSwarm(SectionReader& reader);
  /// Adds a robot that already exists, whose place and name are taken.
  void AddAround(RobotEntry robot) {
    const SourceLine where = robot.where;
    Add(std::move(robot), where);
  }
  /// The places of the robots read so far.
  std::vector<FloorPlace> TakenPlaces() const;
  /// Sorts the robots by section, numbers them, and sets the range of each swarm.
  void SortAsInFile();

 private:
  /// The model of the section's `type`. Sets `team` if the type means two robots. Reports an error and
  /// returns null on failure.
  std::shared_ptr<const RobotModel> ReadType(SectionReader& reader, bool& team);
  /// Adds the text of `model`, which the scenario names `type`, to the scenario's sources.
  void KeepSource(const std::string& type, const RobotModel& model);
  void ReadShared(SectionReader& reader, RobotEntry& entry);
  /// Reports keys that a robot with a controller cannot have.
  void CheckDriver(SectionReader& reader, const RobotEntry& entry);
  void ReadLosses(SectionReader& reader, RobotEntry& entry);
  void ReadWaitsFor(SectionReader& reader, RobotEntry& entry);
  /// The bar of a team2. `leader` still has the team's name.
  std::optional<WorldObject> ReadBar(SectionReader& reader, const RobotEntry& leader);
  /// `where`: line of the robot's name, for messages.
  void Add(RobotEntry entry, const SourceLine& where);
  /// Reserves a swarm's name or section name. Reports an error and returns false if a robot or another swarm
  /// has that name. All robots outside swarms must have been read.
  bool TakeSwarmName(const std::string& name, const SourceLine& where, const std::string& remedy);

  Scenario& scenario_;
  RobotLibrary& library_;
  const std::optional<std::filesystem::path> beside_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string, SourceLine> names_;        // of robots, lower case
  std::unordered_map<std::string, SourceLine> swarm_names_;  // of swarms and their sections, lower case
  std::uint64_t wanted_ = 0;                                 // robots of all swarms so far
  std::unordered_map<std::string, bool> broken_types_;       // types whose errors have been reported
};

inline constexpr const char* kControllerKey = "controller";
inline constexpr const char* kSupervisorKey = "supervisor";

/// The controller that the section's `key` names, and its file. Empty if there is none, or if errors have
/// been reported. `beside`: the scenario's folder; nullopt if the text came over a socket, which may only use
/// a bare name on the library's path. A missing controller of a recording is a warning, and its `file` is
/// empty.
ControllerChoice ReadController(SectionReader& reader, const std::string& key, const RobotLibrary& library,
                                const std::optional<std::filesystem::path>& beside);

}  // namespace coopdyn
