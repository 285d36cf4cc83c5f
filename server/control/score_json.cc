// SPDX-License-Identifier: MIT
#include "server/control/score_json.h"

#include <cmath>

namespace coopdyn {

namespace json = boost::json;

json::array ScoresJson(const Frame& frame) {
  json::array scores;
  const std::vector<ScoreEntry>& entries = frame.scene->scenario->scores;
  for (std::size_t i = 0; i < frame.scores.size() && i < entries.size(); ++i) {
    const Score& score = frame.scores[i];
    const std::optional<ScoreUntil>& until = entries[i].until;
    scores.push_back(
        {{"name", entries[i].name},
         {"value", std::isfinite(score.value) ? json::value(score.value) : json::value(nullptr)},
         {"unit", UnitOf(entries[i].kind)},
         {"met", until ? json::value(score.met) : json::value(nullptr)},
         // The first score that is met ends the run, in the frame that met it.
         {"met_s", score.met ? json::value(frame.time_s()) : json::value(nullptr)},
         {"until", until ? json::value(ToString(*until)) : json::value(nullptr)},
         {"limit_s", entries[i].limit_s ? json::value(*entries[i].limit_s) : json::value(nullptr)}});
  }
  return scores;
}

json::array LoggedJson(const std::map<std::string, Logged>& logged) {
  json::array numbers;
  for (const auto& [name, one] : logged)
    numbers.push_back({{"name", name}, {"value", one.value}, {"step", one.step}, {"time_s", one.time_s}});
  return numbers;
}

}  // namespace coopdyn
