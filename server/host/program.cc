// SPDX-License-Identifier: MIT
#include "server/host/program.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "server/base/random.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr const char* kOutputFile = "output.txt";

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// All of it or nothing. An error text.
std::string WriteFile(const fs::path& path, std::string_view text) {
  const fs::path fresh = path.string() + ".new";
  std::ofstream file(fresh, std::ios::binary);
  file << text;
  file.close();
  std::error_code code;
  if (file.good()) fs::rename(fresh, path, code);
  if (file.good() && !code) return {};
  fs::remove(fresh, code);
  return "it cannot be kept: the disk of the server is full, or may not be written. Tell your teacher";
}

/// Where a character begins at or after `at`.
std::size_t CharacterAt(std::string_view text, std::size_t at) {
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U) ++at;
  return at;
}

std::string VersionOf(std::string_view text) {
  return fmt::format("{:016x}", HashOfBytes(text));
}

}  // namespace

Program::Program(boost::asio::io_context& context, std::string seat, fs::path folder, ProgramPlan plan,
                 const Clock& clock, std::function<void(UniqueFd)> connected, std::function<void()> on_change)
    : context_(context),
      seat_(std::move(seat)),
      folder_(std::move(folder)),
      plan_(std::move(plan)),
      clock_(clock),
      connected_(std::move(connected)),
      on_change_(std::move(on_change)),
      version_(VersionOf(text())),
      output_(ReadFile(folder_ / kOutputFile)),
      printed_(output_.size()) {}

std::string Program::text() const {
  std::error_code code;
  return ReadFile(fs::exists(file(), code) ? file() : plan_.clients / "programs" / "first_program.py");
}

std::string Program::Save(std::string_view text, std::string_view base) {
  if (text.size() > kMaxText) return "a program may have 256 KiB: this one is longer";
  const std::string version = VersionOf(text);
  std::error_code code;
  if (version == version_ && fs::exists(file(), code)) return {};
  if (base != version_) return "the program was changed meanwhile in another window of this seat";
  if (std::string error = WriteFile(file(), text); !error.empty()) return error;
  version_ = version;
  on_change_();
  return {};
}

std::string Program::Run() {
  if (run_ != nullptr && stop_words_.empty()) return "your program runs: stop it first";
  again_ = run_ != nullptr;
  if (again_) return {};
  if (plan_.clients.empty())
    return "programs cannot run on this server: it lacks the folder clients of coopdyn. Tell your teacher";
  std::error_code code;
  if (!fs::exists(file(), code)) {
    if (std::string error = WriteFile(file(), text()); !error.empty()) return error;
  }
  ProgramRun::Handlers handlers;
  handlers.print = [this](std::string_view text) { Print(text); };
  // One that is stopped must not wake the seat that is put aside.
  handlers.connected = [this](UniqueFd fd) {
    if (stop_words_.empty()) connected_(std::move(fd));
  };
  handlers.ended = [this](ProgramOutcome end) { OnEnd(std::move(end)); };
  auto run = std::make_unique<ProgramRun>(context_, std::move(handlers));
  const fs::path runner = plan_.clients / "programs" / "run_program.py";
  const std::vector<std::string> words = {plan_.python,
                                          "-I",
                                          "-S",
                                          runner.string(),
                                          seat_,
                                          file().string(),
                                          std::to_string(plan_.memory_bytes >> 20)};
  if (std::string error = run->Start(words, (folder_ / "daemon.log").string()); !error.empty()) return error;
  run_ = std::move(run);
  ++runs_;
  ran_ = version_;
  output_.clear();
  printed_ = 0;
  unsaved_ = true;
  stop_words_.clear();
  end_ = {};
  error_.clear();
  on_change_();
  return {};
}

void Program::Stop(const std::string& why) {
  again_ = false;
  if (run_ == nullptr) return;
  const bool is_stopped = !std::exchange(stop_words_, why).empty();
  if (!is_stopped) run_->Stop();
}

void Program::Print(std::string_view text) {
  output_ += text;
  printed_ += text.size();
  if (output_.size() > kMaxOutput) output_.erase(0, CharacterAt(output_, output_.size() - kMaxOutput));
  unsaved_ = true;
  on_change_();
}

void Program::OnEnd(ProgramOutcome end) {
  if (!stop_words_.empty()) end = {stop_words_, false, 0};
  end_ = std::move(end);
  if (end_.error) error_ = end_.sentence;
  ended_at_ = clock_.Now();
  const std::unique_ptr<ProgramRun> over = std::move(run_);
  unsaved_ = true;
  SaveOutput();
  on_change_();
  if (std::exchange(again_, false)) Run();
}

void Program::SaveOutput() {
  if (!std::exchange(unsaved_, false)) return;
  const bool whole = output_.empty() || output_.back() == '\n';
  const std::string how = run_ != nullptr ? "It ran at this moment." : end_.sentence;
  WriteFile(folder_ / kOutputFile, output_ + (whole ? "" : "\n") + "[" + how + "]\n");
}

json::object Program::StateJson() const {
  return {{"runs", runs()},      {"run", runs_},        {"version", version_},
          {"ran", ran_},         {"printed", printed_}, {"sentence", end_.sentence},
          {"error", end_.error}, {"line", end_.line}};
}

json::object Program::TextJson() const {
  json::object found = StateJson();
  found["text"] = text();
  return found;
}

json::object Program::OutputJson(std::uint64_t from) const {
  const std::uint64_t kept = printed_ - output_.size();
  const std::uint64_t last = printed_ - std::min<std::uint64_t>(printed_ - kept, kMaxAnswer);
  const std::uint64_t start = from > printed_ ? last : std::max({from, kept, last});
  const std::size_t at = CharacterAt(output_, static_cast<std::size_t>(start - kept));
  return {{"run", runs_}, {"from", kept + at}, {"to", printed_}, {"text", output_.substr(at)}};
}

}  // namespace coopdyn
