// SPDX-License-Identifier: MIT
#include "server/model/yarp_ini.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "server/model/sdf_parts.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMostNames = kMaxModelParts, kMostDevices = 50;

/// The words of a line without its comment; lists lose their parentheses, strings their quotes.
std::vector<std::string> WordsOfLine(std::string_view line) {
  std::string plain(line.substr(0, std::min(line.find('#'), line.find("//"))));
  std::ranges::replace_if(
      plain, [](char c) { return c == '(' || c == ')' || c == '"'; }, ' ');
  return SplitWords(plain);
}

std::optional<int> JointIndex(const std::string& word) {
  const auto value = ParsePlain(word);
  if (!value || *value < 0 || *value > static_cast<double>(kMostNames)) return std::nullopt;
  return static_cast<int>(*value);
}

void ReadWrapper(const std::vector<std::string>& words, YarpIni& ini) {
  const std::string& key = words.front();
  if (key == "name" && words.size() > 1) {
    ini.name = words[1].substr(words[1].find_last_of("/%") + 1);
  } else if (key == "networks") {
    ini.networks.assign(words.begin() + 1,
                        words.begin() + static_cast<long>(std::min(words.size(), kMostDevices)));
  } else if (words.size() == 5 && ini.ranges.size() < kMostDevices) {
    const auto board = JointIndex(words[1]), first = JointIndex(words[3]), last = JointIndex(words[4]);
    if (board && first && last) ini.ranges[key] = {*board, *first, *last};
  }
}

/// The device `name` in `own`, else in another file; null if none.
const YarpIni::Device* FindDevice(std::span<const YarpIni> inis, const YarpIni& own, const std::string& name,
                                  bool& is_coupled) {
  const auto find = [&](const YarpIni& ini) -> const YarpIni::Device* {
    const auto found = std::ranges::find(ini.devices, name, &YarpIni::Device::name);
    is_coupled = ini.is_coupled;
    return found == ini.devices.end() ? nullptr : &*found;
  };
  if (const auto* device = find(own)) return device;
  for (const YarpIni& ini : inis) {
    if (const auto* device = find(ini)) return device;
  }
  // A file with a single device may name it differently.
  is_coupled = own.is_coupled;
  return own.networks.size() == 1 && own.devices.size() == 1 ? &own.devices.front() : nullptr;
}

std::vector<std::string> JointsOfBoard(std::span<const YarpIni> inis, const YarpIni& ini) {
  std::vector<std::string> joints;
  std::vector<std::string> networks = ini.networks;
  const auto place = [&ini](const std::string& network) {
    const auto range = ini.ranges.find(network);
    return range == ini.ranges.end() ? 0 : range->second.board;
  };
  std::ranges::stable_sort(networks, {}, place);
  for (const std::string& network : networks) {
    bool is_coupled = false;
    const YarpIni::Device* device = FindDevice(inis, ini, network, is_coupled);
    if (device == nullptr) continue;
    const auto range = ini.ranges.find(network);
    // A coupled device has more joints than the board shows: use all of them.
    const bool has_all = is_coupled || range == ini.ranges.end() || range->second.first > range->second.last;
    const std::size_t count = device->joints.size();
    const std::size_t from = has_all ? 0 : std::min(count, static_cast<std::size_t>(range->second.first));
    const std::size_t to =
        has_all ? count : std::min(count, static_cast<std::size_t>(range->second.last) + 1);
    joints.insert(joints.end(), device->joints.begin() + static_cast<long>(from),
                  device->joints.begin() + static_cast<long>(to));
  }
  if (ini.networks.empty()) {
    for (const YarpIni::Device& device : ini.devices)
      joints.insert(joints.end(), device.joints.begin(), device.joints.end());
  }
  joints.resize(std::min(joints.size(), kMostNames));
  return joints;
}

}  // namespace

YarpIni ParseYarpIni(std::string_view text) {
  constexpr std::string_view kDevice = "_hardware_device";
  YarpIni ini;
  std::string section, device_name;
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    const std::vector<std::string> words = WordsOfLine(line);
    if (words.empty()) continue;
    if (words.front().starts_with('[')) {
      const std::size_t open = line.find('[') + 1;
      const std::vector<std::string> name = WordsOfLine(line.substr(open, line.find(']') - open));
      // [include "FILE"] may occur anywhere and ends no section; such files only contain the robot's name.
      if (!name.empty() && name.front() == "include") continue;
      section = name.empty() ? "" : name.front();
      ini.is_coupled = ini.is_coupled || section == "COUPLING";
    } else if (section == "WRAPPER") {
      ReadWrapper(words, ini);
    } else if (words.front() == "jointNames" && words.size() > 1 && ini.devices.size() < kMostDevices) {
      const auto most = static_cast<long>(std::min(words.size(), kMostNames + 1));
      ini.devices.push_back({section, {words.begin() + 1, words.begin() + most}});
    } else if (words.front() == "yarpDeviceName" && words.size() > 1) {
      device_name = words[1];
      if (device_name.ends_with(kDevice)) device_name.resize(device_name.size() - kDevice.size());
    }
  }
  if (ini.name.empty()) ini.name = device_name;
  if (ini.name.empty() && !ini.devices.empty()) ini.name = ini.devices.front().name;
  return ini;
}

std::vector<YarpBoard> YarpBoardsOf(std::span<const YarpIni> inis, std::vector<std::string>& left_out) {
  std::vector<YarpBoard> boards;
  for (const YarpIni& ini : inis) boards.push_back({ini.name, JointsOfBoard(inis, ini), boards.size()});
  std::vector<std::size_t> order(boards.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return boards[i].joints.size(); });
  std::set<std::string> taken;
  for (const std::size_t i : order)
    std::erase_if(boards[i].joints, [&](const std::string& joint) { return !taken.insert(joint).second; });
  std::erase_if(boards, [&left_out](const YarpBoard& board) {
    if (board.joints.empty()) left_out.push_back(board.name);
    return board.joints.empty();
  });
  return boards;
}

}  // namespace coopdyn
