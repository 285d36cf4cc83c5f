// SPDX-License-Identifier: MIT
// What `coopdyn check` tells of one file: what it is, what was mended, what is left out and why that matters,
// what is missing, and how it is driven. Any thread.
#pragma once

#include <boost/json/fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/app/checker.h"
#include "server/app/drive_lines.h"

namespace coopdyn {

enum class CheckVerdict { kRuns, kRunsWithLosses, kWillNotRun };
/// runs, runs with losses, will not run.
const char* ToString(CheckVerdict verdict);

/// Something that was found, at `where` first.
struct Finding {
  SourceLine where;
  std::string what, why;  // `why` may be empty
  int count = 1;          // how many alike
};

/// Files that a model names and that are nowhere.
struct MissingPart {
  std::string what;       // a package, a model, or a file
  int count = 1;          // of its files
  std::string bring;      // a command, or what to do
  bool collides = false;  // some of it; else it is only drawn
};

/// One of a world.
struct CheckedRobot {
  std::string name;
  std::shared_ptr<const RobotModel> model;
  std::optional<DriveLines> drive;  // nothing: it has no sockets
};

struct CheckReport {
  std::string file;
  std::string format;     // URDF, xacro, SDF 1.9, scenario, world, experiment
  std::string name;       // in the file
  bool has_page = false;  // a model, or a world in SDF
  CheckVerdict verdict = CheckVerdict::kRuns;
  std::vector<std::string> lines;           // Checked::lines
  std::shared_ptr<const RobotModel> model;  // as there; of a world: of its only robot with sockets
  std::vector<CheckedRobot> robots;         // of a world
  std::vector<Finding> errors, mended, left_out, harmless;
  std::vector<MissingPart> missing;
  std::optional<DriveLines> drive;  // of the robot that is driven first, if there is one
};

/// `options`: with which it was read, for `serve` (each begins with a blank). Reads the file once more.
CheckReport MakeReport(const std::string& file, const Checked& checked, const Diagnostics& diagnostics,
                       const SearchPath& path, const std::string& options);

/// The page: about 40 lines, with `verbose` all of it. Each line ends in '\n' and is printable.
std::string PageOf(const CheckReport& report, bool verbose);
/// One object, docs/models.md has its fields.
boost::json::object JsonOf(const CheckReport& report);

}  // namespace coopdyn
