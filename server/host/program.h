// SPDX-License-Identifier: MIT
// The program of a seat, which a student writes in the page and runs on the server: its text, its run and
// what it printed. Text and output are files in the folder of the seat, which no program can reach. The
// io_context's thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/json.hpp>

#include "server/base/clock.h"
#include "server/host/program_run.h"

namespace coopdyn {

/// How programs are run.
struct ProgramPlan {
  std::string python;             // the interpreter of run_program.py
  std::filesystem::path clients;  // the folder clients; empty: there is none, and programs cannot run
  std::uint64_t memory_bytes = std::uint64_t{512} << 20;  // of all processes of a program
};

class Program {
 public:
  static constexpr std::size_t kMaxText = std::size_t{256} << 10;
  /// Of what it printed, the last bytes that are kept.
  static constexpr std::size_t kMaxOutput = std::size_t{256} << 10;
  /// The most of it that one answer contains.
  static constexpr std::size_t kMaxAnswer = std::size_t{64} << 10;

  /// `folder`: of the seat. `connected`: the program has connected to its simulation. `clock` outlives it.
  Program(boost::asio::io_context& context, std::string seat, std::filesystem::path folder, ProgramPlan plan,
          const Clock& clock, std::function<void(UniqueFd)> connected, std::function<void()> on_change);

  /// Keeps the text. `base`: the version on which it was made; when somebody else at the seat has changed
  /// that since, or when `text` is no program, an error text.
  std::string Save(std::string_view text, std::string_view base);
  /// Starts it, if it was just stopped after its end. An error text.
  std::string Run();
  /// `why`: the sentence that the student reads.
  void Stop(const std::string& why = "The program was stopped.");
  bool runs() const { return run_ != nullptr; }
  /// Writes what it has printed into its file, if that is not there yet.
  void SaveOutput();

  /// {"runs","run" (its number),"version" of the text,"ran" (the version that ran last),"printed"
  /// (bytes),"sentence","error","line"}
  boost::json::object StateJson() const;
  /// StateJson(), and the text.
  boost::json::object TextJson() const;
  /// {"run","from","to","text"}: what it has printed after its first `from` bytes, or the end of that.
  boost::json::object OutputJson(std::uint64_t from) const;
  /// What went wrong in the last run; empty: nothing.
  const std::string& error() const { return error_; }
  Nanoseconds ended_at() const { return ended_at_; }

 private:
  std::string text() const;
  void Print(std::string_view text);
  void OnEnd(ProgramOutcome end);
  std::filesystem::path file() const { return folder_ / "program.py"; }

  boost::asio::io_context& context_;
  const std::string seat_;
  const std::filesystem::path folder_;
  const ProgramPlan plan_;
  const Clock& clock_;
  const std::function<void(UniqueFd)> connected_;
  const std::function<void()> on_change_;

  std::unique_ptr<ProgramRun> run_;
  std::string version_;  // of the text
  std::string ran_;      // the version that ran last; empty: none since the host began
  std::string output_;   // the last of it, at most kMaxOutput
  std::uint64_t printed_ = 0;
  std::uint64_t runs_ = 0;
  bool unsaved_ = false;
  std::string stop_words_;  // empty: nobody has stopped it
  bool again_ = false;      // it is to run again after that
  ProgramOutcome end_;
  std::string error_;
  Nanoseconds ended_at_ = 0;
};

}  // namespace coopdyn
