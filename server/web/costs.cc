// SPDX-License-Identifier: MIT
#include "server/web/costs.h"

#include <algorithm>
#include <boost/json.hpp>
#include <map>
#include <utility>

#include "protocol/json_text.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

/// A part of all steps.
struct Part {
  const char* name;
  Nanoseconds ns;
};

std::vector<Part> PartsOf(const StepCosts& costs, Nanoseconds waited) {
  const PhaseTimes& times = costs.times;
  const Nanoseconds known =
      times.physics + times.publish + times.sense + times.control + costs.journal + costs.answer;
  return {{"physics", times.physics},
          {"frames", times.publish},
          {"sensors", times.sense},
          {"control", times.control},
          {"recorder", costs.journal},
          {"answers", costs.answer},
          {"rest", std::max<Nanoseconds>(0, costs.busy - known)},
          {"clients", waited},
          {"pace", std::max<Nanoseconds>(0, costs.idle - waited)}};
}

json::value PerStep(Nanoseconds ns, std::uint64_t steps) {
  if (steps == 0) return nullptr;
  return static_cast<double>(ns) * 1e-6 / static_cast<double>(steps);
}

/// A client of one robot, or of a team.
struct Client {
  std::string name, client;
  std::size_t robots = 1;
  Nanoseconds waited = 0, alone = 0;
};

/// Merges a team's robots into one client, for which the world waits as long as for its last robot.
std::map<std::string, Client> ClientsOf(const CommandBoard::Waits& waits) {
  std::map<std::string, Client> clients;
  for (const CommandBoard::Wait& wait : waits.robots) {
    const std::string key = wait.is_team ? "team " + wait.client : "robot " + wait.robot;
    const auto [place, is_new] = clients.try_emplace(key, Client{wait.robot, wait.client, 0});
    Client& client = place->second;
    ++client.robots;
    client.waited = std::max(client.waited, wait.waited);
    client.alone += wait.alone;
  }
  return clients;
}

json::array ClientsJson(const CostSnapshot& now, const CostSnapshot* before, std::uint64_t steps_last) {
  const std::map<std::string, Client> from =
      before == nullptr ? std::map<std::string, Client>() : ClientsOf(before->waits);
  std::vector<std::pair<std::string, Client>> all;
  for (auto& entry : ClientsOf(now.waits)) all.emplace_back(entry);
  const std::size_t shown = std::min(all.size(), CostBook::kMaxRobots);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), all.end(),
                    [](const auto& a, const auto& b) { return a.second.waited > b.second.waited; });
  all.resize(shown);
  json::array list;
  for (const auto& [key, client] : all) {
    const auto found = from.find(key);
    const Client none;
    const Client& old = found == from.end() ? none : found->second;
    list.push_back(
        {{"name", client.name},
         {"client", client.client.empty() ? json::value(nullptr) : json::value(json::string(client.client))},
         {"robots", client.robots},
         {"last_ms", PerStep(client.waited - old.waited, steps_last)},
         {"all_ms", PerStep(client.waited, now.costs.steps)},
         {"alone_last_ms", PerStep(client.alone - old.alone, steps_last)},
         {"alone_all_ms", PerStep(client.alone, now.costs.steps)}});
  }
  return list;
}

json::array ThreadsJson(const CostSnapshot& now, const CostSnapshot* before, std::uint64_t steps_last) {
  json::array list;
  if (before == nullptr) return list;
  std::map<std::int64_t, Nanoseconds> from;
  for (const CostSnapshot::Thread& thread : before->threads) from[thread.id] = thread.cpu;
  struct Sum {
    std::size_t count = 0;
    Nanoseconds cpu = 0;
  };
  std::map<std::string, Sum> by_name;
  for (const CostSnapshot::Thread& thread : now.threads) {
    const auto found = from.find(thread.id);
    Sum& sum = by_name[thread.name];
    ++sum.count;
    sum.cpu += std::max<Nanoseconds>(0, thread.cpu - (found == from.end() ? 0 : found->second));
  }
  const double wall = static_cast<double>(std::max<Nanoseconds>(1, now.now - before->now));
  for (const auto& [name, sum] : by_name) {
    list.push_back({{"name", name},
                    {"count", sum.count},
                    {"last_ms", PerStep(sum.cpu, steps_last)},
                    {"cores", static_cast<double>(sum.cpu) / wall}});
  }
  return list;
}

}  // namespace

std::string CostBook::Json(const CostSnapshot& snapshot) {
  if (!kept_.empty() && kept_.back().costs.runs != snapshot.costs.runs) kept_.clear();
  const CostSnapshot* before = Before(snapshot.now);
  const std::uint64_t steps_last = before == nullptr ? 0 : snapshot.costs.steps - before->costs.steps;
  const std::vector<Part> now = PartsOf(snapshot.costs, snapshot.waits.total);
  const std::vector<Part> then =
      before == nullptr ? PartsOf({}, 0) : PartsOf(before->costs, before->waits.total);
  json::array parts;
  for (std::size_t i = 0; i < now.size(); ++i) {
    parts.push_back({{"part", now[i].name},
                     {"last_ms", PerStep(now[i].ns - then[i].ns, steps_last)},
                     {"all_ms", PerStep(now[i].ns, snapshot.costs.steps)}});
  }
  std::string text = JsonText(
      json::object{{"mode", ToString(snapshot.mode)},
                   {"playback", snapshot.playing},
                   {"recording", snapshot.recording},
                   {"steps", snapshot.costs.steps},
                   {"steps_last", before == nullptr ? json::value(nullptr) : json::value(steps_last)},
                   {"parts", std::move(parts)},
                   {"clients", ClientsJson(snapshot, before, steps_last)},
                   {"threads", ThreadsJson(snapshot, before, steps_last)}});
  Keep(snapshot);
  return text;
}

const CostSnapshot* CostBook::Before(Nanoseconds now) const {
  for (auto kept = kept_.rbegin(); kept != kept_.rend(); ++kept) {
    if (now - kept->now >= kWindow && now - kept->now <= kOldest) return &*kept;
  }
  return nullptr;
}

void CostBook::Keep(const CostSnapshot& snapshot) {
  while (!kept_.empty() && snapshot.now - kept_.front().now > kOldest) kept_.pop_front();
  if (kept_.empty() || snapshot.now - kept_.back().now >= kLeastApart) kept_.push_back(snapshot);
}

}  // namespace coopdyn
