// SPDX-License-Identifier: MIT
// The commands of the program, and what their options share. Main thread.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace coopdyn {

/// Exit codes: 0 ok; 1 the reply or a file has errors; 2 wrong use; 3 no daemon there; 4 the run ended but a
/// body was frozen, a controller failed or the recording did; 5 the run was cut short before its duration.
inline constexpr int kExitOk = 0, kExitErrors = 1, kExitWrongUse = 2, kExitNoDaemon = 3, kExitFaulty = 4,
                     kExitCutShort = 5;
/// Of `check` alone: a model of others runs, but what is left out of it matters.
inline constexpr int kExitLosses = 2;

/// Parses the arguments and does what they ask for. Prints help to stdout and one line about wrong use to
/// stderr. Returns the exit code.
int RunCommandLine(int argc, const char* const* argv);

/// Does what a command asks for and returns the exit code.
using Chosen = std::function<int()>;

// Each adds its commands to `app`. Parsing one of them sets `chosen`.
/// serve, and play, which runs the same daemon over a recording. `command_line`: all of it; a recording says
/// it.
void AddServe(CLI::App& app, const std::string& command_line, Chosen& chosen);
/// Says everything that is wrong in worlds, scenarios and robot models, physics included.
void AddCheck(CLI::App& app, Chosen& chosen);
/// YARS's experiments as coopdyn's own files.
void AddConvert(CLI::App& app, Chosen& chosen);
/// list, status, run, …: one request to a running daemon.
void AddRemote(CLI::App& app, Chosen& chosen);
/// Walks from the host's name to a robot that answers; `ok`, or cause and cure, per line.
void AddDoctor(CLI::App& app, Chosen& chosen);
/// A folder with a controller to begin with.
void AddNewController(CLI::App& app, Chosen& chosen);
/// A page of Markdown about a robot, a module or a scenario, made from the model, the command table or the
/// scenario itself. docs/reference holds what it prints.
void AddDescribe(CLI::App& app, Chosen& chosen);
/// Is a recorded run what it says; or, are two runs the same.
void AddVerify(CLI::App& app, Chosen& chosen);
/// A recorded run for other programs.
void AddExport(CLI::App& app, Chosen& chosen);
/// A class on one server: host, and seat, which changes its list.
void AddHost(CLI::App& app, Chosen& chosen);
/// What recordings hold.
void AddInfo(CLI::App& app, Chosen& chosen);

/// A finite number from `least` to `most`; `above`: greater than `least`. (CLI::Range takes nan for a
/// number.)
CLI::Validator NumberIn(double least, double most, bool above = false);

/// --set SECTION.key=value, any number of times.
void AddSettings(CLI::App* sub, std::vector<std::string>& settings);

/// A whole number from `least` to `most`.
CLI::Validator WholeIn(std::int64_t least, std::int64_t most);
/// One of `words`.
CLI::Validator OneOf(std::vector<std::string> words);

/// What is wrong with the words of `app` or of its command, and what to write instead. An option that is not
/// among `arguments` came by its variable, if it has one.
std::string Explained(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& arguments);

// new-controller.
/// Writes folder/name with all files of a robot's controller, or of a supervisor; says on stdout what to do
/// next, or on stderr why it did nothing. Returns the exit code. Nothing that exists is overwritten.
int NewController(const std::string& name, const std::filesystem::path& folder, bool supervisor = false);

/// A file to write; "@NAME@" in its name and text stands for the controller's name. One in "supervisor/"
/// takes the place of that name if a supervisor is wanted. Built in from clients/plugin.
struct SkeletonFile {
  std::string name, text;
};
std::vector<SkeletonFile> SkeletonFiles();

}  // namespace coopdyn
