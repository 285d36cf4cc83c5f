// SPDX-License-Identifier: MIT
#include "protocol/command_table.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/common_commands.h"

namespace coopdyn {
namespace {

[[maybe_unused]] bool AllUnique(const std::vector<CommandSpec>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (commands[i].id == commands[j].id || commands[i].name == commands[j].name) return false;
    }
  }
  return true;
}

}  // namespace

std::size_t EditDistance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * width);
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = cost[i * width + j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      const char x = ToLower(a[i - 1]);
      const char y = ToLower(b[j - 1]);
      here = std::min({cost[(i - 1) * width + j] + 1, cost[i * width + j - 1] + 1,
                       cost[(i - 1) * width + j - 1] + (x == y ? 0 : 1)});
      if (i > 1 && j > 1 && x == ToLower(b[j - 2]) && y == ToLower(a[i - 2])) {
        here = std::min(here, cost[(i - 2) * width + j - 2] + 1);
      }
    }
  }
  return cost.back();
}

CommandTable::CommandTable(std::string module, std::vector<CommandSpec> own)
    : module_(std::move(module)), commands_(CommonCommands(own)) {
  for (CommandSpec& spec : own) {
    const auto common = std::find_if(commands_.begin(), commands_.end(),
                                     [&](const CommandSpec& other) { return other.id == spec.id; });
    if (common != commands_.end()) {
      *common = std::move(spec);
    } else {
      commands_.push_back(std::move(spec));
    }
  }
  assert(AllUnique(commands_));
}

const CommandSpec* CommandTable::Find(std::int32_t id) const {
  const auto found = std::find_if(commands_.begin(), commands_.end(),
                                  [id](const CommandSpec& spec) { return spec.id == id; });
  return found == commands_.end() ? nullptr : &*found;
}

const CommandSpec* CommandTable::Find(std::string_view name) const {
  const auto found = std::find_if(commands_.begin(), commands_.end(),
                                  [name](const CommandSpec& spec) { return spec.name == name; });
  return found == commands_.end() ? nullptr : &*found;
}

std::int32_t CommandTable::first_reading() const {
  const auto found = std::find_if(commands_.begin(), commands_.end(), IsSubscribable);
  assert(found != commands_.end());
  return found->id;
}

std::string CommandTable::Nearest(std::string_view name) const {
  constexpr std::size_t kLongest = 64;  // longer words are no misspelt commands
  if (name.empty() || name.size() > kLongest) return "";
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const CommandSpec& spec : commands_) {
    const std::size_t distance = EditDistance(name, spec.name);
    if (distance < least) {
      least = distance;
      nearest = spec.name;
    }
  }
  if (!nearest.empty() || name.size() < 4) return nearest;
  for (const CommandSpec& spec : commands_) {
    if (spec.name.find(name) != std::string::npos) return spec.name;
  }
  return "";
}

bool IsReadingCommand(std::string_view command_name) {
  constexpr std::array<std::string_view, 9> kHarmless = {"describe",        "ping",   "subscribe",
                                                         "unsubscribe",     "attach", "read_all",
                                                         "select_readings", "list",   "pick"};
  return command_name.starts_with("get_") ||
         std::find(kHarmless.begin(), kHarmless.end(), command_name) != kHarmless.end();
}

}  // namespace coopdyn
