// SPDX-License-Identifier: MIT
// The report of `coopdyn check` on one file: its format, repairs, ignored parts and their consequences,
// missing files, and how to drive it. Any thread.
#pragma once

#include <boost/json/fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/app/checker.h"
#include "server/app/drive_lines.h"

namespace coopdyn {

enum class CheckVerdict { kRuns, kRunsWithLosses, kWillNotRun };
/// "runs", "runs with losses" or "will not run".
const char* ToString(CheckVerdict verdict);

/// Similar findings, the first at `where`.
struct Finding {
  SourceLine where;
  std::string what, why;  // `why` may be empty
  int count = 1;
};

/// Files that a model names and that were not found.
struct MissingPart {
  std::string what;       // a package, a model, or a file
  int count = 1;          // missing files
  std::string bring;      // a command, or what to do
  bool collides = false;  // some of the files are for collisions; else only for drawing
};

/// A robot of a world.
struct CheckedRobot {
  std::string name;
  std::shared_ptr<const RobotModel> model;
  std::optional<DriveLines> drive;  // nullopt: no sockets
};

struct CheckReport {
  std::string file;
  std::string format;     // URDF, xacro, SDF 1.9, scenario, world, experiment
  std::string name;       // in the file
  bool has_page = false;  // true for models and SDF worlds: printed as PageOf()
  CheckVerdict verdict = CheckVerdict::kRuns;
  std::vector<std::string> lines;           // Checked::lines
  std::shared_ptr<const RobotModel> model;  // Checked::model; for a world, of its only robot with sockets
  std::vector<CheckedRobot> robots;         // of a world
  std::vector<Finding> errors, mended, left_out, harmless;
  std::vector<MissingPart> missing;
  std::optional<DriveLines> drive;  // of the first robot to drive, if any
};

/// `options`: options of `serve` with which the file was read, each preceded by a blank. Reads the file
/// again.
CheckReport MakeReport(const std::string& file, const Checked& checked, const Diagnostics& diagnostics,
                       const SearchPath& path, const std::string& options);

/// The report as text: about 40 lines, or everything if `verbose`. Each line is printable and ends with '\n'.
std::string PageOf(const CheckReport& report, bool verbose);
/// The report as one object; docs/models.md lists its fields.
boost::json::object JsonOf(const CheckReport& report);

}  // namespace coopdyn
