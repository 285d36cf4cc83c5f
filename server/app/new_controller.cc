// SPDX-License-Identifier: MIT
#include <fstream>
#include <map>
#include <memory>
#include <string_view>
#include <system_error>

#include "server/app/commands.h"
#include "server/app/print.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 63;
constexpr std::string_view kOfSupervisor = "supervisor/";

bool IsControllerName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName && name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// `name` with invalid characters replaced or removed; empty if nothing remains.
std::string NearestName(const std::string& name) {
  std::string near;
  for (const char c : name) {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool letter = lower >= 'a' && lower <= 'z';
    const bool other = (lower >= '0' && lower <= '9') || lower == '_' || lower == '-' || lower == ' ';
    if (near.size() == kLongestName || (!letter && (!other || near.empty()))) continue;
    near += lower == '-' || lower == ' ' ? '_' : lower;
  }
  return near;
}

std::string Filled(std::string text, const std::string& name) {
  constexpr std::string_view kMark = "@NAME@";
  for (std::size_t at = text.find(kMark); at != std::string::npos; at = text.find(kMark, at + name.size())) {
    text.replace(at, kMark.size(), name);
  }
  return text;
}

int Refuse(int code, const std::string& text) {
  PrintError("coopdyn: new-controller: {}\n", text);
  return code;
}

}  // namespace

int NewController(const std::string& name, const fs::path& folder, bool supervisor) {
  if (!IsControllerName(name)) {
    const std::string near = NearestName(name);
    return Refuse(kExitWrongUse,
                  "'" + name +
                      "' cannot be the name: use a to z, 0 to 9 and _, a letter first, for example " +
                      (near.empty() ? "my_robot" : near));
  }
  std::error_code error;
  const fs::path target = (folder / name).lexically_normal();
  if (fs::symlink_status(target, error).type() != fs::file_type::not_found) {
    return Refuse(kExitErrors,
                  target.string() + " is there already: choose another name, or another --folder");
  }
  fs::create_directories(target, error);
  if (error) return Refuse(kExitErrors, target.string() + " cannot be made: " + error.message());
  std::map<std::string, std::string> texts;
  for (const bool of_supervisor : {false, true}) {
    for (const SkeletonFile& file : SkeletonFiles()) {
      const bool is_its = file.name.starts_with(kOfSupervisor);
      if (is_its == of_supervisor && (supervisor || !is_its))
        texts[file.name.substr(is_its ? kOfSupervisor.size() : 0)] = file.text;
    }
  }
  for (const auto& [file, text] : texts) {
    const fs::path path = target / Filled(file, name);
    std::ofstream stream(path, std::ios::binary);
    stream << Filled(text, name);
    stream.close();
    if (!stream) return Refuse(kExitErrors, path.string() + " cannot be written");
  }
  Print(
      "wrote {0}; continue with\n  cd {0}\n  cmake -B build && cmake --build build\n  coopdyn serve "
      "{1}.scenario\n",
      target.string(), name);
  return kExitOk;
}

void AddNewController(CLI::App& app, Chosen& chosen) {
  struct Given {
    std::string name, folder = ".";
    bool supervisor = false;
  };
  auto given = std::make_shared<Given>();
  CLI::App* sub = app.add_subcommand("new-controller", "Write a starter controller, ready to build");
  sub->footer("Example: coopdyn new-controller wander && cd wander && cmake -B build && cmake --build build");
  sub->add_option("name", given->name, "Name of the controller: a to z, 0 to 9 and _")->required();
  sub->add_option("--folder", given->folder, "Where to put its folder")->capture_default_str();
  sub->add_flag("--supervisor", given->supervisor, "A supervisor of the world, not a robot's controller");
  sub->callback([&chosen, given] {
    chosen = [given] { return NewController(given->name, given->folder, given->supervisor); };
  });
}

}  // namespace coopdyn
