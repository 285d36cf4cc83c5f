// SPDX-License-Identifier: MIT
// The commands of the program and helpers for their options. Main thread.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace coopdyn {

/// Exit codes: 0 ok; 1 the reply or a file has errors; 2 wrong use; 3 no daemon answers; 4 the run ended, but
/// a body was frozen or a controller or the recording failed; 5 the run ended before its duration.
inline constexpr int kExitOk = 0, kExitErrors = 1, kExitWrongUse = 2, kExitNoDaemon = 3, kExitFaulty = 4,
                     kExitCutShort = 5;
/// Only of `check`: a third-party model runs, but parts left out matter.
inline constexpr int kExitLosses = 2;

/// Parses the arguments and runs the command. Prints help to stdout and one line about wrong use to stderr.
/// Returns the exit code.
int RunCommandLine(int argc, const char* const* argv);

/// Runs the chosen command and returns the exit code.
using Chosen = std::function<int()>;

// Each adds its commands to `app`. Parsing one of them sets `chosen`.
/// serve, and play, which runs the same daemon over a recording. `command_line`: the whole command line,
/// stored in recordings.
void AddServe(CLI::App& app, const std::string& command_line, Chosen& chosen);
/// Reports all errors in worlds, scenarios and robot models, including those of physics.
void AddCheck(CLI::App& app, Chosen& chosen);
/// Converts YARS's experiments and MuJoCo models to coopdyn's files.
void AddConvert(CLI::App& app, Chosen& chosen);
/// list, status, run, …: one request to a running daemon.
void AddRemote(CLI::App& app, Chosen& chosen);
/// Checks each stage from the host's name to a robot's answer; prints `ok`, or cause and cure, per line.
void AddDoctor(CLI::App& app, Chosen& chosen);
/// Writes a folder with a starter controller.
void AddNewController(CLI::App& app, Chosen& chosen);
/// Prints a Markdown page about a robot, a module or a scenario, generated from the model, the command table
/// or the scenario. docs/reference contains its output.
void AddDescribe(CLI::App& app, Chosen& chosen);
/// Verifies a recorded run, or compares two runs.
void AddVerify(CLI::App& app, Chosen& chosen);
/// Exports a recorded run for other programs.
void AddExport(CLI::App& app, Chosen& chosen);
/// A class on one server: host, and seat, which changes its list.
void AddHost(CLI::App& app, Chosen& chosen);
/// Prints the contents of recordings.
void AddInfo(CLI::App& app, Chosen& chosen);

/// A finite number from `least` to `most`; `above`: greater than `least`. (CLI::Range accepts nan.)
CLI::Validator NumberIn(double least, double most, bool above = false);

/// Adds --set SECTION.key=value, which may be repeated.
void AddSettings(CLI::App* sub, std::vector<std::string>& settings);

/// A whole number from `least` to `most`.
CLI::Validator WholeIn(std::int64_t least, std::int64_t most);
/// One of `words`.
CLI::Validator OneOf(std::vector<std::string> words);

/// Explains what is wrong with the words of `app` or of its command, and what to write instead. An option
/// that is not among `arguments` came from its environment variable, if it has one.
std::string Explained(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& arguments);

// new-controller.
/// Writes folder/name with all files of a robot's controller, or of a supervisor. Prints what to do next to
/// stdout, or why it did nothing to stderr. Returns the exit code. Never overwrites files.
int NewController(const std::string& name, const std::filesystem::path& folder, bool supervisor = false);

/// A file to write; "@NAME@" in its name and text stands for the controller's name. For a supervisor, files
/// in "supervisor/" replace those of the same name. Built in from clients/plugin.
struct SkeletonFile {
  std::string name, text;
};
std::vector<SkeletonFile> SkeletonFiles();

}  // namespace coopdyn
